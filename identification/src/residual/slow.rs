//! The residual without what is slower than the motion.
//!
//! Drift of a bench is slower than the motion of a test; what a damper does is not. So a moving
//! mean over a period of the displacement is subtracted,
//!
//! ```text
//! T = 2 pi rms(x - mean x) / rms(v)
//! ```
//!
//! and what remains is compared with the noise of the samples.

use crate::test_set::{Test, TestSet};
use signal::statistics::{mean, moving_mean, rms};
use std::f64::consts::TAU;

/// rms of the residual over all tests without its part that is slower than the motion, N.
pub(crate) fn rms_without_slow_n(residual_n: &[Vec<f64>], tests: &TestSet) -> f64 {
    let each = tests.tests.iter().zip(residual_n).map(|(test, residual)| {
        let counted = &residual[test.counted()];
        let slow = moving_mean(counted, half_a_period(test));
        counted.iter().zip(slow).map(|(r, slow)| (r - slow) * (r - slow)).sum::<f64>()
    });
    (each.sum::<f64>() / tests.counted_samples().max(1) as f64).sqrt()
}

/// Half a period of the motion, in samples.
fn half_a_period(test: &Test) -> usize {
    let counted = test.counted();
    let x = &test.record.displacement_m[counted.clone()];
    let middle = mean(x);
    let displacement = rms(&x.iter().map(|x| x - middle).collect::<Vec<_>>());
    let velocity = rms(&test.record.velocity_m_per_s[counted]);
    if velocity <= 0.0 {
        return usize::MAX / 2;
    }
    (0.5 * TAU * displacement / velocity / test.record.step_s) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use measurement::{Measurement, Series};

    #[test]
    fn a_drift_is_slow_and_a_residual_at_the_motion_is_not() {
        let w = TAU * 2.0;
        let x = |n: usize| 5e-3 * libm::sin(w * n as f64 * 1e-3);
        let f = |n: usize| 1e4 * libm::cos(w * n as f64 * 1e-3);
        let series =
            Series::sampled("a", 1e3, (0..9000).map(x).collect(), (0..9000).map(f).collect());
        let tests = TestSet::new(vec![Measurement::from_series(series).unwrap()]);
        let of = |residual: &dyn Fn(f64) -> f64| {
            let length = tests.tests[0].record.len();
            let residual_n = (0..length).map(|n| residual(n as f64 * 1e-3)).collect();
            rms_without_slow_n(&[residual_n], &tests)
        };
        let drift = of(&|t| 100.0 * libm::sin(0.3 * t));
        assert!(drift < 5.0, "{drift}");
        let missing = of(&|t| 100.0 * libm::sin(w * t));
        assert!((missing - 71.0).abs() < 2.0, "{missing}");
    }
}
