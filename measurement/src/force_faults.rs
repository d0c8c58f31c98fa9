//! Faults of the force channel: clipped, frozen, spikes.

use crate::error::MeasurementError;
use crate::series::Series;
use signal::statistics::{min_max, smallest_change};

/// Samples at the highest or lowest force while the damper moves on: runs of five or more equal
/// values within which the displacement changes by more than 1 % of its range, and which begin or
/// end with a jump. Without the jump (three times the smallest change in the record) it is the
/// round top of a rounded signal; below one sample in 500 it is chance. Gives the limit and the
/// samples.
fn clipped(series: &Series) -> Option<(f64, Vec<usize>)> {
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

/// True where the force looks clipped, and only the rounding of a simulation makes its other
/// samples differ from smooth ones.
pub fn is_flat_but_for_rounding(series: &Series) -> bool {
    clipped(series).is_some() && is_noisy(&series.force_n, 0.0)
}

/// Refuses a force that was clipped; reports one that may have been.
///
/// A damper may hold its greatest force too, but not to the last digit where the rest of the record
/// has noise.
///
/// # Errors
/// Samples stay at the extreme force while the damper moves on, in a record with noise.
pub(crate) fn refuse_clipped(series: &mut Series) -> Result<(), MeasurementError> {
    let Some((limit, samples)) = clipped(series) else { return Ok(()) };
    let lines = series.lines_of(samples.iter().copied());
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

/// Refuses a force that stays the same to the last digit while the damper moves on and then jumps
/// further than it does anywhere else, in a record with noise: a logger that hangs, a cable that is
/// off. (A simulated force is zero in a clearance, and returns without a jump.)
///
/// # Errors
/// There is such a stretch.
pub(crate) fn refuse_frozen(series: &Series) -> Result<(), MeasurementError> {
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
    let at_ends: Vec<usize> = runs.iter().flat_map(ends).collect();
    let elsewhere = (0..force.len()).filter(|at| !at_ends.contains(at)).map(step);
    let largest = elsewhere.fold(0.0, f64::max);
    runs.retain(|run| ends(run).into_iter().map(step).fold(0.0, f64::max) > largest);
    let frozen: Vec<usize> = runs.into_iter().flatten().collect();
    let Some(value) = frozen.first().and_then(|sample| force.get(*sample)) else { return Ok(()) };
    let lines = series.lines_of(frozen.iter().copied());
    let (name, count) = (&series.columns[2], frozen.len());
    let found = format!(
        "{name} {value} N to the last digit in {count} samples while the damper moves, lines {lines}"
    );
    let expected = "a force that goes on: a logger that hung, a cable that was off?";
    Err(series.error(found, expected.to_owned()))
}

/// Noise of a sensor is at least this share of what it shows: less is the arithmetic of a
/// simulation.
const LEAST_NOISE: f64 = 1e-6;

/// Third differences change sign from sample to sample, as those of noise do and those of a smooth
/// signal do not, and are larger than the last digit makes them and than a share of the whole span.
fn is_noisy(force_n: &[f64], least_noise: f64) -> bool {
    let digit = smallest_change(force_n, 0.0);
    let thirds = force_n.windows(4).map(|f| f[3] - 3.0 * f[2] + 3.0 * f[1] - f[0]);
    // Rounding alone makes up to four digits.
    let least = (8.0 * digit).max(least_noise * span(force_n));
    let thirds: Vec<f64> = thirds.filter(|third| third.abs() > least).collect();
    let turns = thirds.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
    4 * thirds.len() > force_n.len() && 2 * turns > thirds.len()
}

/// Replaces spikes of one sample by the mean of their neighbours, and reports them.
///
/// A spike differs from both neighbours alike, by ten times as much as any other sample except
/// those next to spikes; an impact at the end of a clearance lasts longer. At most one sample in a
/// thousand is replaced.
pub(crate) fn mend_spikes(series: &mut Series) {
    let force = &series.force_n;
    let off = |i: usize| (force[i] - 0.5 * (force[i - 1] + force[i + 1])).abs();
    let mut sizes: Vec<(f64, usize)> =
        (1..force.len().saturating_sub(1)).map(|i| (off(i), i)).collect();
    sizes.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let most = force.len() / 1000;
    let mut spikes: Vec<usize> = Vec::new();
    for (size, i) in &sizes {
        let next_to = |spike: &usize| i.abs_diff(*spike) <= 1;
        if spikes.iter().any(next_to) {
            continue;
        }
        let alike = (force[i + 1] - force[i - 1]).abs() < 0.2 * size;
        if spikes.len() < most && alike {
            spikes.push(*i);
            continue;
        }
        // The first that is none: all before have to be far above it.
        spikes.retain(|spike| off(*spike) > 10.0 * size);
        break;
    }
    if spikes.is_empty() {
        return;
    }
    spikes.sort_unstable();
    let lines = series.lines_of(spikes.iter().copied());
    for spike in &spikes {
        series.force_n[*spike] = 0.5 * (series.force_n[spike - 1] + series.force_n[spike + 1]);
    }
    series.repairs.push(format!(
        "{}: {} spikes of one sample replaced by the mean of their neighbours, lines {lines}",
        series.columns[2],
        spikes.len()
    ));
}

fn span(values: &[f64]) -> f64 {
    min_max(values).map_or(0.0, |(low, high)| high - low)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let message = judged(&frozen).unwrap_err();
        assert!(message.contains("in 40 samples while the damper moves"), "{message}");
        // In a clearance the force is nothing to the last digit where there is no noise.
        let mut clean: Vec<f64> = (0..3000).map(clean).collect();
        clean[1400..1440].fill(0.0);
        assert_eq!(judged(&clean), Ok(()));
    }
}
