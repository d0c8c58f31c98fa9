//! The interpolant of a sampled motion: displacement, velocity and acceleration from samples alone.
//!
//! - **Displacement** is the samples, without their noise where there is any
//!   ([`smoothing`](crate::smoothing)): a triangle keeps its corners.
//! - **Velocity** and **acceleration** are those of a local quartic, by weighted least squares over
//!   the samples within 10 ms to either side (at least two), weights `(1 - u^2)^2` that fade to
//!   zero just outside. The fading keeps noise from jumping from sample to sample: the mean
//!   acceleration that a model makes of two velocities is then as quiet as the velocity. At the
//!   ends, where the window is one-sided, a cubic takes its place.
//! - **Between samples** the motion is the cubic through displacement and velocity of both ends
//!   (Hermite), [`between`].
//!
//! A velocity column of a record is compared, never used: it is often a raw difference, or filtered
//! in an unstated way.
//!
//! | rate | -1 dB | -3 dB | error at 12 Hz | 1 um of white noise gives | in acceleration |
//! | --- | --- | --- | --- | --- | --- |
//! | 100 Hz | 23 Hz | 31 Hz | 1.0 % | 0.10 mm/s | 0.03 m/s2 |
//! | 200 Hz | 46 Hz | 62 Hz | 0.07 % | 0.19 mm/s | 0.13 m/s2 |
//! | 1 kHz | 52 Hz | 71 Hz | 0.04 % | 0.11 mm/s | 0.06 m/s2 |
//! | 5 kHz | 56 Hz | 76 Hz | 0.03 % | 0.05 mm/s | 0.03 m/s2 |
//!
//! ([`bandwidth_hz`], [`noise_gain_per_s`]; a mass of 20 kg makes 1.2 N of it at 1 kHz.) At the
//! corner of a triangle the velocity turns within five samples at 1 kHz and overshoots by 10 %.
//! Limit: what is faster than the bandwidth, such as an impact, is in the displacement and the
//! force but not in the velocity.

use nalgebra::{DMatrix, DVector};

/// Half-width of the window (s).
pub const HALF_WIDTH_S: f64 = 10e-3;

/// Fewest samples to either side.
pub const HALF_WIDTH_LEAST: usize = 2;

/// Velocity and acceleration of every sample of a displacement (m/s, m/s2); as long as the input.
///
/// The least length is five samples; shorter ones give zeros.
///
/// ```
/// use measurement::interpolant::derivatives;
/// // 3.46 mm at 3.5 Hz and 1 kHz: 76.1 mm/s and 1.67 m/s2 at most, to one part in ten thousand.
/// let w = std::f64::consts::TAU * 3.5;
/// let x: Vec<f64> = (0..1000).map(|n| 3.46e-3 * libm::sin(w * f64::from(n) * 1e-3)).collect();
/// let (v, a) = derivatives(&x, 1e-3);
/// for n in 10..990 {
///     let t = n as f64 * 1e-3;
///     assert!((v[n] / (3.46e-3 * w) - libm::cos(w * t)).abs() < 1e-4);
///     assert!((a[n] / (3.46e-3 * w * w) + libm::sin(w * t)).abs() < 1e-4);
/// }
/// ```
pub fn derivatives(displacement_m: &[f64], step_s: f64) -> (Vec<f64>, Vec<f64>) {
    let count = displacement_m.len();
    let half = half_width(1.0 / step_s).min(count.saturating_sub(1) / 2);
    if half < HALF_WIDTH_LEAST {
        return (vec![0.0; count], vec![0.0; count]);
    }
    let width = 2 * half + 1;
    let inside = Weights::at(half, width, half);
    let (mut velocity, mut acceleration) = (vec![0.0; count], vec![0.0; count]);
    for (at, (v, a)) in velocity.iter_mut().zip(&mut acceleration).enumerate() {
        let first = at.saturating_sub(half).min(count - width);
        let place = at - first;
        let edge;
        let weights = if place == half {
            &inside
        } else {
            edge = Weights::at(place, width, half);
            &edge
        };
        let window = displacement_m.get(first..first + width).unwrap_or_default();
        // Differences to the sample itself: a large mean would cost digits.
        let own = displacement_m.get(at).copied().unwrap_or(0.0);
        let dot = |weights: &[f64]| -> f64 {
            weights.iter().zip(window).map(|(weight, x)| weight * (x - own)).sum()
        };
        *v = dot(&weights.velocity) / step_s;
        *a = dot(&weights.acceleration) / (step_s * step_s);
    }
    (velocity, acceleration)
}

/// Samples to either side of the window at this rate.
pub fn half_width(rate_hz: f64) -> usize {
    (libm::floor(HALF_WIDTH_S * rate_hz + 1e-6) as usize).max(HALF_WIDTH_LEAST)
}

/// Frequency up to which the velocity loses less than `loss_db` of a sine (Hz).
///
/// ```
/// use measurement::interpolant::bandwidth_hz;
/// assert!((bandwidth_hz(1000.0, 1.0) - 52.0).abs() < 0.5);
/// assert!((bandwidth_hz(100.0, 3.0) - 31.0).abs() < 0.5);
/// ```
pub fn bandwidth_hz(rate_hz: f64, loss_db: f64) -> f64 {
    let least = libm::pow(10.0, -loss_db / 20.0);
    let (mut passed, mut lost) = (0.0, 0.5 * rate_hz);
    for _ in 0..40 {
        let middle = 0.5 * (passed + lost);
        if velocity_gain(rate_hz, middle) >= least { passed = middle } else { lost = middle }
    }
    passed
}

/// Share of a sine's velocity that the interpolant gives.
pub fn velocity_gain(rate_hz: f64, frequency_hz: f64) -> f64 {
    let half = half_width(rate_hz);
    let angle = std::f64::consts::TAU * frequency_hz / rate_hz;
    if angle <= 0.0 {
        return 1.0;
    }
    let weights = Weights::at(half, 2 * half + 1, half);
    let place = |index: usize| index as f64 - half as f64;
    let sum: f64 = weights
        .velocity
        .iter()
        .enumerate()
        .map(|(index, weight)| weight * libm::sin(angle * place(index)))
        .sum();
    sum / angle
}

/// Root mean square velocity for white displacement noise of one metre (1/s).
pub fn noise_gain_per_s(rate_hz: f64) -> f64 {
    let half = half_width(rate_hz);
    let weights = Weights::at(half, 2 * half + 1, half);
    weights.velocity.iter().map(|weight| weight * weight).sum::<f64>().sqrt() * rate_hz
}

/// Displacement and velocity at a fraction (0 to 1) of the way between two samples: the cubic
/// through displacement (m) and velocity (m/s) of both, `step_s` apart.
///
/// ```
/// use measurement::interpolant::between;
/// // x = t^3 from 0 to 1: a half is at 1/8, as fast as 3/4.
/// assert_eq!(between((0.0, 0.0), (1.0, 3.0), 1.0, 0.5), (0.125, 0.75));
/// ```
#[inline]
pub fn between(from: (f64, f64), to: (f64, f64), step_s: f64, fraction: f64) -> (f64, f64) {
    let ((x0, v0), (x1, v1)) = (from, to);
    let mean = (x1 - x0) / step_s;
    let bend = 3.0 * mean - 2.0 * v0 - v1;
    let twist = v0 + v1 - 2.0 * mean;
    let s = fraction;
    let x = x0 + step_s * s * (v0 + s * (bend + s * twist));
    (x, v0 + s * (2.0 * bend + 3.0 * twist * s))
}

/// Weights of the samples of a window for the derivatives at one place of it, for a step of one.
struct Weights {
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
}

impl Weights {
    fn at(place: usize, width: usize, half: usize) -> Self {
        // One-sided windows lose a degree: their noise would be ten times as large.
        let terms = if place == half { 5 } else { 4 };
        let reach = (place.max(width - 1 - place) + 1) as f64;
        let u = |index: usize| (index as f64 - place as f64) / reach;
        let weight = |index: usize| {
            let fade = 1.0 - u(index) * u(index);
            fade * fade
        };
        let power = |index: usize, term: usize| (0..term).fold(1.0, |p, _| p * u(index));
        let design = DMatrix::from_fn(width, terms, power);
        let weighted = DMatrix::from_fn(width, terms, |i, j| weight(i) * power(i, j));
        let normal = design.transpose() * &weighted;
        let solve = |order: usize, scale: f64| -> Vec<f64> {
            let mut unit = DVector::zeros(terms);
            if let Some(entry) = unit.get_mut(order) {
                *entry = scale;
            }
            match normal.clone().lu().solve(&unit) {
                Some(taylor) => (&weighted * taylor).iter().copied().collect(),
                None => vec![0.0; width],
            }
        };
        Self { velocity: solve(1, 1.0 / reach), acceleration: solve(2, 2.0 / (reach * reach)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};
    use signal::statistics::rms;
    use std::f64::consts::TAU;

    const RATES_HZ: [f64; 5] = [100.0, 200.0, 250.0, 1000.0, 5000.0];

    #[test]
    fn sines_from_1_to_12_hz_keep_velocity_and_acceleration() {
        for rate in RATES_HZ {
            for (hz, bound) in [(1.0, 1e-4), (3.5, 2e-3), (12.0, 1.1e-2)] {
                let w = TAU * hz;
                let count = (2.0 * rate) as usize;
                let t = |n: usize| n as f64 / rate;
                let x: Vec<f64> = (0..count).map(|n| libm::sin(w * t(n) + 0.3)).collect();
                let (v, a) = derivatives(&x, 1.0 / rate);
                let half = half_width(rate);
                for n in half..count - half {
                    let (sine, cosine) = (libm::sin(w * t(n) + 0.3), libm::cos(w * t(n) + 0.3));
                    assert!((v[n] / w - cosine).abs() < bound, "{rate} {hz} v {n}");
                    assert!((a[n] / (w * w) + sine).abs() < bound, "{rate} {hz} a {n}");
                }
                // One-sided ends: a cubic over 20 ms.
                assert!((v[0] / w - libm::cos(0.3)).abs() < 0.3, "{rate} {hz} end {}", v[0] / w);
                // The stated gain is the one found.
                let peak = v[half..count - half].iter().fold(0.0_f64, |m, v| m.max(v.abs())) / w;
                assert!((peak - velocity_gain(rate, hz)).abs() < 3e-3, "{rate} {hz} {peak}");
            }
        }
    }

    #[test]
    fn quartics_are_exact_and_a_line_has_no_acceleration() {
        let x = |n: f64| 1.0 + n * (0.5 + n * (0.1 + n * (-0.02 + n * 0.003)));
        let samples: Vec<f64> = (0..60).map(|n| x(f64::from(n) * 0.01)).collect();
        let (v, a) = derivatives(&samples, 0.01);
        for n in 2..58 {
            let t = n as f64 * 0.01;
            let first = 0.5 + t * (0.2 + t * (-0.06 + t * 0.012));
            let second = 0.2 + t * (-0.12 + t * 0.036);
            assert!((v[n] - first).abs() < 1e-12 && (a[n] - second).abs() < 1e-9, "{n}");
        }
        let line: Vec<f64> = (0..60).map(|n| 0.3 + 0.01 * f64::from(n)).collect();
        let (v, a) = derivatives(&line, 1e-3);
        assert!(v.iter().all(|v| (v - 10.0).abs() < 1e-9));
        assert!(a.iter().all(|a| a.abs() < 1e-6), "{a:?}");
    }

    #[test]
    fn noise_of_a_micrometre_gives_what_the_table_says() {
        // 1 um of white noise, seed 5; the table at the head of this module.
        let mut generator = ChaCha8Rng::seed_from_u64(5);
        let mut normal = || {
            let sum: f64 = (0..12).map(|_| f64::from(generator.next_u32()) / 4_294_967_296.0).sum();
            sum - 6.0
        };
        let noise: Vec<f64> = (0..20_000).map(|_| 1e-6 * normal()).collect();
        let table = [
            (100.0, 0.095, 0.031),
            (200.0, 0.19, 0.126),
            (1000.0, 0.11, 0.06),
            (5000.0, 0.054, 0.031),
        ];
        for (rate, mm_per_s, m_per_s2) in table {
            let (v, a) = derivatives(&noise, 1.0 / rate);
            let (v, a) = (rms(&v[100..19_900]) * 1e3, rms(&a[100..19_900]));
            assert!((v / mm_per_s - 1.0).abs() < 0.08, "{rate} Hz: {v} mm/s");
            assert!((a / m_per_s2 - 1.0).abs() < 0.08, "{rate} Hz: {a} m/s2");
            assert!((noise_gain_per_s(rate) * 1e-3 / v - 1.0).abs() < 0.05);
            // A mass in a model sees the mean acceleration between two samples.
            let change: Vec<f64> = derivatives(&noise, 1.0 / rate).0;
            let mean: Vec<f64> = change.windows(2).map(|v| (v[1] - v[0]) * rate).collect();
            let mean = rms(&mean[100..19_800]);
            assert!(mean < 0.2, "{rate} Hz: {mean} m/s2");
        }
        // Rounding to whole micrometres at 1 kHz and 3.5 Hz: below a third of that.
        let w = TAU * 3.5;
        let exact = |n: usize| 3.46e-3 * libm::sin(w * n as f64 * 1e-3);
        let rounded: Vec<f64> = (0..5000).map(|n| libm::round(exact(n) * 1e6) * 1e-6).collect();
        let (v, _) = derivatives(&rounded, 1e-3);
        let error: Vec<f64> =
            (10..4990).map(|n| v[n] - 3.46e-3 * w * libm::cos(w * n as f64 * 1e-3)).collect();
        assert!(rms(&error) < 0.05e-3, "{}", rms(&error));
    }

    #[test]
    fn a_triangle_turns_within_a_few_samples() {
        for (rate, samples) in [(100.0, 2), (1000.0, 5), (5000.0, 25)] {
            let quarter = (0.25 * rate) as usize;
            let x: Vec<f64> = (0..4 * quarter)
                .map(|n| 2.0 * quarter as f64 - (n as f64 - 2.0 * quarter as f64).abs())
                .map(|x| x / rate)
                .collect();
            let (v, _) = derivatives(&x, 1.0 / rate);
            let turning = v[quarter..3 * quarter].iter().filter(|v| v.abs() < 0.8).count();
            assert!(turning <= samples, "{rate} Hz: {turning} samples");
            let most = v.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
            assert!(most < 1.17, "{rate} Hz: overshoot {most}");
        }
    }

    #[test]
    fn bandwidths_are_those_of_the_table() {
        for (rate, one_db, three_db) in
            [(100.0, 23.0, 31.0), (200.0, 46.0, 62.0), (1000.0, 52.0, 71.0), (5000.0, 56.0, 76.0)]
        {
            let found = (bandwidth_hz(rate, 1.0), bandwidth_hz(rate, 3.0));
            assert!((found.0 - one_db).abs() < 1.0, "{rate} Hz: {found:?}");
            assert!((found.1 - three_db).abs() < 1.0, "{rate} Hz: {found:?}");
        }
    }

    #[test]
    fn the_cubic_between_samples_meets_both_ends() {
        let (from, to) = ((1e-3, 0.02), (1.1e-3, -0.05));
        assert_eq!(between(from, to, 4e-3, 0.0), from);
        let end = between(from, to, 4e-3, 1.0);
        assert!((end.0 - to.0).abs() < 1e-15 && (end.1 - to.1).abs() < 1e-15);
        // The velocity is the derivative of the displacement.
        for s in [0.1, 0.5, 0.8] {
            let (before, after) =
                (between(from, to, 4e-3, s - 1e-5), between(from, to, 4e-3, s + 1e-5));
            let slope = (after.0 - before.0) / (2e-5 * 4e-3);
            assert!((slope - between(from, to, 4e-3, s).1).abs() < 1e-7);
        }
    }
}
