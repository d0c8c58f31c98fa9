//! Force and displacement at the frequency of a sine.
//!
//! ```text
//! y(t) = c + Re(Y exp(i w t)) + rest        Y = a - i b: least squares over the samples
//! H = F / X                                 force over displacement, with phase
//! ```
//! The fit needs no whole periods and no sample in every cycle. Limit: the sine is taken to be
//! steady; the samples in which it rises do not belong here.

use crate::run::MeasuredTest;
use num_complex::Complex;
use std::f64::consts::TAU;

/// Force and displacement of a test with a sine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SinePair {
    /// Angular frequency (rad/s).
    pub(super) omega: f64,
    /// Displacement (m).
    pub(super) displacement_m: Complex<f64>,
    /// Force (N).
    pub(super) force_n: Complex<f64>,
    /// Rms of what of the force is no sine of this frequency, over the rms of the one that is.
    pub(super) force_rest: f64,
}

impl SinePair {
    /// The sine of a test from a time on; none of fewer than ten samples, or without motion.
    pub fn of(test: &MeasuredTest, frequency_hz: f64, from_s: f64) -> Option<Self> {
        let from = test.time_s.partition_point(|time_s| *time_s < from_s);
        let time_s = test.time_s.get(from..)?;
        Self::of_samples(time_s, &test.displacement_m[from..], &test.force_n[from..], frequency_hz)
    }

    /// The same of samples.
    pub(super) fn of_samples(
        time_s: &[f64],
        displacement_m: &[f64],
        force_n: &[f64],
        frequency_hz: f64,
    ) -> Option<Self> {
        debug_assert!(frequency_hz > 0.0, "a sine of {frequency_hz} Hz");
        let omega = TAU * frequency_hz;
        let (displacement_m, _) = sine(time_s, displacement_m, omega)?;
        let (force_n, rest_n) = sine(time_s, force_n, omega)?;
        let force_rest = rest_n / (force_n.norm() / f64::sqrt(2.0));
        (displacement_m.norm() > 0.0).then_some(Self { omega, displacement_m, force_n, force_rest })
    }

    /// Frequency (Hz).
    pub(super) fn frequency_hz(&self) -> f64 {
        self.omega / TAU
    }
}

/// The sine of an angular frequency in samples, and the rms of the rest.
fn sine(time_s: &[f64], values: &[f64], omega: f64) -> Option<(Complex<f64>, f64)> {
    if time_s.len() < 10 || time_s.len() != values.len() {
        return None;
    }
    let row = |time_s: f64| {
        let (sin, cos) = libm::sincos(omega * time_s);
        [1.0, cos, sin]
    };
    let (mut normal, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for (time_s, value) in time_s.iter().zip(values) {
        let row = row(*time_s);
        for (i, of_row) in row.iter().enumerate() {
            right[i] += of_row * value;
            for (j, of_column) in row.iter().enumerate() {
                normal[i][j] += of_row * of_column;
            }
        }
    }
    let [mean, cosine, sine] = solved(normal, right)?;
    let squares: f64 = time_s
        .iter()
        .zip(values)
        .map(|(time_s, value)| {
            let [_, of_cosine, of_sine] = row(*time_s);
            (value - mean - cosine * of_cosine - sine * of_sine).powi(2)
        })
        .sum();
    let rest = (squares / (values.len() - 3) as f64).sqrt();
    Some((Complex::new(cosine, -sine), rest))
}

/// Solves three symmetric equations by Cramer's rule; none where they do not determine it.
fn solved(normal: [[f64; 3]; 3], right: [f64; 3]) -> Option<[f64; 3]> {
    let determinant = |m: &[[f64; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
            - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    let whole = determinant(&normal);
    let scale: f64 = (0..3).map(|i| normal[i][i]).product();
    if whole.is_nan() || whole <= 1e-9 * scale {
        return None;
    }
    let mut solution = [0.0; 3];
    for (column, value) in solution.iter_mut().enumerate() {
        let mut replaced = normal;
        for (row, of_right) in replaced.iter_mut().zip(right) {
            row[column] = of_right;
        }
        *value = determinant(&replaced) / whole;
    }
    Some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_with_an_offset_and_gaps_is_found_exactly() {
        let omega = TAU * 3.5;
        // Neither whole periods nor every sample.
        let time_s: Vec<f64> =
            (0..730).filter(|n| n % 7 != 3).map(|n| 1e-3 * f64::from(n)).collect();
        let at = |t: &f64| 5.0 + 2.0 * libm::cos(omega * t) + 3.0 * libm::sin(omega * t);
        let (found, rest) =
            sine(&time_s, &time_s.iter().map(at).collect::<Vec<_>>(), omega).unwrap();
        assert!((found - Complex::new(2.0, -3.0)).norm() < 1e-9, "{found}");
        assert!(rest < 1e-9, "{rest}");
        assert_eq!(sine(&time_s[..9], &time_s[..9], omega), None);
        // A moment of a slow sine does not tell it from its mean.
        assert_eq!(sine(&time_s[..20], &time_s[..20], 1e-3), None);
    }
}
