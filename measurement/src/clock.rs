//! From time stamps to one uniform clock.
//!
//! Time stamps that lie on a line within 1 % of a step, or each within the rounding of its own last
//! digit, are that line: the samples stay what they are. Digits may be few, and fewer for late
//! stamps than for early ones (`0.0003328`, `3.9923`, `1e-05`), as long as a tenth of the stamps
//! have a last digit of at most five steps. Otherwise the channels are resampled to the median step
//! by the cubic through neighbouring samples whose slopes are those of the parabola through three
//! (Hermite); this is reported as a repair. Its limits: every step within 30 % of the median; up to
//! three samples missing in a row and one in a hundred in all. What is worse is an error with its
//! line, and so is a timer that gives several rows one stamp.

use crate::error::MeasurementError;
use crate::interpolant;
use crate::number::{self, of_stamp};
use crate::series::Series;
use std::cmp::Ordering;

/// Share of a step by which time stamps may deviate from a uniform clock.
const UNIFORM_SHARE: f64 = 0.01;
/// Share of the last digit by which a stamp may lie off the line: half of it by rounding.
const ROUNDING: f64 = 0.6;
/// Steps that the last digit of a stamp that fixes the clock may be.
const COARSE_STEPS: f64 = 5.0;
/// Share of stamps that have to fix the clock.
const FINE_SHARE: f64 = 0.1;
/// Share of the median step by which a step may differ and is still resampled.
const JITTER_SHARE: f64 = 0.3;
/// Most samples in a row that are filled in.
const FILLED_IN_A_ROW: usize = 3;
/// Most samples of all that are filled in, as a share.
const FILLED_SHARE: f64 = 0.01;
/// Share of rows with the stamp of the row before them from which a timer is coarse.
const SHARED_SHARE: f64 = 0.05;
/// The way out where stamps are no use.
const WAY_OUT: &str = "sample_rate_hz in a mapping takes the place of the time column";

/// Brings a series to a uniform clock; gives its step (s). Needs at least three samples.
///
/// # Errors
/// Time that goes back, repeated stamps with other values, gaps and steps beyond the limits.
pub(crate) fn make_uniform(series: &mut Series) -> Result<f64, MeasurementError> {
    let (step_s, deviation_s) = line_through(&series.time_s);
    if step_s > 0.0 && deviation_s <= UNIFORM_SHARE * step_s {
        return Ok(tidy(step_s, 1e-6));
    }
    if let Some(step_s) = line_within_digits(&series.time_s, &series.time_resolution_s) {
        let digits = &series.time_resolution_s;
        let least = digits.iter().copied().fold(f64::INFINITY, f64::min);
        let most = digits.iter().copied().fold(0.0, f64::max);
        let step_s = tidy(step_s, certainty(digits, step_s));
        let (least, most) = (seconds(least), seconds(most));
        let digits = if least == most { least } else { format!("{least} to {most}") };
        series.repairs.push(format!(
            "{}: stamps rounded to {digits} s taken as equal steps of {step_s:.6} s, {:.6} Hz",
            series.columns[0],
            1.0 / step_s
        ));
        return Ok(step_s);
    }
    refuse_coarse(series)?;
    drop_repeats(series)?;
    let median_s = median_step(&series.time_s);
    let missing = check_steps(series, median_s)?;
    Ok(resample(series, median_s, &missing))
}

/// A size as text without the noise of binary fractions.
fn seconds(size_s: f64) -> String {
    if !(1e-12..1e12).contains(&size_s) {
        return files::number(size_s).to_string();
    }
    let text = format!("{size_s:.12}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Step of a line that every stamp lies on within its own last digit, rounded or cut off.
fn line_within_digits(time_s: &[f64], digits_s: &[f64]) -> Option<f64> {
    if digits_s.len() != time_s.len() || digits_s.iter().any(|digit| *digit <= 0.0) {
        return None;
    }
    let middles = time_s.iter().zip(digits_s).map(|(time, digit)| time + 0.5 * digit);
    let step_s = weighted_line(time_s, digits_s)
        .or_else(|| weighted_line(&middles.collect::<Vec<_>>(), digits_s))?;
    let is_fine = |digit: &&f64| **digit <= COARSE_STEPS * step_s;
    let fine = digits_s.iter().filter(is_fine).count();
    (fine as f64 >= FINE_SHARE * time_s.len() as f64).then_some(step_s)
}

/// Step of the line with the least distances from all stamps in units of their last digits, if none
/// is too far: least squares whose weights grow where the distance is large (Lawson 1961).
fn weighted_line(time_s: &[f64], digits_s: &[f64]) -> Option<f64> {
    let first = time_s.first().copied()?;
    let mut weights: Vec<f64> = digits_s.iter().map(|digit| 1.0 / (digit * digit)).collect();
    for _ in 0..20 {
        let mut sums = [0.0; 5];
        for (n, (time, weight)) in time_s.iter().zip(&weights).enumerate() {
            let (n, time) = (n as f64, time - first);
            let parts = [1.0, n, n * n, time, n * time];
            for (sum, part) in sums.iter_mut().zip(parts) {
                *sum += weight * part;
            }
        }
        let [one, n, square, time, product] = sums;
        let step_s = (one * product - n * time) / (one * square - n * n);
        let start_s = (time - step_s * n) / one;
        if !(step_s > 0.0 && step_s.is_finite()) {
            return None;
        }
        let mut farthest = 0.0_f64;
        for ((n, (time, digit)), weight) in
            time_s.iter().zip(digits_s).enumerate().zip(&mut weights)
        {
            let off = (time - first - start_s - step_s * n as f64).abs() / digit;
            farthest = farthest.max(off);
            *weight *= 0.1 + off;
        }
        if farthest <= ROUNDING {
            return Some(step_s);
        }
    }
    None
}

/// Share of a step that the stamps leave open together.
fn certainty(digits_s: &[f64], step_s: f64) -> f64 {
    let mut sums = [0.0; 3];
    for (n, digit) in digits_s.iter().enumerate() {
        let (n, weight) = (n as f64, 1.0 / (digit * digit));
        for (sum, part) in sums.iter_mut().zip([1.0, n, n * n]) {
            *sum += weight * part;
        }
    }
    let [one, n, square] = sums;
    1.0 / ((square - n * n / one).sqrt() * step_s)
}

/// Refuses a timer that gives several rows one stamp.
fn refuse_coarse(series: &Series) -> Result<(), MeasurementError> {
    let time_s = &series.time_s;
    let other = |values: &[f64], n: usize| values.get(n) != values.get(n + 1);
    let shares = |n: &usize| {
        time_s.get(*n) == time_s.get(n + 1)
            && (other(&series.displacement_m, *n) || other(&series.force_n, *n))
    };
    let shared: Vec<usize> = (0..time_s.len().saturating_sub(1)).filter(shares).collect();
    let Some(first) =
        shared.first().filter(|_| shared.len() as f64 >= SHARED_SHARE * time_s.len() as f64)
    else {
        return Ok(());
    };
    let steps = time_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
    let tick = steps.fold(f64::INFINITY, f64::min);
    let timer = if tick.is_finite() {
        format!("a timer that counts in {} s", seconds(tick))
    } else {
        "a timer that stands still".to_owned()
    };
    let found = format!(
        "{} of {} rows with the stamp of the row before and other values, {timer}",
        shared.len(),
        time_s.len()
    );
    let rate = rate_of_coarse(time_s).map_or(String::new(), |rate_hz| {
        format!(" (here about {} a second)", number::fixed(rate_hz, 0))
    });
    let expected =
        format!("a stamp for every row: {WAY_OUT}, if the rows are equally spaced{rate}");
    Err(series.error_of_time(first + 1, found, expected))
}

/// Rows a second (Hz) between the first and the last change of the stamp: the rows of the first
/// stamp and those of the last one may be a part of a tick.
fn rate_of_coarse(time_s: &[f64]) -> Option<f64> {
    let rises = |n: &usize| time_s[*n] > time_s[n - 1];
    let mut changes = (1..time_s.len()).filter(rises);
    let first = changes.next()?;
    let last = changes.next_back().unwrap_or(first);
    if first == last {
        return None;
    }
    Some((last - first) as f64 / (time_s[last] - time_s[first]))
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
        let found = format!("{} s after {} s", of_stamp(now), of_stamp(before));
        if now < before {
            let expected =
                format!("rising time; split_by separates several tests of a file, and {WAY_OUT}");
            return Err(series.error_of_time(sample, found, expected));
        }
        if !(same(&series.displacement_m) && same(&series.force_n)) {
            let expected = format!("rising time, or the same values at the same time; {WAY_OUT}");
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
        let expected = format!("steps of {} s, each within 30 %", number::fixed(median_s, 6));
        if (steps - whole).abs() > JITTER_SHARE {
            let found = format!("a step of {} s", number::fixed(pair[1] - pair[0], 6));
            let expected = format!("{expected}; {WAY_OUT}");
            return Err(series.error_of_time(sample + 1, found, expected));
        }
        let lost = whole as usize - 1;
        if lost > FILLED_IN_A_ROW {
            let gap = number::fixed(pair[1] - pair[0], 6);
            let found = format!("a gap of {gap} s, {lost} samples");
            let expected = format!(
                "{expected}; up to {FILLED_IN_A_ROW} missing samples are filled; {WAY_OUT}"
            );
            return Err(series.error_of_time(sample + 1, found, expected));
        }
        if lost > 0 {
            missing.push((sample, lost));
        }
    }
    let all: usize = missing.iter().map(|(_, lost)| lost).sum();
    if all as f64 > FILLED_SHARE * series.time_s.len() as f64 {
        let found = format!("{all} missing samples in {} gaps", missing.len());
        return Err(series.error(found, format!("at most one in a hundred; {WAY_OUT}")));
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
