//! From time stamps to one uniform clock.
//!
//! Time stamps that lie on a line within 1 % of a step, or within the rounding of their last digit,
//! are that line: the samples stay what they are. Otherwise the channels are resampled to the
//! median step by the cubic through neighbouring samples whose slopes are those of the parabola
//! through three (Hermite); this is reported as a repair. Its limits: every step within 30 % of
//! the median; up to three samples missing in a row and one in a hundred in all. What is worse is
//! an error with its line.

use crate::error::MeasurementError;
use crate::interpolant;
use crate::series::Series;
use std::cmp::Ordering;

/// Share of a step by which time stamps may deviate from a uniform clock.
const UNIFORM_SHARE: f64 = 0.01;
/// Share of the median step by which a step may differ and is still resampled.
const JITTER_SHARE: f64 = 0.3;
/// Most samples in a row that are filled in.
const FILLED_IN_A_ROW: usize = 3;
/// Most samples of all that are filled in, as a share.
const FILLED_SHARE: f64 = 0.01;

/// Brings a series to a uniform clock; gives its step (s). Needs at least three samples.
///
/// # Errors
/// Time that goes back, repeated stamps with other values, gaps and steps beyond the limits.
pub(crate) fn make_uniform(series: &mut Series) -> Result<f64, MeasurementError> {
    let (step_s, deviation_s) = line_through(&series.time_s);
    let rounding_s = 0.6 * series.time_resolution_s;
    if step_s > 0.0 && deviation_s <= UNIFORM_SHARE * step_s {
        return Ok(tidy(step_s, 1e-6));
    }
    if step_s > 0.0 && deviation_s <= rounding_s && rounding_s <= 3.0 * step_s {
        let span_s = step_s * series.time_s.len() as f64;
        let step_s = tidy(step_s, series.time_resolution_s / span_s);
        series.repairs.push(format!(
            "{}: stamps rounded to {} s taken as equal steps of {step_s:.6} s",
            series.columns[0], series.time_resolution_s
        ));
        return Ok(step_s);
    }
    drop_repeats(series)?;
    let median_s = median_step(&series.time_s);
    let missing = check_steps(series, median_s)?;
    Ok(resample(series, median_s, &missing))
}

/// Step of the least-squares line through the stamps, and the greatest distance from it (s).
fn line_through(time_s: &[f64]) -> (f64, f64) {
    let count = time_s.len() as f64;
    let first = time_s.first().copied().unwrap_or(0.0);
    let middle = 0.5 * (count - 1.0);
    let mean = time_s.iter().map(|t| t - first).sum::<f64>() / count;
    let (mut top, mut bottom) = (0.0, 0.0);
    for (n, t) in time_s.iter().enumerate() {
        let place = n as f64 - middle;
        top += place * (t - first - mean);
        bottom += place * place;
    }
    let step_s = top / bottom;
    let distance = |(n, t): (usize, &f64)| (t - first - mean - step_s * (n as f64 - middle)).abs();
    (step_s, time_s.iter().enumerate().map(distance).fold(0.0, f64::max))
}

/// A step whose rate is a whole number of hertz within a share is that.
fn tidy(step_s: f64, share: f64) -> f64 {
    let rate = libm::round(1.0 / step_s);
    if rate > 0.0 && (rate * step_s - 1.0).abs() < share { 1.0 / rate } else { step_s }
}

fn median_step(time_s: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_unstable_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(0.0)
}

/// Removes rows that repeat the one before at the same time, and reports them.
fn drop_repeats(series: &mut Series) -> Result<(), MeasurementError> {
    let mut repeated = Vec::new();
    for sample in 1..series.time_s.len() {
        let at = |values: &[f64], n: usize| values.get(n).copied().unwrap_or(f64::NAN);
        let (before, now) = (at(&series.time_s, sample - 1), at(&series.time_s, sample));
        if now > before {
            continue;
        }
        let same = |values: &[f64]| at(values, sample - 1) == at(values, sample);
        let found = format!("{now} s after {before} s");
        if now < before {
            let expected = "rising time; split_by separates several tests of a file".to_owned();
            return Err(series.error_of_time(sample, found, expected));
        }
        if !(same(&series.displacement_m) && same(&series.force_n)) {
            let expected = "rising time, or the same values at the same time".to_owned();
            let found = format!("{found}, with other values");
            return Err(series.error_of_time(sample, found, expected));
        }
        repeated.push(sample);
    }
    if repeated.is_empty() {
        return Ok(());
    }
    series.repairs.push(format!(
        "{} repeated rows left out: line {}",
        repeated.len(),
        series.lines_of(repeated.iter().copied())
    ));
    let mut keep = vec![true; series.time_s.len()];
    for sample in repeated {
        if let Some(kept) = keep.get_mut(sample) {
            *kept = false;
        }
    }
    let filter = |values: &mut Vec<f64>| {
        let mut keep = keep.iter();
        values.retain(|_| keep.next().copied().unwrap_or(true));
    };
    for channel in series.channels_mut() {
        filter(channel);
    }
    filter(&mut series.time_s);
    let mut kept = keep.iter();
    series.lines.retain(|_| kept.next().copied().unwrap_or(true));
    Ok(())
}

/// Samples after which some are missing, with how many; an error for what cannot be mended.
fn check_steps(series: &Series, median_s: f64) -> Result<Vec<(usize, usize)>, MeasurementError> {
    let mut missing = Vec::new();
    for (sample, pair) in series.time_s.windows(2).enumerate() {
        let steps = (pair[1] - pair[0]) / median_s;
        let whole = libm::round(steps).max(1.0);
        let expected = format!("steps of {median_s:.6} s, each within 30 %");
        if (steps - whole).abs() > JITTER_SHARE {
            let found = format!("a step of {:.6} s", pair[1] - pair[0]);
            return Err(series.error_of_time(sample + 1, found, expected));
        }
        let lost = whole as usize - 1;
        if lost > FILLED_IN_A_ROW {
            let found = format!("a gap of {:.6} s, {lost} samples", pair[1] - pair[0]);
            let expected =
                format!("{expected}; up to {FILLED_IN_A_ROW} missing samples are filled");
            return Err(series.error_of_time(sample + 1, found, expected));
        }
        if lost > 0 {
            missing.push((sample, lost));
        }
    }
    let all: usize = missing.iter().map(|(_, lost)| lost).sum();
    if all as f64 > FILLED_SHARE * series.time_s.len() as f64 {
        let found = format!("{all} missing samples in {} gaps", missing.len());
        return Err(series.error(found, "at most one in a hundred".to_owned()));
    }
    Ok(missing)
}

fn resample(series: &mut Series, median_s: f64, missing: &[(usize, usize)]) -> f64 {
    let (first, last) = match (series.time_s.first(), series.time_s.last()) {
        (Some(first), Some(last)) => (*first, *last),
        _ => return median_s,
    };
    let count = libm::round((last - first) / median_s) as usize;
    let step_s = tidy((last - first) / count as f64, 1e-6);
    let old = std::mem::take(&mut series.time_s);
    let steps = old.windows(2).map(|pair| pair[1] - pair[0]);
    let (least, most) = steps.fold((f64::MAX, 0.0_f64), |(a, b), s| (a.min(s), b.max(s)));
    let text = if missing.is_empty() {
        format!("steps of {least:.6} to {most:.6} s resampled to {step_s:.6} s")
    } else {
        let lost: usize = missing.iter().map(|(_, lost)| lost).sum();
        let lines = series.lines_of(missing.iter().map(|(sample, _)| *sample));
        format!("{lost} missing samples filled in after line {lines}")
    };
    series.repairs.push(format!("{}: {text}, by cubic interpolation", series.columns[0]));
    let time_s: Vec<f64> = (0..=count).map(|n| first + n as f64 * step_s).collect();
    for channel in series.channels_mut() {
        *channel = interpolated(&old, channel, &time_s);
    }
    let nearest = |time: &f64| old.partition_point(|t| t < time).min(old.len() - 1);
    series.lines = time_s.iter().map(|time| series.line(nearest(time))).collect();
    series.time_s = time_s;
    step_s
}

/// Values at other times: the cubic between two samples with the slopes of parabolas through three.
fn interpolated(old_s: &[f64], values: &[f64], new_s: &[f64]) -> Vec<f64> {
    let count = old_s.len();
    let at =
        |n: usize| (old_s.get(n).copied().unwrap_or(0.0), values.get(n).copied().unwrap_or(0.0));
    let rise = |n: usize| {
        let ((t0, y0), (t1, y1)) = (at(n), at(n + 1));
        ((y1 - y0) / (t1 - t0), t1 - t0)
    };
    let slope = |n: usize| {
        let middle = n.clamp(1, count - 2);
        let ((before, h0), (after, h1)) = (rise(middle - 1), rise(middle));
        let bend = (after - before) / (h0 + h1);
        let centre = (before * h1 + after * h0) / (h0 + h1);
        match n.cmp(&middle) {
            Ordering::Less => centre - 2.0 * bend * h0,
            Ordering::Equal => centre,
            Ordering::Greater => centre + 2.0 * bend * h1,
        }
    };
    new_s
        .iter()
        .map(|time| {
            let next = old_s.partition_point(|t| t <= time).clamp(1, count - 1);
            let ((t0, y0), (t1, y1)) = (at(next - 1), at(next));
            let fraction = ((time - t0) / (t1 - t0)).clamp(0.0, 1.0);
            let ends = ((y0, slope(next - 1)), (y1, slope(next)));
            interpolant::between(ends.0, ends.1, t1 - t0, fraction).0
        })
        .collect()
}
