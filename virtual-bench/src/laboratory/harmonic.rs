//! Harmonics of displacement and force over steady cycles.
//!
//! ```text
//! least squares of  a_0 + sum_k (s_k sin k w t + c_k cos k w t),  k = 1..7
//! ```
//!
//! The frequency is that of the displacement: of the cycle marks first, then corrected by the turn
//! of the first harmonic from the first to the second half of the cycles. No sample has to fall on
//! the beginning of a cycle.

use nalgebra::{DMatrix, DVector};
use std::f64::consts::{PI, TAU};

/// Highest harmonic.
pub const ORDERS: usize = 7;

/// Mean, sine and cosine parts of a signal.
#[derive(Debug, Clone, PartialEq)]
pub struct Harmonics {
    /// Mean.
    pub mean: f64,
    /// Sine and cosine part of orders 1 to 7.
    pub parts: [(f64, f64); ORDERS],
}

impl Harmonics {
    /// Of a signal at a frequency in cycles per sample; phase zero at the first sample. `None`
    /// where there is too little to fit.
    pub fn of(values: &[f64], cycles_per_sample: f64) -> Option<Self> {
        let columns = 2 * ORDERS + 1;
        let mut normal = DMatrix::<f64>::zeros(columns, columns);
        let mut right = DVector::<f64>::zeros(columns);
        let mut row = DVector::<f64>::zeros(columns);
        for (n, value) in values.iter().enumerate() {
            let angle = TAU * cycles_per_sample * n as f64;
            row[0] = 1.0;
            for order in 1..=ORDERS {
                row[2 * order - 1] = libm::sin(order as f64 * angle);
                row[2 * order] = libm::cos(order as f64 * angle);
            }
            normal.syger(1.0, &row, &row, 1.0);
            right.axpy(*value, &row, 1.0);
        }
        normal.fill_upper_triangle_with_lower_triangle();
        let found = normal.cholesky()?.solve(&right);
        let mut parts = [(0.0, 0.0); ORDERS];
        for (order, part) in parts.iter_mut().enumerate() {
            *part = (found[2 * order + 1], found[2 * order + 2]);
        }
        Some(Self { mean: found[0], parts })
    }

    /// Amplitude of an order from 1.
    pub fn amplitude(&self, order: usize) -> f64 {
        debug_assert!((1..=ORDERS).contains(&order), "no order {order}");
        let (s, c) = self.parts[order - 1];
        libm::hypot(s, c)
    }

    /// Phase of an order from 1 against a sine, rad.
    pub fn phase(&self, order: usize) -> f64 {
        debug_assert!((1..=ORDERS).contains(&order), "no order {order}");
        let (s, c) = self.parts[order - 1];
        libm::atan2(c, s)
    }
}

/// Cycles per sample of a periodic signal, from a guess.
pub fn frequency(values: &[f64], guess_cycles_per_sample: f64) -> f64 {
    let mut frequency = guess_cycles_per_sample;
    let half = values.len() / 2;
    for _ in 0..3 {
        let (first, second) = values.split_at(half);
        let (Some(first), Some(second)) =
            (Harmonics::of(first, frequency), Harmonics::of(second, frequency))
        else {
            return frequency;
        };
        let expected = TAU * frequency * half as f64;
        let turn = second.phase(1) - first.phase(1) - expected;
        // To the nearest whole turn.
        let off = turn - TAU * libm::rint(turn / TAU);
        if off.abs() > 0.5 * PI {
            return frequency;
        }
        frequency += off / (TAU * half as f64);
    }
    frequency
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_frequency_come_back_from_cycles_that_no_sample_divides() {
        let f = 3.5173e-3;
        let wave = |n: usize| {
            let angle = TAU * f * n as f64 + 0.4;
            2.0 + 3.0 * libm::sin(angle) + 0.5 * libm::cos(3.0 * angle)
        };
        let values: Vec<f64> = (0..2860).map(wave).collect();
        let found = frequency(&values, f * 1.0005);
        assert!((found / f - 1.0).abs() < 1e-8, "{found}");
        let harmonics = Harmonics::of(&values, found).unwrap();
        assert!((harmonics.mean - 2.0).abs() < 1e-9);
        assert!(
            (harmonics.amplitude(1) - 3.0).abs() < 1e-9 && (harmonics.phase(1) - 0.4).abs() < 1e-8
        );
        assert!((harmonics.amplitude(3) - 0.5).abs() < 1e-9 && harmonics.amplitude(2) < 1e-9);
    }
}
