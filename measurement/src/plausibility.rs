//! Whether a record can be a test of a damper: its size, its motion, its length.

use crate::error::MeasurementError;
use crate::number;
use crate::series::Series;
use crate::suspicion;

use signal::spectrum::Spectrum;
use signal::statistics::{min_max, rms};

/// Fewest samples of a test.
pub const SAMPLES_LEAST: usize = 50;
/// Slowest sampling (Hz).
const RATE_LEAST_HZ: f64 = 20.0;
/// Sampling from which any motion of a damper is read (Hz).
const RATE_ENOUGH_HZ: f64 = 100.0;
/// Samples in a period of the fastest motion with power below that rate.
const SAMPLES_OF_A_PERIOD: f64 = 10.0;
/// Share of the power of the displacement that is motion.
const MOTION_SHARE: f64 = 0.99;
/// Velocity above which a unit must be another one (m/s).
const SPEED_MOST_M_PER_S: f64 = 10.0;
/// Longest travel of a damper, end to end (m).
const TRAVEL_MOST_M: f64 = 2.0;
/// So many readings beyond what a damper can do are false ones; more are another unit.
const OUTLIERS_MOST: usize = 3;
/// Largest force of a damper (N).
const FORCE_MOST_N: f64 = 20.0e6;

/// Lengths, sizes and motion, before the clock.
///
/// # Errors
/// Too few samples, no motion, no force, sizes that no damper has.
pub(crate) fn check_size(series: &Series) -> Result<(), MeasurementError> {
    let count = series.time_s.len();
    if count < SAMPLES_LEAST {
        let found = format!("{count} samples");
        return Err(series.error(found, format!("at least {SAMPLES_LEAST}")));
    }
    let [_, displacement, force] = &series.columns;
    let (travel_m, reach_n) = (span(&series.displacement_m), span(&series.force_n));
    for (values, range, most, name) in [
        (&series.displacement_m, travel_m, TRAVEL_MOST_M, displacement),
        (&series.force_n, reach_n, FORCE_MOST_N, force),
    ] {
        let beyond = || (0..count).filter(|at| range > most && values[*at].abs() > most);
        if let Some(first) = beyond().next().filter(|_| beyond().count() <= OUTLIERS_MOST) {
            let found = files::number(values[first]).to_string();
            let expected = format!("at most {most}, as in the other rows: a false reading?");
            return Err(series.error_of(first, name, found, expected));
        }
    }
    if travel_m > TRAVEL_MOST_M {
        let expected =
            format!("a travel below {TRAVEL_MOST_M} m: another unit, or columns swapped?");
        let found =
            format!("{displacement} over {travel_m:.5e} m and {force} over {reach_n:.5e} N");
        return Err(series.error(found, expected));
    }
    if reach_n > FORCE_MOST_N {
        let found = format!("{force} over {reach_n:.5e} N");
        return Err(series.error(found, format!("less than {FORCE_MOST_N} N: another unit?")));
    }
    if travel_m < 1e-6 {
        let found = format!("{displacement} constant within {} m", files::number(travel_m));
        return Err(series.error(found, "a damper that moves".to_owned()));
    }
    if reach_n < 1e-6 {
        let found = format!("{force} constant within {} N", files::number(reach_n));
        return Err(series.error(found, "a force that answers".to_owned()));
    }
    Ok(())
}

/// Rate and length, on the uniform clock.
///
/// # Errors
/// Slower than 20 Hz, or than 100 Hz and ten samples in a period of the fastest motion; less than
/// about one cycle (travel below 1.75 times the range) without holds of 30 % of the record in all.
pub(crate) fn check_length(series: &Series, step_s: f64) -> Result<(), MeasurementError> {
    let rate_hz = 1.0 / step_s;
    let found = || format!("{} samples per second", number::fixed(rate_hz, 6));
    if rate_hz < RATE_LEAST_HZ * (1.0 - 1e-6) {
        let expected = format!("at least {RATE_LEAST_HZ}{}", suspicion::of_rate(rate_hz));
        return Err(series.error(found(), expected));
    }
    if !suspicion::of_rate(rate_hz).is_empty() {
        let expected = format!("a clock of a recorder{}", suspicion::of_rate(rate_hz));
        return Err(series.error(found(), expected));
    }
    if is_slow(rate_hz) {
        let fastest_hz = fastest_hz(&series.displacement_m, rate_hz);
        let least_hz = SAMPLES_OF_A_PERIOD * fastest_hz;
        if rate_hz < least_hz {
            let found = format!("{} for a motion of up to {fastest_hz:.2} Hz", found());
            let expected = format!(
                "at least {least_hz:.1}, ten in a period of the fastest motion, or \
                 {RATE_ENOUGH_HZ} for any"
            );
            return Err(series.error(found, expected));
        }
    }
    let x = &series.displacement_m;
    let (range, travel) = (span(x), travel_m(x));
    if travel < 1.75 * range && 10 * held(x) < 3 * x.len() {
        let found = format!(
            "{:.2} s with a travel of {:.1} times the range",
            step_s * x.len() as f64,
            travel / range
        );
        return Err(series.error(found, "about a whole cycle at least, or a hold".to_owned()));
    }
    Ok(())
}

fn is_slow(rate_hz: f64) -> bool {
    rate_hz < RATE_ENOUGH_HZ * (1.0 - 1e-6)
}

/// The frequency below which 99 % of the power of a displacement lies (Hz).
fn fastest_hz(displacement_m: &[f64], rate_hz: f64) -> f64 {
    let length_s = displacement_m.len() as f64 / rate_hz;
    let Ok(spectrum) = Spectrum::welch(displacement_m, rate_hz, length_s) else { return 0.0 };
    let all: f64 = spectrum.density.iter().sum();
    let mut below = 0.0;
    for (hz, density) in spectrum.lines() {
        below += density;
        if below >= MOTION_SHARE * all {
            return hz;
        }
    }
    0.5 * rate_hz
}

/// States what a record of few samples a second cannot show: a line, and the effects of the
/// catalogue whose traces are lost.
pub(crate) fn report_rate(series: &mut Series, step_s: f64) -> Option<(&'static str, String)> {
    let rate_hz = 1.0 / step_s;
    if !is_slow(rate_hz) {
        return None;
    }
    let good_hz = 0.12 * rate_hz;
    let short_ms = 2e3 * step_s;
    series.repairs.push(format!(
        "{rate_hz:.1} samples per second: velocities are right within 1 % up to {good_hz:.1} Hz; \
         what lasts less than {short_ms:.0} ms does not show: impacts, the turn of the force at a \
         reversal, short delays"
    ));
    let why = format!("recorded at {rate_hz:.1} samples per second, which shows no impact");
    Some(("clearance_impact", why))
}

/// Travel from turning point to turning point (m). A point counts when the travel back from it is a
/// tenth of the range: noise travels nowhere.
fn travel_m(displacement_m: &[f64]) -> f64 {
    let Some(first) = displacement_m.first() else { return 0.0 };
    let band = 0.1 * span(displacement_m);
    let (mut travel, mut turned, mut farthest) = (0.0, *first, *first);
    for x in displacement_m {
        if (farthest - turned) * (x - farthest) >= 0.0 {
            farthest = *x;
        } else if (x - farthest).abs() >= band {
            travel += (farthest - turned).abs();
            (turned, farthest) = (farthest, *x);
        }
    }
    travel + (farthest - turned).abs()
}

/// Samples in holds: stretches of a tenth of the record or more that stay within 2 % of the range.
fn held(displacement_m: &[f64]) -> usize {
    let quiet = 0.02 * span(displacement_m);
    let part = displacement_m.len().div_ceil(10).max(1);
    let stride = (part / 20).max(1);
    let (mut held, mut until) = (0, 0);
    for (index, window) in displacement_m.windows(part).step_by(stride).enumerate() {
        let (start, end) = (index * stride, index * stride + part);
        if span(window) < quiet {
            held += end - start.max(until);
            until = end;
        }
    }
    held
}

/// Reports a velocity column that is not the slope of the displacement, and a velocity that no
/// damper has.
pub(crate) fn report_velocity(series: &mut Series, velocity_m_per_s: &[f64]) {
    let fastest = velocity_m_per_s.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    if fastest > SPEED_MOST_M_PER_S {
        series.repairs.push(format!(
            "velocities of up to {fastest:.1} m/s: another unit of {} or {}?",
            series.columns[1], series.columns[0]
        ));
    }
    let Some(given) = series.velocity_m_per_s.as_ref().filter(|_| !series.is_integrated) else {
        return;
    };
    let difference: Vec<f64> = given.iter().zip(velocity_m_per_s).map(|(a, b)| a - b).collect();
    let share = rms(&difference) / rms(velocity_m_per_s).max(f64::MIN_POSITIVE);
    if share > 0.2 {
        series.repairs.push(format!(
            "velocity column not used, as always; it differs from the slope of {} by {:.0} % of rms",
            series.columns[1],
            100.0 * share
        ));
    }
}

fn span(values: &[f64]) -> f64 {
    min_max(values).map_or(0.0, |(low, high)| high - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Positions (mm) at 20 mm/s with a hold (s) at each, from 0, at 1 kHz.
    fn path(legs_mm: &[f64], hold_s: f64) -> Vec<f64> {
        let mut x = vec![0.0];
        for to_mm in legs_mm {
            let (from_m, to_m) = (x[x.len() - 1], 1e-3 * to_mm);
            let steps = ((to_m - from_m).abs() / 20e-6).round() as usize;
            x.extend((1..=steps).map(|n| from_m + (to_m - from_m) * n as f64 / steps as f64));
            x.extend(vec![to_m; (1e3 * hold_s) as usize]);
        }
        x
    }

    fn judged(x: &[f64]) -> Result<(), String> {
        let series = Series::sampled("path", 1e3, x.to_vec(), x.to_vec());
        check_length(&series, 1e-3).map_err(|error| error.to_string())
    }

    #[test]
    fn a_path_with_short_holds_was_refused_because_travel_was_counted_in_tenths_of_the_range() {
        let there_and_back = [4.0, 0.0, -4.0, 0.0];
        for hold_s in [0.0, 0.05, 0.1, 0.5] {
            let x = path(&there_and_back, hold_s);
            assert!((travel_m(&x) / 16e-3 - 1.0).abs() < 1e-9, "{}", travel_m(&x));
            assert_eq!(judged(&x), Ok(()), "holds of {hold_s} s");
        }
        // Noise of 2 % of the range at every sample adds its own size, not its way.
        let noisy: Vec<f64> = path(&there_and_back, 0.1)
            .iter()
            .enumerate()
            .map(|(n, x)| x + 80e-6 * [1.0, -1.0, 0.5, -0.7][n % 4])
            .collect();
        assert!((travel_m(&noisy) / 16e-3 - 1.0).abs() < 0.05, "{}", travel_m(&noisy));
    }

    #[test]
    fn holds_count_together() {
        // Up in three steps, never back: 0.6 s of way, three holds of a tenth to a fifth.
        assert_eq!(judged(&path(&[4.0, 8.0, 12.0], 0.15)), Ok(()));
        let refused = judged(&path(&[4.0, 8.0, 12.0], 0.05)).unwrap_err();
        assert!(refused.contains("0.75 s with a travel of 1.0 times the range"), "{refused}");
    }

    #[test]
    fn half_a_cosine_is_no_hold_and_too_short() {
        let half: Vec<f64> =
            (0..2000).map(|n| libm::cos(std::f64::consts::PI * f64::from(n) / 2e3)).collect();
        assert_eq!(held(&half), 0);
        assert!(judged(&half).is_err());
    }
}
