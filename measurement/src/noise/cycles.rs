//! Noise from cycle to cycle.
//!
//! Two cycles that follow each other hold the same motion, so their forces at equal phase differ by
//! noise alone. With whole shifts of `L` samples and the rest `tau` of the shift taken from the
//! displacement,
//! ```text
//! d_n = F_(n+L) - F_n - tau F'_n        sigma^2 = rss(d) / (2 (N - p))
//! ```
//! The 2 is the scatter of the cycle that serves as reference. The sum is that of the residual
//! after `p = 4` regressors common to all pairs: one, the force, and the differences of
//! displacement and velocity. They absorb what is no noise: drift of the offset, fading by warmth,
//! an actuator that does not repeat itself. Noise of any colour counts as long as it decorrelates
//! within a cycle. Limits: what repeats with the motion (ripple in phase with it) is no noise here.

use crate::measurement::Measurement;
use nalgebra::{Matrix4, Vector4};
use std::ops::Range;

/// From cycle to cycle; `None` with fewer than two whole cycles behind the run-in.
pub fn rms_n(test: &Measurement) -> Option<f64> {
    let (x, v, f) = (&test.displacement_m, &test.velocity_m_per_s, &test.force_n);
    let (mut rows, mut differences) = (Vec::new(), Vec::new());
    let after_run_in = |pair: &&[usize]| pair[0] >= test.run_in;
    for pair in test.runs.iter().flat_map(|marks| marks.windows(3)).filter(after_run_in) {
        let (start, shift) = (pair[0], pair[1] - pair[0]);
        let end = pair[1].min(x.len().saturating_sub(shift + 1));
        let here = |n: usize| Some((*x.get(n)?, *v.get(n)?, *f.get(n)?));
        let late_s = rest_of_shift_s((x, v), start..end, shift);
        for n in start.max(1)..end {
            let ((x0, v0, f0), (x1, v1, f1)) = (here(n)?, here(n + shift)?);
            let slope = |at: usize| Some((f.get(at + 1)? - f.get(at - 1)?) / (2.0 * test.step_s));
            let slope = 0.5 * (slope(n)? + slope(n + shift)?);
            let turn = 0.5 * (test.acceleration(n) + test.acceleration(n + shift));
            rows.push([
                1.0,
                0.5 * (f0 + f1),
                x1 - x0 - late_s * 0.5 * (v0 + v1),
                v1 - v0 - late_s * turn,
            ]);
            differences.push(f1 - f0 - late_s * slope);
        }
    }
    if differences.len() < 30 {
        return None;
    }
    let rss = residual_sum(&rows, &differences);
    Some((rss / (2.0 * (differences.len() - 4) as f64)).sqrt())
}

/// The part of the shift between two cycles that is no whole sample, s, from the displacement and
/// its slope over the samples of the first one.
pub fn rest_of_shift_s((x, v): (&[f64], &[f64]), first: Range<usize>, shift: usize) -> f64 {
    debug_assert!(first.end + shift <= x.len() && x.len() == v.len(), "{first:?} and {shift}");
    let (mut top, mut bottom) = (0.0, 0.0);
    for n in first {
        let mean = 0.5 * (v[n] + v[n + shift]);
        top += mean * (x[n + shift] - x[n]);
        bottom += mean * mean;
    }
    if bottom > 0.0 { top / bottom } else { 0.0 }
}

/// Sum of squares of the residual of four regressors; empty ones explain nothing.
fn residual_sum(rows: &[[f64; 4]], values: &[f64]) -> f64 {
    let mut size = [0.0_f64; 4];
    for row in rows {
        for (size, entry) in size.iter_mut().zip(row) {
            *size += entry * entry;
        }
    }
    let scaled = |row: &[f64; 4]| {
        Vector4::from_fn(|i, _| if size[i] > 0.0 { row[i] / size[i].sqrt() } else { 0.0 })
    };
    // A trace on the diagonal keeps empty regressors from being divided by.
    let mut normal = Matrix4::identity() * 1e-12;
    let mut right = Vector4::zeros();
    for (row, value) in rows.iter().zip(values) {
        let row = scaled(row);
        normal += row * row.transpose();
        right += row * *value;
    }
    let weights = normal.lu().solve(&right).unwrap_or_else(Vector4::zeros);
    let rest = |(row, value): (&[f64; 4], &f64)| value - weights.dot(&scaled(row));
    rows.iter().zip(values).map(rest).map(|rest| rest * rest).sum()
}
