//! Noise from two tests with the same motion: an earthquake that was run twice, a sequence that was
//! repeated after an hour.
//!
//! The later test is shifted by whole samples and by the rest of a sample until its displacement
//! lies on that of the earlier one. Where the remaining difference is below one per cent of the
//! motion, the residuals of both differ by noise:
//!
//! ```text
//! sigma^2 = mean (r_b - r_a)^2 / 2
//! ```
//!
//! Limits: a change between the tests (warming, wear) counts as noise.

use crate::test_set::{Test, TestSet};

/// Difference of two motions, over the motion, from which they are not the same.
const SAME: f64 = 0.01;
/// Longest shift between two recordings of one motion, as a share of their length.
const LONGEST_SHIFT: f64 = 0.05;
/// Points of the displacement that a first, coarse search compares.
const COARSE_POINTS: usize = 200;
/// Tests that are compared at most: more pairs do not make the floor better known.
const MOST_TESTS: usize = 30;

/// rms of the noise, N; none where no two tests have the same motion.
pub(crate) fn noise_floor_n(residual_n: &[Vec<f64>], tests: &TestSet) -> Option<f64> {
    let (mut squares, mut count) = (0.0, 0.0);
    let all = tests.tests.iter().zip(residual_n).take(MOST_TESTS);
    for (index, (first, first_n)) in all.clone().enumerate() {
        for (second, second_n) in all.clone().skip(index + 1) {
            let Some(shift) = shift(first, second) else { continue };
            let (from, to) = overlap(first, second, shift.whole);
            for (i, first_n) in first_n.iter().enumerate().take(to).skip(from) {
                let k = i.saturating_add_signed(shift.whole);
                let rate = 0.5 * (second_n[k + 1] - second_n[k - 1]);
                let difference = second_n[k] + shift.rest * rate - first_n;
                squares += difference * difference;
                count += 1.0;
            }
        }
    }
    (count > 0.0).then(|| f64::sqrt(0.5 * squares / count))
}

/// Samples by which the second of two tests is late.
struct Shift {
    whole: isize,
    rest: f64,
}

/// The shift that puts two motions on each other; none where they differ.
fn shift(first: &Test, second: &Test) -> Option<Shift> {
    let (a, b) = (&first.record, &second.record);
    let lengths = (a.len() as f64 / b.len() as f64, a.step_s / b.step_s);
    if !(0.9..1.1).contains(&lengths.0) || (lengths.1 - 1.0).abs() > 1e-3 {
        return None;
    }
    let power = signal::statistics::rms(&b.drive_m);
    let most = (LONGEST_SHIFT * a.len() as f64) as isize;
    let stride = (a.len() / COARSE_POINTS).max(1);
    let coarse_step = (stride / 4).max(1) as isize;
    let apart = |whole: isize, stride: usize| -> f64 {
        let (from, to) = overlap(first, second, whole);
        let pairs = (from..to).step_by(stride).map(|i| {
            let difference = b.drive_m[i.saturating_add_signed(whole)] - a.drive_m[i];
            difference * difference
        });
        let (sum, count) = pairs.fold((0.0, 0.0), |(sum, count), d| (sum + d, count + 1.0));
        if count > 0.0 { sum / count } else { f64::INFINITY }
    };
    let best = |candidates: &mut dyn Iterator<Item = isize>, stride: usize| {
        candidates.min_by(|p, q| apart(*p, stride).total_cmp(&apart(*q, stride)))
    };
    let steps = most / coarse_step;
    let coarse = best(&mut (-steps..=steps).map(|k| k * coarse_step), stride)?;
    let whole = best(&mut (coarse - coarse_step..=coarse + coarse_step), stride)?;
    // The rest of a sample, from the slope of the displacement.
    let (from, to) = overlap(first, second, whole);
    let (mut top, mut bottom, mut square) = (0.0, 0.0, 0.0);
    for i in from..to {
        let k = i.saturating_add_signed(whole);
        let slope = b.velocity_m_per_s[k] * b.step_s;
        let difference = a.drive_m[i] - b.drive_m[k];
        top += slope * difference;
        bottom += slope * slope;
        square += difference * difference;
    }
    let rest = if bottom > 0.0 { (top / bottom).clamp(-1.0, 1.0) } else { 0.0 };
    let left = (square - rest * top).max(0.0) / to.saturating_sub(from).max(1) as f64;
    (power > 0.0 && left.sqrt() <= SAME * power).then_some(Shift { whole, rest })
}

/// Counted samples of the first test whose partner in the second is counted and has neighbours.
fn overlap(first: &Test, second: &Test, whole: isize) -> (usize, usize) {
    let (a, b) = (first.counted(), second.counted());
    let from = a.start.max((b.start + 1).saturating_add_signed(-whole)).max(1);
    let to = a.end.min((b.end - 1).saturating_add_signed(-whole));
    (from, to.max(from))
}
