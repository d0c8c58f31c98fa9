//! What can be wrong with a test: each finding is an error in one line or a line of repair.

use super::clock::listed;
use super::error::MeasurementError;
use super::series::Series;
use crate::statistics::{mean, min_max, rms};

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
        let found = format!("{displacement} over {travel_m:.4} m and {force} over {reach_n:.4} N");
        return Err(series.error(found, expected));
    }
    if reach_n > FORCE_MOST_N {
        let found = format!("{force} over {reach_n:.0} N");
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
/// Slower than 100 Hz; less than about one cycle (travel below 1.75 times the range) without a hold
/// of 30 % of the record.
pub fn length(series: &Series, step_s: f64) -> Result<(), MeasurementError> {
    let rate_hz = 1.0 / step_s;
    if rate_hz < RATE_LEAST_HZ * (1.0 - 1e-6) {
        let found = format!("{rate_hz:.6} samples per second");
        return Err(series.error(found, format!("at least {RATE_LEAST_HZ}")));
    }
    let x = &series.displacement_m;
    let (range, band) = (span(x), 0.1 * span(x));
    let (mut travel, mut turned) = (0.0, x.first().copied().unwrap_or(0.0));
    for value in x {
        // Steps of a tenth of the range: noise travels nowhere.
        if (value - turned).abs() >= band {
            travel += (value - turned).abs();
            turned = *value;
        }
    }
    let part = (3 * x.len()).div_ceil(10);
    let holds = x.windows(part).step_by((part / 20).max(1)).any(|part| span(part) < 0.02 * range);
    if travel < 1.75 * range && !holds {
        let found = format!(
            "{:.2} s with a travel of {:.1} times the range",
            step_s * x.len() as f64,
            travel / range
        );
        return Err(series.error(found, "about a whole cycle at least, or a hold".to_owned()));
    }
    Ok(())
}

/// Work that the damper took up between two samples (J), the mean force left out, and that work over
/// the sum of its absolute parts.
pub fn work_j(displacement_m: &[f64], force_n: &[f64]) -> (f64, f64) {
    let middle = mean(force_n);
    let (mut work, mut parts) = (0.0, 0.0);
    for (x, f) in displacement_m.windows(2).zip(force_n.windows(2)) {
        let part = (0.5 * (f[0] + f[1]) - middle) * (x[1] - x[0]);
        work += part;
        parts += part.abs();
    }
    (work, if parts > 0.0 { work / parts } else { 0.0 })
}

/// Turns the force where the damper would have given work; it shows only that the signs of
/// displacement and force agree.
///
/// # Errors
/// Work is given and the "displacement" is three times as rough as the "force": swapped columns.
pub fn agree(series: &mut Series, cycles: &[usize]) -> Result<(), MeasurementError> {
    let range = match (cycles.first(), cycles.last()) {
        (Some(first), Some(last)) => *first..*last,
        _ => 0..series.force_n.len(),
    };
    let part = |values: &[f64]| values.get(range.clone()).unwrap_or(values).to_vec();
    let (work, share) = work_j(&part(&series.displacement_m), &part(&series.force_n));
    let [_, displacement, force] = &series.columns;
    if share < -0.02 {
        let (rough_x, rough_f) = (roughness(&series.displacement_m), roughness(&series.force_n));
        if rough_x > 3.0 * rough_f {
            let found = format!("{displacement} rougher than {force}, and {work:.4} J taken up");
            let expected = "a smooth displacement and positive work: are the columns swapped?";
            return Err(series.error(found, expected.to_owned()));
        }
        series.repairs.push(format!("{force}: sign turned, the damper took up {work:.4} J"));
        for value in &mut series.force_n {
            *value = -*value;
        }
    } else if share < 0.02 {
        series.repairs.push(format!(
            "left as it is: {work:.4} J taken up are too little to show that {displacement} and {force} agree in sign"
        ));
    }
    Ok(())
}

/// Second differences over first differences: a corner makes it large, a sine small.
fn roughness(values: &[f64]) -> f64 {
    let first: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let second: Vec<f64> = first.windows(2).map(|pair| pair[1] - pair[0]).collect();
    rms(&second) / rms(&first).max(f64::MIN_POSITIVE)
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
    let changes = force.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let digit = changes.filter(|change| *change > close).fold(f64::MAX, f64::min);
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

/// Tells of clipped samples.
pub fn tell_clipped(series: &mut Series) {
    if let Some((limit, samples)) = clipped(series) {
        let lines = listed(samples.iter().map(|sample| series.line(*sample)));
        series.repairs.push(format!(
            "left as it is: {} stays at its extreme {limit} N in {} samples while the damper moves, lines {lines}: clipped?",
            series.columns[2],
            samples.len()
        ));
    }
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
