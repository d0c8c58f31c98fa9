//! What can be wrong with a test: each finding is an error in one line or a line of repair.

use super::clock::listed;
use super::error::MeasurementError;
use super::series::Series;
use signal::statistics::{min_max, rms, smallest_change};

/// Fewest samples of a test.
pub const SAMPLES_LEAST: usize = 50;
/// Slowest sampling (Hz).
pub const RATE_LEAST_HZ: f64 = 100.0;
/// Longest travel of a damper, end to end (m).
pub const TRAVEL_MOST_M: f64 = 2.0;
/// Largest force of a damper (N).
pub const FORCE_MOST_N: f64 = 20.0e6;

fn span(values: &[f64]) -> f64 {
    min_max(values).map_or(0.0, |(low, high)| high - low)
}

/// Lengths, sizes and motion, before the clock.
///
/// # Errors
/// Too few samples, no motion, no force, sizes that no damper has.
pub fn size(series: &Series) -> Result<(), MeasurementError> {
    let count = series.time_s.len();
    if count < SAMPLES_LEAST {
        let found = format!("{count} samples");
        return Err(series.error(found, format!("at least {SAMPLES_LEAST}")));
    }
    let [_, displacement, force] = &series.columns;
    let (travel_m, reach_n) = (span(&series.displacement_m), span(&series.force_n));
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
        let found = format!("{displacement} constant within {travel_m} m");
        return Err(series.error(found, "a damper that moves".to_owned()));
    }
    if reach_n < 1e-6 {
        let found = format!("{force} constant within {reach_n} N");
        return Err(series.error(found, "a force that answers".to_owned()));
    }
    Ok(())
}

/// Rate and length, on the uniform clock.
///
/// # Errors
/// Slower than 100 Hz; less than about one cycle (travel below 1.75 times the range) without holds
/// of 30 % of the record in all.
pub fn length(series: &Series, step_s: f64) -> Result<(), MeasurementError> {
    let rate_hz = 1.0 / step_s;
    if rate_hz < RATE_LEAST_HZ * (1.0 - 1e-6) {
        let found = format!("{rate_hz:.6} samples per second");
        return Err(series.error(found, format!("at least {RATE_LEAST_HZ}")));
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

/// Way from turning point to turning point (m). One counts when the way back from it is a tenth of
/// the range: noise travels nowhere.
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

/// Samples at the highest or lowest force while the damper moves on: runs of five or more equal values
/// within which the displacement changes by more than 1 % of its range, and which begin or end with a
/// jump. Without the jump (three times the smallest change in the record) it is the round top of a
/// rounded signal; below one sample in 500 it is chance. Gives the limit and the samples.
pub fn clipped(series: &Series) -> Option<(f64, Vec<usize>)> {
    let force = &series.force_n;
    let (low, high) = min_max(force)?;
    let moved = 0.01 * span(&series.displacement_m);
    let close = 1e-9 * (high - low);
    let digit = smallest_change(force, close);
    let at = |sample: usize| force.get(sample).copied();
    let (mut found, mut start, mut limit) = (Vec::new(), 0, 0.0);
    for sample in 0..=force.len() {
        let same = at(sample).is_some_and(|f| (f - limit).abs() <= close);
        if sample > start && same {
            continue;
        }
        let inside = series.displacement_m.get(start..sample).unwrap_or_default();
        let outside = [start.checked_sub(1).and_then(at), at(sample)];
        let jump = outside.iter().flatten().fold(0.0_f64, |most, f| most.max((f - limit).abs()));
        let at_limit = limit - low <= close || high - limit <= close;
        if sample - start >= 5 && at_limit && span(inside) > moved && jump > 3.5 * digit {
            found.extend(start..sample);
        }
        start = sample;
        limit = at(sample).unwrap_or(0.0);
    }
    let first = *found.first().filter(|_| 500 * found.len() >= force.len())?;
    at(first).map(|limit| (limit, found))
}

/// True where the force looks clipped, and only the arithmetic of a simulation tells its other samples from
/// smooth ones.
pub fn is_flat_but_for_rounding(series: &Series) -> bool {
    clipped(series).is_some() && is_noisy(&series.force_n, 0.0)
}

/// Refuses a force that was clipped; tells of one that may have been.
///
/// A damper may hold its greatest force too, but not to the last digit where the rest of the record has
/// noise.
///
/// # Errors
/// Samples stay at the extreme force while the damper moves on, in a record with noise.
pub fn refuse_clipped(series: &mut Series) -> Result<(), MeasurementError> {
    let Some((limit, samples)) = clipped(series) else { return Ok(()) };
    let lines = listed(samples.iter().map(|sample| series.line(*sample)));
    let found = format!(
        "{} at its extreme {limit} N in {} samples while the damper moves, lines {lines}",
        series.columns[2],
        samples.len()
    );
    if is_noisy(&series.force_n, LEAST_NOISE) {
        let expected = "a force that was not clipped: measure again over a wider range";
        return Err(series.error(found, expected.to_owned()));
    }
    series.repairs.push(format!("left as it is: {found}: clipped?"));
    Ok(())
}

/// Samples of one equal force that noise does not make.
const FROZEN: usize = 20;

/// Refuses a force that stays the same to the last digit while the damper moves on and then leaps further than it
/// does anywhere else, in a record with noise: a logger that hangs, a cable that is off. (A simulated force is
/// nothing at all in a clearance, and leaves it without a leap.)
///
/// # Errors
/// There is such a stretch.
pub fn refuse_frozen(series: &Series) -> Result<(), MeasurementError> {
    let force = &series.force_n;
    let moved = 0.01 * span(&series.displacement_m);
    let mut runs: Vec<std::ops::Range<usize>> = Vec::new();
    let mut start = 0;
    for run in force.chunk_by(|a, b| a == b) {
        let samples = start..start + run.len();
        start = samples.end;
        let inside = series.displacement_m.get(samples.clone()).unwrap_or_default();
        if run.len() >= FROZEN && span(inside) > moved {
            runs.push(samples);
        }
    }
    if runs.is_empty() || !is_noisy(force, LEAST_NOISE) {
        return Ok(());
    }
    // The step from a sample to the next one.
    let step = |at: usize| force.get(at..at + 2).map_or(0.0, |pair| (pair[1] - pair[0]).abs());
    let ends = |run: &std::ops::Range<usize>| [run.start.saturating_sub(1), run.end - 1];
    let beside: Vec<usize> = runs.iter().flat_map(ends).collect();
    let elsewhere = (0..force.len()).filter(|at| !beside.contains(at)).map(step);
    let largest = elsewhere.fold(0.0, f64::max);
    runs.retain(|run| ends(run).into_iter().map(step).fold(0.0, f64::max) > largest);
    let frozen: Vec<usize> = runs.into_iter().flatten().collect();
    let Some(value) = frozen.first().and_then(|sample| force.get(*sample)) else { return Ok(()) };
    let lines = listed(frozen.iter().map(|sample| series.line(*sample)));
    let (name, count) = (&series.columns[2], frozen.len());
    let found = format!(
        "{name} {value} N to the last digit in {count} samples while the damper moves, lines {lines}"
    );
    let expected = "a force that goes on: a logger that hung, a cable that was off?";
    Err(series.error(found, expected.to_owned()))
}

/// Noise of a sensor is at least this share of what it shows: less is the arithmetic of a simulation.
const LEAST_NOISE: f64 = 1e-6;

/// Third differences turn from sample to sample, as those of noise do and those of a smooth signal do
/// not, and are larger than the last digit makes them and than a share of the whole span.
fn is_noisy(force_n: &[f64], least_noise: f64) -> bool {
    let digit = smallest_change(force_n, 0.0);
    let thirds = force_n.windows(4).map(|f| f[3] - 3.0 * f[2] + 3.0 * f[1] - f[0]);
    // Rounding alone makes up to four digits.
    let least = (8.0 * digit).max(least_noise * span(force_n));
    let thirds: Vec<f64> = thirds.filter(|third| third.abs() > least).collect();
    let turns = thirds.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
    4 * thirds.len() > force_n.len() && 2 * turns > thirds.len()
}

/// Spikes of one sample are mended by their neighbours' mean, and told.
///
/// A spike stands out from both neighbours alike by ten times what any other sample does but those
/// beside spikes; a blow between clearances lasts longer. At most one in a thousand is mended.
pub fn mend_spikes(series: &mut Series) {
    let force = &series.force_n;
    let off = |i: usize| (force[i] - 0.5 * (force[i - 1] + force[i + 1])).abs();
    let mut sizes: Vec<(f64, usize)> =
        (1..force.len().saturating_sub(1)).map(|i| (off(i), i)).collect();
    sizes.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let most = force.len() / 1000;
    let mut spikes: Vec<usize> = Vec::new();
    for (size, i) in &sizes {
        let beside = |spike: &usize| i.abs_diff(*spike) <= 1;
        if spikes.iter().any(beside) {
            continue;
        }
        let alike = (force[i + 1] - force[i - 1]).abs() < 0.2 * size;
        if spikes.len() < most && alike {
            spikes.push(*i);
            continue;
        }
        // The first that is none: all before have to stand far above it.
        spikes.retain(|spike| off(*spike) > 10.0 * size);
        break;
    }
    if spikes.is_empty() {
        return;
    }
    spikes.sort_unstable();
    let lines = listed(spikes.iter().map(|spike| series.line(*spike)));
    for spike in &spikes {
        series.force_n[*spike] = 0.5 * (series.force_n[spike - 1] + series.force_n[spike + 1]);
    }
    series.repairs.push(format!(
        "{}: {} spikes of one sample replaced by the mean of their neighbours, lines {lines}",
        series.columns[2],
        spikes.len()
    ));
}

/// Tells of a velocity column that is not the slope of the displacement.
pub fn tell_velocity(series: &mut Series, velocity_m_per_s: &[f64]) {
    let Some(given) = &series.velocity_m_per_s else { return };
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

    #[test]
    fn a_force_that_froze_for_a_moment_was_taken_for_noise() {
        let noise = |n: usize| ((n * 7919 + n * n * 104_729) % 997) as f64 - 498.0;
        let phase = |n: usize| 0.0125 * n as f64;
        let x: Vec<f64> = (0..3000).map(|n| 5e-3 * libm::sin(phase(n))).collect();
        let clean = |n: usize| 1e4 * libm::cos(phase(n));
        let noisy: Vec<f64> = (0..3000).map(|n| clean(n) + 0.1 * noise(n)).collect();
        let judged = |force: &[f64]| {
            let series = Series::sampled("a", 1e3, x.clone(), force.to_vec());
            refuse_frozen(&series).map_err(|error| error.to_string())
        };
        assert_eq!(judged(&noisy), Ok(()));
        let mut frozen = noisy.clone();
        frozen[1400..1440].fill(noisy[1400]);
        let told = judged(&frozen).unwrap_err();
        assert!(told.contains("in 40 samples while the damper moves"), "{told}");
        // In a clearance the force is nothing to the last digit where there is no noise.
        let mut clean: Vec<f64> = (0..3000).map(clean).collect();
        clean[1400..1440].fill(0.0);
        assert_eq!(judged(&clean), Ok(()));
    }

    fn judged(x: &[f64]) -> Result<(), String> {
        let series = Series::sampled("path", 1e3, x.to_vec(), x.to_vec());
        length(&series, 1e-3).map_err(|error| error.to_string())
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
