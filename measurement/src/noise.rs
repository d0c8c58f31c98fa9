//! The noise floor of a record: what no model can explain.
//!
//! **Repeat**, for a test with cycles. Two cycles that follow each other hold the same motion, so
//! their forces at equal phase differ by noise alone. With whole shifts of `L` samples and the rest
//! `tau` of the shift taken from the displacement,
//! ```text
//! d_n = F_(n+L) - F_n - tau F'_n        sigma^2 = rss(d) / (2 (N - p))
//! ```
//! The 2 is the scatter of the cycle that serves as reference. The sum is that of the residual
//! after `p = 4` regressors common to all pairs: one, the force, and the differences of
//! displacement and velocity. They absorb what is no noise: drift of the offset, fading by warmth,
//! an actuator that does not repeat itself. Noise of any colour counts as long as it decorrelates
//! within a cycle. Limits: what repeats with the motion (ripple in phase with it) is no noise here.
//!
//! **Innovation**, for a test without cycles. Third differences of the force suppress a smooth
//! signal. Their variance and first covariance over the quiet blocks of the record (64 samples
//! each, up to 2.5 times the median variance; corners of the force make the others loud) give size
//! and colour of a first-order autoregression, `gamma_k = sigma^2 rho^k` with `rho` up to 0.9:
//! white noise is met within 3 %, that of 0.9 within 30 %. Limits: slower noise cannot be
//! distinguished from signal, a force that was smoothed has no noise any more, and below about 500
//! Hz the signal itself is in the differences.

use crate::measurement::Measurement;
use nalgebra::{Matrix4, Vector4};
use signal::statistics::{percentile, smallest_change};

/// A noise floor and where it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseFloor {
    /// Root mean square, N.
    pub rms_n: f64,
    /// How it was found.
    pub method: NoiseMethod,
}

/// How a noise floor was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoiseMethod {
    /// From cycle to cycle.
    Repeat,
    /// From third differences, with the colour of a first-order autoregression.
    Innovation,
    /// Some tests by one, some by the other.
    Mixed,
}

impl NoiseMethod {
    /// As it is written in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Repeat => "cycle_to_cycle_repeat",
            Self::Innovation => "third_difference_innovation",
            Self::Mixed => "cycle_to_cycle_repeat_and_third_difference_innovation",
        }
    }
}

/// The noise floor of one test, never below the rounding of the force's last digit.
pub fn floor(test: &Measurement) -> NoiseFloor {
    let digit_n = smallest_change(&test.force_n, 0.0);
    let rounding_n = if digit_n < f64::MAX { digit_n / 12.0_f64.sqrt() } else { 0.0 };
    let (rms_n, method) = match repeat_n(test) {
        Some(rms_n) => (rms_n, NoiseMethod::Repeat),
        None => (innovation_n(&test.force_n), NoiseMethod::Innovation),
    };
    NoiseFloor { rms_n: rms_n.max(rounding_n), method }
}

/// The noise floor of several tests: root of the mean square over the samples that errors count.
pub fn pooled(tests: &[Measurement]) -> Option<NoiseFloor> {
    let (mut square, mut samples, mut methods) = (0.0, 0.0, Vec::new());
    for test in tests {
        let NoiseFloor { rms_n, method } = floor(test);
        let count = test.force_n.len().saturating_sub(test.run_in) as f64;
        square += count * rms_n * rms_n;
        samples += count;
        methods.push(method);
    }
    let first = methods.first().copied()?;
    let method = if methods.iter().all(|m| *m == first) { first } else { NoiseMethod::Mixed };
    (samples > 0.0).then(|| NoiseFloor { rms_n: (square / samples).sqrt(), method })
}

/// From cycle to cycle; `None` with fewer than two whole cycles behind the run-in.
fn repeat_n(test: &Measurement) -> Option<f64> {
    let marks: Vec<usize> =
        test.cycles.iter().copied().filter(|mark| *mark >= test.run_in).collect();
    let (x, v, f) = (&test.displacement_m, &test.velocity_m_per_s, &test.force_n);
    let (mut rows, mut differences) = (Vec::new(), Vec::new());
    for pair in marks.windows(3) {
        let (start, shift) = (pair[0], pair[1] - pair[0]);
        let end = pair[1].min(x.len().saturating_sub(shift + 1));
        let here = |n: usize| Some((*x.get(n)?, *v.get(n)?, *f.get(n)?));
        // The part of the shift that is no whole sample, from the slope of the displacement.
        let (mut top, mut bottom) = (0.0, 0.0);
        for n in start..end {
            let ((x0, v0, _), (x1, v1, _)) = (here(n)?, here(n + shift)?);
            let mean = 0.5 * (v0 + v1);
            top += mean * (x1 - x0);
            bottom += mean * mean;
        }
        let late_s = if bottom > 0.0 { top / bottom } else { 0.0 };
        for n in start.max(1)..end {
            let ((x0, v0, f0), (x1, v1, f1)) = (here(n)?, here(n + shift)?);
            let slope = |at: usize| Some((f.get(at + 1)? - f.get(at - 1)?) / (2.0 * test.step_s));
            let slope = 0.5 * (slope(n)? + slope(n + shift)?);
            let turn = 0.5 * (test.acceleration(n) + test.acceleration(n + shift));
            rows.push([
                1.0,
                0.5 * (f0 + f1),
                x1 - x0 - late_s * 0.5 * (v0 + v1),
                v1 - v0 - late_s * turn,
            ]);
            differences.push(f1 - f0 - late_s * slope);
        }
    }
    if differences.len() < 30 {
        return None;
    }
    let rss = residual_sum(&rows, &differences);
    Some((rss / (2.0 * (differences.len() - 4) as f64)).sqrt())
}

/// Sum of squares of the residual of four regressors; empty ones explain nothing.
fn residual_sum(rows: &[[f64; 4]], values: &[f64]) -> f64 {
    let mut size = [0.0_f64; 4];
    for row in rows {
        for (size, entry) in size.iter_mut().zip(row) {
            *size += entry * entry;
        }
    }
    let scaled = |row: &[f64; 4]| {
        Vector4::from_fn(|i, _| if size[i] > 0.0 { row[i] / size[i].sqrt() } else { 0.0 })
    };
    // A trace on the diagonal keeps empty regressors from being divided by.
    let mut normal = Matrix4::identity() * 1e-12;
    let mut right = Vector4::zeros();
    for (row, value) in rows.iter().zip(values) {
        let row = scaled(row);
        normal += row * row.transpose();
        right += row * *value;
    }
    let weights = normal.lu().solve(&right).unwrap_or_else(Vector4::zeros);
    let rest = |(row, value): (&[f64; 4], &f64)| value - weights.dot(&scaled(row));
    rows.iter().zip(values).map(rest).map(|rest| rest * rest).sum()
}

/// From third differences.
fn innovation_n(force_n: &[f64]) -> f64 {
    let third: Vec<f64> =
        force_n.windows(4).map(|f| f[3] - 3.0 * f[2] + 3.0 * f[1] - f[0]).collect();
    let block = |values: &[f64], lag: usize| -> f64 {
        let pairs = values.iter().zip(values.iter().skip(lag));
        pairs.map(|(a, b)| a * b).sum::<f64>() / values.len().saturating_sub(lag).max(1) as f64
    };
    let blocks: Vec<(f64, f64)> =
        third.chunks(64).filter(|b| b.len() > 31).map(|b| (block(b, 0), block(b, 1))).collect();
    let sizes: Vec<f64> = blocks.iter().map(|(zero, _)| *zero).collect();
    let Some(median) = percentile(&sizes, 0.5) else { return 0.0 };
    let quiet: Vec<&(f64, f64)> = blocks.iter().filter(|(zero, _)| *zero <= 2.5 * median).collect();
    let sum = |of: fn(&(f64, f64)) -> f64| quiet.iter().map(|block| of(block)).sum::<f64>();
    let (zero, one) = (sum(|b| b.0), sum(|b| b.1));
    if zero <= 0.0 {
        return 0.0;
    }
    let rho = colour(one / zero);
    (zero / quiet.len() as f64 / third_covariance(rho, 0)).sqrt()
}

/// Covariance of third differences at a lag for unit variance and `gamma_k = rho^k`.
fn third_covariance(rho: f64, lag: i32) -> f64 {
    // Coefficients of (1 - z)^3 (1 - 1/z)^3.
    let weights = [-1.0, 6.0, -15.0, 20.0, -15.0, 6.0, -1.0];
    let gamma = |k: i32| libm::pow(rho, f64::from(k.abs()));
    (-3..=3).zip(weights).map(|(k, weight)| weight * gamma(lag + k)).sum()
}

/// Slowest noise that can be distinguished from signal.
const COLOUR_MOST: f64 = 0.9;

/// The `rho` for which third differences have this first correlation.
fn colour(correlation: f64) -> f64 {
    let (mut low, mut high) = (0.0, COLOUR_MOST);
    for _ in 0..50 {
        let rho = 0.5 * (low + high);
        let given = third_covariance(rho, 1) / third_covariance(rho, 0);
        if given < correlation { low = rho } else { high = rho }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Series;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};
    use std::f64::consts::TAU;

    /// A first-order autoregression of unit variance.
    fn coloured(seed: u64, rho: f64, count: usize) -> Vec<f64> {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || {
            let sum: f64 = (0..12).map(|_| f64::from(generator.next_u32()) / 4_294_967_296.0).sum();
            sum - 6.0
        };
        let mut value = normal();
        let step = (1.0 - rho * rho).sqrt();
        (0..count)
            .map(|_| {
                value = rho * value + step * normal();
                value
            })
            .collect()
    }

    /// A damper with relief and stiffness at +-3.46 mm, 3.5 Hz (periods of 285.7 samples): 15 kN,
    /// with noise, warming by 2 % per second, and 0.5 um of noise in the displacement.
    fn record(seed: u64, rho: f64, rms_n: f64, periodic: bool) -> Measurement {
        let (noise, shake) = (coloured(seed, rho, 10_000), coloured(seed + 1000, 0.0, 10_000));
        let x = |t: f64| {
            if periodic {
                3.46e-3 * libm::sin(TAU * 3.5 * t)
            } else {
                2e-3 * (libm::sin(TAU * 1.1 * t)
                    + libm::sin(TAU * 2.9 * t + 1.0)
                    + 0.8 * libm::sin(TAU * 4.7 * t))
            }
        };
        let (mut displacement, mut force, mut answer) = (Vec::new(), Vec::new(), 0.0);
        let mut before = x(-1e-3);
        for n in 0..10_000 {
            let t = n as f64 * 1e-3;
            answer += 12.5e6 * (x(t) - before);
            before = x(t);
            if f64::abs(answer) > 15e3 {
                answer -= 0.1 * (answer - libm::copysign(15e3, answer));
            }
            displacement.push(x(t) + 0.5e-6 * shake[n]);
            force.push((1.0 - 0.02 * t) * answer + rms_n * noise[n]);
        }
        Measurement::from_series(Series::sampled("r", 1e3, displacement, force)).unwrap()
    }

    #[test]
    fn known_noise_is_found_from_cycle_to_cycle_whatever_its_colour() {
        for (rho, bound) in [(0.0, 0.05), (0.9, 0.1)] {
            for (seed, rms_n) in [(1, 20.0), (2, 100.0), (3, 400.0)] {
                let test = record(seed, rho, rms_n, true);
                let found = floor(&test);
                assert_eq!(found.method, NoiseMethod::Repeat);
                let ratio = found.rms_n / rms_n;
                assert!((ratio - 1.0).abs() < bound, "seed {seed} rho {rho} {rms_n} N: {ratio}");
            }
        }
    }

    #[test]
    fn known_noise_is_found_without_cycles_with_its_colour() {
        for (rho, bound) in [(0.0, 0.03), (0.9, 0.3)] {
            for (seed, rms_n) in [(4, 50.0), (5, 200.0), (6, 400.0)] {
                let test = record(seed, rho, rms_n, false);
                let found = floor(&test);
                assert_eq!(found.method, NoiseMethod::Innovation);
                let ratio = found.rms_n / rms_n;
                assert!((ratio - 1.0).abs() < bound, "seed {seed} rho {rho} {rms_n} N: {ratio}");
            }
        }
    }

    #[test]
    fn without_noise_the_floor_is_far_below_the_force() {
        let found = floor(&record(7, 0.0, 0.0, true));
        // The rest: 0.5 um of displacement noise, and corners between samples.
        assert!(found.rms_n < 15.0, "{}", found.rms_n);
        let found = floor(&record(8, 0.0, 0.0, false));
        assert!(found.rms_n < 10.0, "{}", found.rms_n);
    }

    #[test]
    fn a_record_that_repeats_exactly_keeps_the_rounding_of_its_last_digit() {
        let angle = |n: u32| TAU * 2.0 * f64::from(n) * 1e-3;
        let x = (0..4000).map(|n| 5e-3 * libm::sin(angle(n))).collect();
        let f = (0..4000).map(|n| 0.5 * libm::round(200.0 * libm::sin(angle(n) + 0.8))).collect();
        let test = Measurement::from_series(Series::sampled("r", 1e3, x, f)).unwrap();
        assert!((floor(&test).rms_n - 0.5 / 12.0_f64.sqrt()).abs() < 0.02, "{:?}", floor(&test));
    }

    #[test]
    fn several_tests_are_pooled_by_their_squares() {
        let tests = [record(1, 0.0, 30.0, true), record(2, 0.0, 90.0, true)];
        let pooled = pooled(&tests).unwrap();
        let expected = (0.5f64 * (30.0 * 30.0 + 90.0 * 90.0)).sqrt();
        assert!((pooled.rms_n / expected - 1.0).abs() < 0.05, "{}", pooled.rms_n);
        let mixed = [record(1, 0.0, 30.0, true), record(2, 0.0, 90.0, false)];
        assert_eq!(super::pooled(&mixed).unwrap().method, NoiseMethod::Mixed);
        assert_eq!(super::pooled(&[]), None);
    }
}
