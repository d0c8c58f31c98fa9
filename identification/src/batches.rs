//! A constant under a coloured residual, by the means of batches.
//!
//! A residual that is mostly the missing shape of other effects is coloured, and a comparison block
//! by block takes a constant under it for chance. The means of a dozen long batches hardly depend
//! on each other, and Student's test on them (two-sided) sees the constant:
//!
//! ```text
//! t = mean of the means / (s / sqrt(n)), with n - 1 degrees of freedom
//! ```
//!
//! Limits: drift that is slower than a batch looks like a constant. On noise with a corner of 0.05
//! Hz, 50 s long, one constant in 130 is false at p < 0.001; with 0.02 Hz one in ten.

use super::chance::one_sided;
use super::test_set::TestSet;

/// Batches of all tests together.
const BATCHES: usize = 12;
/// Fewest batches of a test.
const FEWEST_OF_A_TEST: usize = 2;
/// Effects that are a constant, or the asymmetry that a constant may be taken for.
const CONSTANTS: [&str; 3] = ["force_offset", "gas_preload", "asymmetric_damping"];

/// True for an effect that is judged by the means of batches too.
pub(crate) fn is_constant(effect: &str) -> bool {
    CONSTANTS.contains(&effect)
}

/// A constant in a residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constant {
    /// Mean of the batch means, N.
    pub mean_n: f64,
    /// Probability that a residual without a constant has batch means so far from zero.
    pub p_value: f64,
}

/// The constant in a residual.
pub(crate) fn constant(residual_n: &[Vec<f64>], tests: &TestSet) -> Constant {
    let batch = tests.tests.iter().map(|test| test.counted().len()).sum::<usize>() / BATCHES;
    let means = tests.tests.iter().zip(residual_n).flat_map(|(test, residual)| {
        let counted = &residual[test.counted()];
        let batches = (counted.len() / batch.max(1)).max(FEWEST_OF_A_TEST);
        let length = (counted.len() / batches).max(1);
        counted.chunks_exact(length).map(signal::statistics::mean).collect::<Vec<_>>()
    });
    let means: Vec<f64> = means.collect();
    let turned: Vec<f64> = means.iter().map(|mean| -mean).collect();
    let p_value = (2.0 * one_sided(&means).min(one_sided(&turned))).min(1.0);
    Constant { mean_n: signal::statistics::mean(&means), p_value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use measurement::{Measurement, Series};
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    /// 50 s at 100 Hz.
    fn tests() -> TestSet {
        let x = |n: usize| 5e-3 * libm::sin(0.05 * n as f64);
        let f = |n: usize| 1e3 * libm::cos(0.05 * n as f64);
        let series =
            Series::sampled("a", 100.0, (0..5000).map(x).collect(), (0..5000).map(f).collect());
        TestSet::new(vec![Measurement::from_series(series).unwrap()])
    }

    /// An autoregression of unit variance with a corner of 0.5 Hz.
    fn coloured(seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let rho = libm::exp(-std::f64::consts::TAU * 0.5 / 100.0);
        let mut value = 0.0;
        let mut next = move || {
            let uniform = f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5;
            value = rho * value + ((1.0 - rho * rho) * 12.0).sqrt() * uniform;
            value
        };
        (0..5000).map(|_| next()).collect()
    }

    #[test]
    fn a_constant_is_seen_under_coloured_noise_and_none_is_invented() {
        let tests = tests();
        let below = |offset: f64| {
            let each = (0..200).filter(|seed| {
                let residual = coloured(*seed).iter().map(|r| r + offset).collect();
                constant(&[residual], &tests).p_value < 1e-3
            });
            each.count()
        };
        assert!(below(0.0) <= 3, "{} of 200", below(0.0));
        assert!(below(1.0) >= 195, "{} of 200", below(1.0));
    }
}
