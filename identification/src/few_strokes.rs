//! An effect that only a few strokes show, judged by the samples of those strokes.
//!
//! Blocks that are few cannot be compared with their own scatter. The whitened samples within them
//! are nearly independent, so Student's test takes their place: with the residual `r` and the
//! change `d` over the `n` samples that carry it, and `k` parameters of the effect,
//!
//! ```text
//! b = d'r / d'd      s^2 = |r - b d|^2 / (n - k)      t = b |d| / s with n - k degrees of freedom
//! ```
//!
//! Limits: any pulse of the right length resembles a stop, so the test holds only where the rest of
//! these strokes is hardly louder than the residual outside them: a shape that fits in part proves
//! nothing.

use super::chance::beyond;

/// Square of the change at a sample that carries it, as a share of the largest.
const CARRIES: f64 = 1e-3;
/// rms of the rest within the strokes over that of the residual outside them, at most.
const AS_QUIET: f64 = 2.0;
/// Fewest degrees of freedom.
const FEWEST: usize = 6;

/// Probability that chance makes the residual follow a change over the few samples that carry it;
/// none where the rest of them is louder than the residual elsewhere, or they are too few.
pub(crate) fn p_value(change: &[f64], residual: &[f64], parameters: usize) -> Option<f64> {
    debug_assert_eq!(change.len(), residual.len(), "both cover the same samples");
    let largest = change.iter().map(|d| d * d).fold(0.0, f64::max);
    let (mut product, mut square, mut count) = (0.0, 0.0, 0_usize);
    let carries = |d: f64| d * d > CARRIES * largest;
    for (d, r) in change.iter().zip(residual).filter(|(d, _)| carries(**d)) {
        (product, square, count) = (product + d * r, square + d * d, count + 1);
    }
    let freedom = count.checked_sub(parameters).filter(|freedom| *freedom >= FEWEST)? as f64;
    let b = product / square;
    let (mut inside, mut outside, mut others) = (0.0, 0.0, 0_usize);
    for (d, r) in change.iter().zip(residual) {
        if carries(*d) {
            inside += (r - b * d) * (r - b * d);
        } else {
            (outside, others) = (outside + r * r, others + 1);
        }
    }
    let (variance, quiet) = (inside / freedom, outside / others.max(1) as f64);
    if others == 0 || variance > AS_QUIET * AS_QUIET * quiet {
        return None;
    }
    let t = b * square.sqrt() / variance.sqrt();
    Some(beyond(t, freedom))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noise of the size 1 without a random number.
    fn noise(count: usize) -> Vec<f64> {
        (0..count).map(|n| 1.4 * libm::sin(1e4 * libm::sin((n * n + 1) as f64))).collect()
    }

    /// A pulse of the height 1 over 20 samples.
    fn pulse(count: usize) -> Vec<f64> {
        let at = |n: usize| libm::sin(std::f64::consts::PI * (n as f64 - 300.0) / 20.0);
        (0..count).map(|n| if (301..320).contains(&n) { at(n) } else { 0.0 }).collect()
    }

    #[test]
    fn a_pulse_that_leaves_noise_is_evidence() {
        let change: Vec<f64> = pulse(1000).iter().map(|p| 30.0 * p).collect();
        let residual: Vec<f64> = noise(1000).iter().zip(&change).map(|(n, d)| n + d).collect();
        let p = p_value(&change, &residual, 2).unwrap();
        assert!(p < 1e-12, "{p}");
        // Without the pulse in the residual it is chance.
        let p = p_value(&change, &noise(1000), 2).unwrap();
        assert!(p > 0.01, "{p}");
    }

    #[test]
    fn a_pulse_of_another_shape_is_no_evidence() {
        let change: Vec<f64> = pulse(1000).iter().map(|p| 30.0 * p).collect();
        let square = |d: &f64| if *d > 0.0 { 30.0 } else { 0.0 };
        let residual: Vec<f64> =
            noise(1000).iter().zip(&change).map(|(n, d)| n + square(d)).collect();
        assert_eq!(p_value(&change, &residual, 2), None);
        // Four samples decide nothing.
        let spike: Vec<f64> = (0..1000).map(|n| if n / 4 == 50 { 30.0 } else { 0.0 }).collect();
        assert_eq!(p_value(&spike, &spike, 2), None);
    }
}
