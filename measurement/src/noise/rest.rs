//! Noise while the damper rests.
//!
//! Where the displacement stays within its own noise for 0.3 s, the force is noise and drift. A
//! straight line is taken off each such stretch. What remains is larger while the force still
//! relaxes after a motion, so the lower quartile of all stretches counts.
//!
//! Limits: a lower bound, since noise of the clock, of the displacement and of the gain act only in
//! motion.

use super::white;
use crate::measurement::Measurement;
use signal::statistics::{min_max, percentile, smallest_change};

/// Length of a stretch, s.
const STRETCH_S: f64 = 0.3;
/// Range of the displacement in a stretch, in standard deviations of its noise.
const NOISE_RANGE: f64 = 8.0;
/// The same in steps of its last digit.
const DIGITS: f64 = 2.0;
/// The same as a share of the range of the whole test.
const SHARE_OF_RANGE: f64 = 2e-4;
/// Fewest samples of a stretch.
const FEWEST: usize = 8;

/// rms of a signal of a test (its force or a residual, N) while the damper rests; none where it
/// never rests.
pub fn rms_n(test: &Measurement, values_n: &[f64]) -> Option<f64> {
    debug_assert_eq!(values_n.len(), test.len(), "one value per sample");
    let length = (STRETCH_S / test.step_s).ceil() as usize;
    if length < FEWEST {
        return None;
    }
    let (low, high) = min_max(&test.displacement_m)?;
    let noise_m = white::third_difference_rms(&test.displacement_m).unwrap_or(0.0);
    let digit_m = Some(smallest_change(&test.displacement_m, 0.0)).filter(|d| *d < f64::MAX);
    let still_m = (NOISE_RANGE * noise_m)
        .max(DIGITS * digit_m.unwrap_or(0.0))
        .max(SHARE_OF_RANGE * (high - low))
        .min(0.01 * (high - low));
    let mut squares = Vec::new();
    let stretches = test.displacement_m.chunks_exact(length).zip(values_n.chunks_exact(length));
    for (displacement_m, values_n) in stretches {
        let Some((low, high)) = min_max(displacement_m) else { continue };
        if high - low <= still_m {
            squares.push(about_a_line(values_n) / (length - 2) as f64);
        }
    }
    percentile(&squares, 0.25).filter(|square| *square > 0.0).map(f64::sqrt)
}

/// Sum of squares about the best straight line.
fn about_a_line(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let middle = 0.5 * (count - 1.0);
    let (mut square, mut across, mut along) = (0.0, 0.0, 0.0);
    for (index, value) in values.iter().enumerate() {
        let (t, y) = (index as f64 - middle, value - mean);
        square += y * y;
        across += t * y;
        along += t * t;
    }
    if along > 0.0 { square - across * across / along } else { square }
}
