//! The noise floor of a record: what no model can explain.
//!
//! | source | file | result |
//! | --- | --- | --- |
//! | successive cycles | [`cycles`] | the floor, whatever the colour of the noise |
//! | white noise of the samples | [`white`] | a lower bound: drift is not in it |
//! | rest | [`rest`] | a lower bound: noise that grows with force or speed is not in it |
//!
//! The sources are tried in this order. Where none applies the noise is unknown. No estimate from
//! neighbouring samples distinguishes filtered noise from signal, so none is offered: on records
//! that were low-passed at a tenth of the sampling rate every such estimate is 3 to 600 % of the
//! truth.

pub mod cycles;
pub mod rest;
pub mod white;

use crate::measurement::Measurement;
use signal::statistics::smallest_change;

/// The noise of a record and where it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Root mean square, N.
    pub rms_n: f64,
    /// How it was found.
    pub source: NoiseSource,
}

/// How noise was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoiseSource {
    /// From cycle to cycle.
    Cycles,
    /// From samples that pass a test for white noise.
    White,
    /// From the force while the damper rests.
    Rest,
}

impl NoiseSource {
    /// As it is written in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cycles => "successive cycles",
            Self::White => "white noise of the samples, a lower bound",
            Self::Rest => "noise at rest, a lower bound",
        }
    }

    /// True where slower noise, or noise that grows with the force, may come on top.
    pub const fn is_lower_bound(self) -> bool {
        !matches!(self, Self::Cycles)
    }
}

/// The noise of one test, never below the rounding of the force's last digit; none where it is
/// unknown.
pub fn noise(test: &Measurement) -> Option<Noise> {
    let of = |source: NoiseSource, rms_n: Option<f64>| Some(Noise { rms_n: rms_n?, source });
    let found = of(NoiseSource::Cycles, cycles::rms_n(test))
        .or_else(|| of(NoiseSource::White, white::rms(&test.force_n)))
        .or_else(|| of(NoiseSource::Rest, rest::rms_n(test, &test.force_n)))?;
    Some(Noise { rms_n: found.rms_n.max(rounding_n(&test.force_n)), ..found })
}

/// rms of the rounding of a signal to its last digit; zero where it has none.
pub fn rounding_n(values: &[f64]) -> f64 {
    let digit = smallest_change(values, 0.0);
    if digit < f64::MAX { digit / 12.0_f64.sqrt() } else { 0.0 }
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
                let found = noise(&record(seed, rho, rms_n, true)).unwrap();
                assert_eq!(found.source, NoiseSource::Cycles);
                let ratio = found.rms_n / rms_n;
                assert!((ratio - 1.0).abs() < bound, "seed {seed} rho {rho} {rms_n} N: {ratio}");
            }
        }
    }

    #[test]
    fn without_cycles_white_noise_is_found_and_coloured_noise_is_unknown() {
        for (seed, rms_n) in [(4, 50.0), (5, 200.0), (6, 400.0)] {
            let found = noise(&record(seed, 0.0, rms_n, false)).unwrap();
            assert!(found.source == NoiseSource::White && found.source.is_lower_bound());
            let ratio = found.rms_n / rms_n;
            assert!((ratio - 1.0).abs() < 0.05, "seed {seed} {rms_n} N: {ratio}");
            for rho in [0.6, 0.9] {
                assert_eq!(noise(&record(seed, rho, rms_n, false)), None, "rho {rho}");
            }
        }
    }

    #[test]
    fn at_rest_noise_of_any_colour_is_a_lower_bound() {
        // Two seconds at rest, then a motion without cycles.
        let coloured_n = coloured(9, 0.7, 8000);
        let x = |n: usize| {
            let t = (n as f64 - 2000.0).max(0.0) * 1e-3;
            2e-3 * (libm::sin(TAU * 1.1 * t) + libm::sin(TAU * 2.9 * t))
        };
        let force_n = (0..8000).map(|n| 2e6 * x(n) + 30.0 * coloured_n[n]).collect();
        let series = Series::sampled("r", 1e3, (0..8000).map(x).collect(), force_n);
        let found = noise(&Measurement::from_series(series).unwrap()).unwrap();
        assert_eq!(found.source, NoiseSource::Rest);
        assert!((found.rms_n / 30.0 - 1.0).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn a_force_that_relaxes_after_the_motion_was_noise_at_rest() {
        let noise_n = coloured(3, 0.0, 9000);
        // Three bursts of motion of 0.5 s, each followed by 2.5 s of rest.
        let t = |n: usize| (n % 3000) as f64 * 1e-3;
        let moves = |n: usize| t(n) < 0.5;
        let x = |n: usize| {
            if moves(n) { 2e-3 * libm::sin(TAU * (2.0 + 4.0 * t(n)) * t(n)) } else { 0.0 }
        };
        let force = |n: usize| {
            let answer =
                if moves(n) { 2e6 * x(n) } else { 1500.0 * libm::exp(-(t(n) - 0.5) / 0.2) };
            answer + 30.0 * noise_n[n]
        };
        let series =
            Series::sampled("r", 1e3, (0..9000).map(x).collect(), (0..9000).map(force).collect());
        let test = Measurement::from_series(series).unwrap();
        let found_n = rest::rms_n(&test, &test.force_n).unwrap();
        assert!((found_n / 30.0 - 1.0).abs() < 0.1, "{found_n}");
    }

    #[test]
    fn without_noise_the_floor_is_far_below_the_force() {
        let found = noise(&record(7, 0.0, 0.0, true)).unwrap();
        // The rest: 0.5 um of displacement noise, and corners between samples.
        assert!(found.rms_n < 15.0, "{}", found.rms_n);
    }

    #[test]
    fn a_record_that_repeats_exactly_keeps_the_rounding_of_its_last_digit() {
        let angle = |n: u32| TAU * 2.0 * f64::from(n) * 1e-3;
        let x = (0..4000).map(|n| 5e-3 * libm::sin(angle(n))).collect();
        let f = (0..4000).map(|n| 0.5 * libm::round(200.0 * libm::sin(angle(n) + 0.8))).collect();
        let test = Measurement::from_series(Series::sampled("r", 1e3, x, f)).unwrap();
        let found = noise(&test).unwrap();
        assert!((found.rms_n - 0.5 / 12.0_f64.sqrt()).abs() < 0.02, "{found:?}");
    }
}
