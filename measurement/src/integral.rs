//! A displacement from a velocity, where only the velocity was recorded.
//!
//! The integral is that of the cubic through four neighbouring samples, exact to the fourth order
//! of the step. An offset of the velocity makes it drift; noise lets it wander. What is removed is
//! a straight line: that through the means over whole cycles where there are some, else that of
//! least squares. The place on the stroke is not known afterwards.

use crate::cycles;

/// A first integral by the trapezium rule over equal steps, without its line, m: for checks that
/// come before the clock.
pub(crate) fn first(time_s: &[f64], velocity_m_per_s: &[f64]) -> Vec<f64> {
    let span_s = time_s.last().zip(time_s.first()).map_or(0.0, |(last, first)| last - first);
    let step_s = span_s / time_s.len().saturating_sub(1).max(1) as f64;
    let mut sum = 0.0;
    let mut integral = vec![0.0];
    for pair in velocity_m_per_s.windows(2) {
        sum += 0.5 * step_s * (pair[0] + pair[1]);
        integral.push(sum);
    }
    integral.truncate(velocity_m_per_s.len());
    without_line(&mut integral, |_| true);
    integral
}

/// The integral over a uniform clock without its drift (m), and the drift (m/s).
pub(crate) fn displacement(velocity_m_per_s: &[f64], step_s: f64) -> (Vec<f64>, f64) {
    let count = velocity_m_per_s.len();
    let last = count.saturating_sub(1);
    // Beyond the ends the velocity goes on as a parabola.
    let at = |n: isize| -> f64 {
        let v = |n: usize| velocity_m_per_s.get(n).copied().unwrap_or(0.0);
        match usize::try_from(n) {
            Ok(n) if n <= last => v(n),
            Ok(_) => 3.0 * v(last) - 3.0 * v(last.saturating_sub(1)) + v(last.saturating_sub(2)),
            Err(_) => 3.0 * v(0) - 3.0 * v(1) + v(2),
        }
    };
    let mut integral = vec![0.0];
    let mut sum = 0.0;
    for n in 0..last {
        let n = n as isize;
        let (before, from, to, after) = (at(n - 1), at(n), at(n + 1), at(n + 2));
        sum += step_s / 24.0 * (13.0 * (from + to) - before - after);
        integral.push(sum);
    }
    let mut slope = without_line(&mut integral, |_| true);
    // The line of least squares through a part of a cycle is not the drift.
    for _ in 0..3 {
        let marks = cycles::find(&integral);
        if let (Some(begin), Some(end)) = (marks.first(), marks.last()) {
            let whole = *begin..*end;
            slope += without_line_of_cycles(&mut integral, &marks, whole);
        }
    }
    (integral, slope / step_s)
}

/// Removes the line of least squares through the values that count; its slope per sample.
fn without_line(values: &mut [f64], counts: impl Fn(usize) -> bool) -> f64 {
    let points = values.iter().enumerate().filter(|(n, _)| counts(*n)).map(|(n, y)| (n as f64, *y));
    let (slope, start) = line(points);
    for (n, value) in values.iter_mut().enumerate() {
        *value -= start + slope * n as f64;
    }
    slope
}

/// Removes the line through the means over whole cycles; its slope per sample.
fn without_line_of_cycles(
    values: &mut [f64],
    marks: &[usize],
    whole: std::ops::Range<usize>,
) -> f64 {
    let mean = |pair: &[usize]| {
        let inside = values.get(pair[0]..pair[1]).unwrap_or_default();
        (0.5 * (pair[0] + pair[1]) as f64, signal::statistics::mean(inside))
    };
    let means: Vec<(f64, f64)> = marks.windows(2).map(mean).collect();
    debug_assert!(whole.end <= values.len(), "marks lie in the record");
    let (slope, start) = line(means.into_iter());
    for (n, value) in values.iter_mut().enumerate() {
        *value -= start + slope * n as f64;
    }
    slope
}

/// Slope and start of the line of least squares.
fn line(points: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    let mut sums = [0.0; 5];
    for (x, y) in points {
        for (sum, part) in sums.iter_mut().zip([1.0, x, x * x, y, x * y]) {
            *sum += part;
        }
    }
    let [one, x, square, y, product] = sums;
    let spread = one * square - x * x;
    if one < 1.0 {
        return (0.0, 0.0);
    }
    let slope = if spread > 0.0 { (one * product - x * y) / spread } else { 0.0 };
    (slope, (y - slope * x) / one)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_sine_with_an_offset_comes_back_without_its_drift() {
        let w = TAU * 2.0;
        for (rate, cycles) in [(100.0, 7.3), (500.0, 3.6)] {
            let count = (rate * cycles / 2.0) as usize;
            let phase = |n: usize| w * n as f64 / rate + 0.7;
            let v: Vec<f64> = (0..count).map(|n| 5e-3 * w * libm::cos(phase(n)) + 2e-3).collect();
            let (x, drift) = displacement(&v, 1.0 / rate);
            assert!((drift / 2e-3 - 1.0).abs() < 0.02, "{drift}");
            let off = |n: usize| x[n] - 5e-3 * libm::sin(phase(n));
            let middle = off(count / 2);
            for n in 0..count {
                assert!((off(n) - middle).abs() < 3e-5, "{rate} {n}: {}", off(n) - middle);
            }
        }
    }
}
