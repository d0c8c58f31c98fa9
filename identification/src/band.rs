//! Does an effect gain in the band of the motion, or only above it?
//!
//! A model that filters the noise of its own drive predicts better without being right: a moving
//! mass cancels a part of what jitter of the clock makes of a stiff damper, and a relaxing
//! attachment rounds the kinks of a force that was averaged. Both happen above the frequencies of
//! the motion. So the residuals on left-out pieces, without and with the effect, are compared once
//! more after a moving mean over a quarter of the period of
//!
//! ```text
//! f = rms(a) / (2 pi rms(v))
//! ```
//!
//! An effect of the damper acts at the frequencies of the motion, and gains there too.
//!
//! Limits: an effect of short blows alone gains little there.

use super::judged::Judged;
use super::test_set::TestSet;
use signal::statistics::{moving_mean, rms};
use std::f64::consts::TAU;

/// Share of the squared error in the band of the motion that a richer model removes on left-out
/// pieces.
pub(crate) fn gain_in_band(poorer: &Judged, richer: &Judged, tests: &TestSet) -> f64 {
    let (mut before_n2, mut after_n2) = (0.0, 0.0);
    for (index, piece) in tests.pieces.iter().enumerate() {
        let record = &tests.tests[piece.test].record;
        let inside = piece.samples.clone();
        let velocity = rms(&record.velocity_m_per_s[inside.clone()]);
        let acceleration = rms(&record.acceleration_m_per_s2[inside.clone()]);
        if acceleration <= 0.0 {
            continue;
        }
        let quarter_s = 0.25 * TAU * velocity / acceleration;
        let half = (0.5 * quarter_s / record.step_s) as usize;
        let squares = |model: &Judged| {
            let force_n = &model.left_out.force_n[index];
            let residual = record.force_n[inside.clone()].iter().zip(force_n).map(|(y, f)| y - f);
            moving_mean_squares(&residual.collect::<Vec<f64>>(), half)
        };
        before_n2 += squares(poorer);
        after_n2 += squares(richer);
    }
    if before_n2 > 0.0 { 1.0 - after_n2 / before_n2 } else { 0.0 }
}

/// Sum of the squares of a moving mean over `half` samples to either side.
fn moving_mean_squares(values: &[f64], half: usize) -> f64 {
    moving_mean(values, half).iter().map(|mean| mean * mean).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moving_mean_keeps_a_constant_and_removes_what_alternates() {
        assert!((moving_mean_squares(&[2.0; 10], 3) - 40.0).abs() < 1e-12);
        let alternating: Vec<f64> = (0..100).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert!(moving_mean_squares(&alternating, 10) < 0.5);
    }
}
