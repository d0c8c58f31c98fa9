//! The data rate of the search: as few samples as the motion and the force need.
//!
//! Records are sampled for the noise floor and for fast effects; a search fits thousands of
//! simulations and gains nothing from samples far closer than the force changes. With `f(p)` the
//! frequency below which the share p of the power of the force lies, every k-th sample is kept such
//! that
//!
//! ```text
//! rate >= 20 f(0.95), 6 f(0.995), 200 Hz, and the rate that a fast effect in reach needs
//! model steps <= 1 / (80 f(0.95))              an error of 0.05 % of the velocity
//! ```
//!
//! for the fastest test; all tests keep the same share of their samples, so that their weights
//! stay. The models that the search finds are fitted once more to all samples, and everything that
//! is stated about them comes from there.

use super::test_set::TestSet;
use firmware_core::damper::effects::CATALOGUE;
use measurement::Measurement;
use signal::spectrum::Spectrum;

/// Samples per period of the frequency below which nearly all power lies, and below which all of it
/// lies but for corners.
const SAMPLES: [(f64, f64); 2] = [(0.95, 20.0), (0.995, 6.0)];
/// Lowest rate of a search, Hz.
const LOWEST_RATE_HZ: f64 = 200.0;
/// Steps of a model per period.
const STEPS: f64 = 80.0;
/// Longest step of a model in a search, s.
const LONGEST_STEP_S: f64 = 5e-3;
/// Segments of the spectrum, s.
const SEGMENT_S: f64 = 4.0;

/// Every how many samples are enough, and the longest step of a model in each test, s.
pub(crate) fn enough(tests: &TestSet) -> (usize, Vec<f64>) {
    let reachable = |needs_hz: &f64| *needs_hz <= tests.lowest_rate_hz();
    let effects = CATALOGUE.iter().map(|info| info.needs_rate_hz).filter(reachable);
    let fast_hz = effects.fold(LOWEST_RATE_HZ, f64::max);
    let spectra: Vec<Option<Spectrum>> =
        tests.tests.iter().map(|test| spectrum(&test.record)).collect();
    let keep = tests.tests.iter().zip(&spectra).map(|(test, spectrum)| {
        let wanted =
            SAMPLES.map(|(share, samples)| samples * frequency_hz(spectrum.as_ref(), share));
        let rate_hz = wanted.into_iter().fold(fast_hz, f64::max);
        // A time column in milliseconds rounds the rate.
        (1.0 / (test.record.step_s * rate_hz) + 1e-6) as usize
    });
    let factor = keep.min().unwrap_or(1).max(1);
    let steps_s = spectra.iter().map(|spectrum| {
        (1.0 / (STEPS * frequency_hz(spectrum.as_ref(), SAMPLES[0].0))).min(LONGEST_STEP_S)
    });
    (factor, steps_s.collect())
}

fn spectrum(record: &Measurement) -> Option<Spectrum> {
    Spectrum::welch(&record.force_n, record.rate_hz(), SEGMENT_S).ok()
}

/// The frequency below which this share of the power lies, Hz; infinite where nothing is known.
fn frequency_hz(spectrum: Option<&Spectrum>, share: f64) -> f64 {
    let Some(spectrum) = spectrum else { return f64::INFINITY };
    let whole: f64 = spectrum.lines().map(|(_, density)| density).sum();
    let mut below = 0.0;
    let found = spectrum.lines().find(|(_, density)| {
        below += density;
        below >= share * whole
    });
    found.map_or(f64::INFINITY, |(hz, _)| hz)
}

#[cfg(test)]
mod tests {
    use super::*;
    use measurement::Series;

    fn sines(rate_hz: f64, frequencies_hz: &[f64]) -> TestSet {
        let record = |hz: &f64| {
            let wave = |n: usize| libm::sin(std::f64::consts::TAU * hz * n as f64 / rate_hz);
            let x: Vec<f64> = (0..(8.0 * rate_hz) as usize).map(|n| 1e-3 * wave(n)).collect();
            let force = x.iter().map(|x| 1e7 * x).collect();
            Measurement::from_series(Series::sampled("a", rate_hz, x, force)).unwrap()
        };
        TestSet::new(frequencies_hz.iter().map(record).collect())
    }

    #[test]
    fn the_fastest_test_decides_for_all() {
        let (factor, steps_s) = enough(&sines(1000.0, &[0.5, 2.0]));
        assert_eq!(factor, 5);
        assert!((steps_s[0] - 5e-3).abs() < 1e-12 && steps_s[1] < 6.3e-3, "{steps_s:?}");
        let (factor, steps_s) = enough(&sines(1000.0, &[0.5, 16.0]));
        assert_eq!(factor, 3);
        assert!(steps_s[1] < 0.8e-3, "{steps_s:?}");
    }

    #[test]
    fn a_record_in_which_a_fast_effect_shows_keeps_its_rate() {
        assert_eq!(enough(&sines(5000.0, &[2.0])).0, 1);
    }

    #[test]
    fn a_slow_record_is_kept_whole() {
        assert_eq!(enough(&sines(200.0, &[1.0])).0, 1);
        assert_eq!(enough(&sines(300.0, &[1.0])).0, 1);
    }
}
