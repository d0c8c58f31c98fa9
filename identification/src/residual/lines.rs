//! Tones and narrow bands in a residual that the other analyses do not see: ripple at a fractional
//! multiple of the speed, the resonance of a frame, a fluttering valve.
//!
//! The residual, whitened by a first-order filter, is cut into few and into many segments. A line
//! is a stretch of its spectrum above the medians of its neighbours below and above (a spectrum
//! that only falls has none), by more than chance allows: with K segments, 2 K times the ratio
//! follows chi-square with 2 K degrees of freedom.

use crate::test_set::TestSet;
use signal::spectrum::Spectrum;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Lines on either side whose median is the background.
const SURROUNDINGS: usize = 24;
/// Lines on either side that belong to the same tone.
const SAME: usize = 3;
/// Fewest lines on a side that make a background.
const FEWEST_ON_A_SIDE: usize = 6;
/// Numbers of segments tried.
const CUTS: [f64; 3] = [1.0, 8.0, 32.0];
/// Largest probability of a line by chance in one test.
const LARGEST_P: f64 = 1e-6;

/// A tone or narrow band in the residual of a test.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Index of the test.
    pub test: usize,
    /// Where it is strongest, Hz.
    pub frequency_hz: f64,
    /// Its rms above the background, N.
    pub rms_n: f64,
}

/// The strongest line of every test that has one.
pub(crate) fn lines(residual_n: &[Vec<f64>], tests: &TestSet) -> Vec<Line> {
    let mut found = Vec::new();
    for (index, test) in tests.tests.iter().enumerate() {
        let counted = &residual_n[index][test.counted()];
        let rate_hz = 1.0 / test.record.step_s;
        let whole_s = counted.len() as f64 * test.record.step_s;
        let candidates = CUTS.iter().filter_map(|cut| {
            line_of(counted, rate_hz, whole_s / cut).map(|(frequency_hz, rms_n)| Line {
                test: index,
                frequency_hz,
                rms_n,
            })
        });
        found.extend(candidates.max_by(|a, b| a.rms_n.total_cmp(&b.rms_n)));
    }
    found
}

/// rms of lines over all tests, N.
pub(crate) fn pooled(lines: &[Line], tests: &TestSet) -> f64 {
    let squares: f64 = lines
        .iter()
        .map(|line| line.rms_n * line.rms_n * tests.tests[line.test].counted().len() as f64)
        .sum();
    let counted: usize = tests.tests.iter().map(|test| test.counted().len()).sum();
    (squares / counted.max(1) as f64).sqrt()
}

fn line_of(residual_n: &[f64], rate_hz: f64, segment_s: f64) -> Option<(f64, f64)> {
    let lag = residual_n.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>();
    let square = residual_n.iter().map(|r| r * r).sum::<f64>();
    let memory = if square > 0.0 { lag / square } else { 0.0 };
    let white: Vec<f64> = residual_n.windows(2).map(|pair| pair[1] - memory * pair[0]).collect();
    let whitened = Spectrum::welch(&white, rate_hz, segment_s).ok()?;
    let plain = Spectrum::welch(residual_n, rate_hz, segment_s).ok()?;
    let density = &whitened.density;
    if density.len() < 4 * SURROUNDINGS {
        return None;
    }
    // Segments overlap by half: about two thirds as many independent ones.
    let independent = if whitened.segments > 1 { 0.65 * whitened.segments as f64 } else { 1.0 };
    let freedom = 2.0 * independent;
    let chi = ChiSquared::new(freedom).ok()?;
    let median_share = chi.inverse_cdf(0.5) / freedom;
    let first = 4;
    let mut power = 0.0;
    let mut strongest: Option<(f64, f64)> = None;
    for k in first..density.len() - 1 {
        let side = |from: usize, to: usize| {
            let mut around = density.get(from..to).unwrap_or_default().to_vec();
            around.sort_unstable_by(f64::total_cmp);
            around.get(around.len() / 2).copied().filter(|_| around.len() >= FEWEST_ON_A_SIDE)
        };
        let below = side(k.saturating_sub(SURROUNDINGS + SAME).max(first - 2), k - SAME.min(k));
        let above = side(k + SAME + 1, (k + SAME + 1 + SURROUNDINGS).min(density.len() - 1));
        let (Some(below), Some(above)) = (below, above) else { continue };
        let background = below.max(above) / median_share;
        let ratio = density[k] / background;
        let p = chi.sf(freedom * ratio) * density.len() as f64;
        if p < LARGEST_P {
            let frequency_hz = k as f64 * whitened.resolution_hz;
            let excess = plain.density[k] * (1.0 - 1.0 / ratio) * whitened.resolution_hz;
            power += excess;
            if strongest.is_none_or(|(_, most)| excess > most) {
                strongest = Some((frequency_hz, excess));
            }
        }
    }
    strongest.map(|(frequency_hz, _)| (frequency_hz, power.sqrt()))
}
