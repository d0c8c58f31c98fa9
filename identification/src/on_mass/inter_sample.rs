//! The force between the samples: on a clock that is a whole number of times faster.
//!
//! A periodic force without content above half the sampling rate is known everywhere from the
//! samples of one period; the Fourier series gives it exactly. A force that is not periodic is
//! interpolated by a windowed sinc of 48 samples, exact to 1e-7 up to 0.8 of half the rate, and
//! continued beyond its two ends by a turn of half a circle about the last sample.

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

/// Samples to each side that the windowed sinc uses.
const REACH: i64 = 24;
/// Shape of its Kaiser window.
const SHAPE: f64 = 12.0;

/// One period on a clock that is `factor` times faster.
pub(super) fn periodic(values: &[f64], factor: usize) -> Vec<f64> {
    let (count, fine) = (values.len(), values.len() * factor);
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, back) = (planner.plan_fft_forward(count), planner.plan_fft_inverse(fine));
    let mut signal = values.to_vec();
    let mut lines = forward.make_output_vec();
    let mut wide = back.make_input_vec();
    let mut result = back.make_output_vec();
    // Transforms fail only for slices of other lengths than they made themselves.
    let done = forward.process(&mut signal, &mut lines).is_ok();
    let scale = 1.0 / count as f64;
    for (number, (slot, line)) in wide.iter_mut().zip(&lines).enumerate() {
        // The line at half the rate stands for two, one on each side.
        let half = 2 * number == count && factor > 1;
        *slot = line * if half { 0.5 * scale } else { scale };
    }
    for end in [0, wide.len() - 1] {
        if end == 0 || fine.is_multiple_of(2) {
            wide[end] = Complex::new(wide[end].re, 0.0);
        }
    }
    let done = done && back.process(&mut wide, &mut result).is_ok();
    debug_assert!(done, "a transform of its own length");
    result
}

/// From the first to the last sample on a clock that is `factor` times faster:
/// `(n - 1) * factor + 1` values.
pub(super) fn band_limited(values: &[f64], factor: usize) -> Vec<f64> {
    let weights: Vec<Vec<f64>> = (0..factor).map(|part| weights(part, factor)).collect();
    let count = values.len();
    let mut fine = Vec::with_capacity((count - 1) * factor + 1);
    for sample in 0..count {
        let parts = if sample + 1 < count { factor } else { 1 };
        fine.push(values[sample]);
        for weights in weights.iter().take(parts).skip(1) {
            let first = sample as i64 - REACH + 1;
            let terms = weights.iter().zip(first..).map(|(weight, at)| weight * seen(values, at));
            fine.push(terms.sum());
        }
    }
    fine
}

/// A sample, also before the first one and after the last one.
fn seen(values: &[f64], at: i64) -> f64 {
    let last = values.len() as i64 - 1;
    let inside = |at: i64| values[at.clamp(0, last) as usize];
    if at < 0 {
        2.0 * inside(0) - inside(-at)
    } else if at > last {
        2.0 * inside(last) - inside(2 * last - at)
    } else {
        inside(at)
    }
}

/// Weights of the samples `1 - REACH ..= REACH` for the instant `part / factor` after sample 0.
fn weights(part: usize, factor: usize) -> Vec<f64> {
    let shift = part as f64 / factor as f64;
    let weight = |at: i64| {
        let t = at as f64 - shift;
        let share = t / REACH as f64;
        let window = bessel_i0(SHAPE * libm::sqrt((1.0 - share * share).max(0.0)));
        let phase = std::f64::consts::PI * t;
        let sinc = if t == 0.0 { 1.0 } else { libm::sin(phase) / phase };
        sinc * window
    };
    let raw: Vec<f64> = (1 - REACH..=REACH).map(weight).collect();
    // A constant stays what it is.
    let sum: f64 = raw.iter().sum();
    raw.iter().map(|weight| weight / sum).collect()
}

/// The modified Bessel function of order zero, by its series.
fn bessel_i0(x: f64) -> f64 {
    let quarter = 0.25 * x * x;
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..80 {
        term *= quarter / (f64::from(k) * f64::from(k));
        sum += term;
        if term < 1e-17 * sum {
            break;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_tone_of_the_period_is_exact_between_its_samples() {
        for count in [64, 63] {
            let tone = |t: f64| libm::sin(TAU * 27.0 * t / f64::from(count) + 0.3) + 0.5;
            let coarse: Vec<f64> = (0..count).map(|n| tone(f64::from(n))).collect();
            for factor in [1, 10] {
                let fine = periodic(&coarse, factor);
                assert_eq!(fine.len(), coarse.len() * factor);
                for (n, value) in fine.iter().enumerate() {
                    let exact = tone(n as f64 / factor as f64);
                    assert!((value - exact).abs() < 1e-12, "{count} {factor} {n}");
                }
            }
        }
    }

    #[test]
    fn a_tone_that_is_not_periodic_is_exact_away_from_the_ends() {
        // 0.8 of half the rate.
        let tone = |t: f64| libm::sin(TAU * 0.4 * t + 0.3);
        let coarse: Vec<f64> = (0..200).map(|n| tone(f64::from(n))).collect();
        let fine = band_limited(&coarse, 7);
        assert_eq!(fine.len(), 199 * 7 + 1);
        for (n, value) in fine.iter().enumerate().skip(30 * 7).take(140 * 7) {
            assert!((value - tone(n as f64 / 7.0)).abs() < 3e-6, "{n}: {value}");
        }
        let constant = band_limited(&[2.0; 80], 3);
        assert!(constant.iter().all(|value| (value - 2.0).abs() < 1e-14), "a constant stays");
    }
}
