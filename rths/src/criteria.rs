//! The criteria of the benchmark.
//!
//! With the measured displacement `x` of the first floor, the simulated floors `n` and those of the
//! whole frame `r`:
//!
//! | criterion | is |
//! |---|---|
//! | J1 | lag of the highest correlation of `x` with `n1`, ms |
//! | J2, J3 | `x - n1` over `n1`: standard deviation, peak, % |
//! | J4, J5 | `x - r1` over `r1`: standard deviation, peak, % |
//! | J6, J7 | `n - r` over `r`: standard deviation at floors 2 and 3, % |
//! | J8, J9 | `n - r` over `r`: peak at floors 2 and 3, % |
//!
//! This is the order of the benchmark's program and of its published table; the text of the
//! publication names J5 to J7 in another one.

use crate::simulation::Trace;
use crate::structure::FLOORS;
use serde::Serialize;
use signal::statistics::mean;

/// Names with units, in the order of [`Criteria`].
pub const NAMES: [&str; 9] =
    ["J1, ms", "J2, %", "J3, %", "J4, %", "J5, %", "J6, %", "J7, %", "J8, %", "J9, %"];
/// Most lag that is searched, samples.
const LAG_MAX: usize = 199;

/// J1 to J9.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Criteria(pub [f64; 9]);

impl Criteria {
    /// The criteria of a run, compared with the whole frame.
    pub(crate) fn of(trace: &Trace, reference: &[[f64; FLOORS]], step_s: f64) -> Self {
        let floor = |floors: &[[f64; FLOORS]], n: usize| -> Vec<f64> {
            floors.iter().map(|floor| floor[n]).collect()
        };
        let measured = &trace.measured_m;
        let simulated = [0, 1, 2].map(|n| floor(&trace.simulated_m, n));
        let whole = [0, 1, 2].map(|n| floor(reference, n));
        let lag_ms = 1e3 * step_s * lag(measured, &simulated[0]) as f64;
        let spread =
            |of: &[f64], to: &[f64]| 100.0 * deviation(&difference(of, to)) / deviation(to);
        let worst = |of: &[f64], to: &[f64]| 100.0 * peak(&difference(of, to)) / peak(to);
        Self([
            lag_ms,
            spread(measured, &simulated[0]),
            worst(measured, &simulated[0]),
            spread(measured, &whole[0]),
            worst(measured, &whole[0]),
            spread(&simulated[1], &whole[1]),
            spread(&simulated[2], &whole[2]),
            worst(&simulated[1], &whole[1]),
            worst(&simulated[2], &whole[2]),
        ])
    }

    /// A criterion by its number from 1 to 9.
    ///
    /// ```
    /// let criteria = rths::Criteria([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
    /// assert_eq!(criteria.j(4), 4.0);
    /// ```
    ///
    /// # Panics
    /// Another number.
    pub fn j(&self, number: usize) -> f64 {
        self.0[number - 1]
    }

    /// Mean and standard deviation of each criterion over several runs.
    pub(crate) fn mean_and_deviation(all: &[Self]) -> [Self; 2] {
        let each = |statistic: fn(&[f64]) -> f64| {
            Self(std::array::from_fn(|n| {
                statistic(&all.iter().map(|criteria| criteria.0[n]).collect::<Vec<_>>())
            }))
        };
        [each(mean), each(deviation)]
    }
}

/// The standard deviation of a sample.
pub(crate) fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    (squares / (values.len() as f64 - 1.0)).sqrt()
}

/// The largest magnitude; not a number if one value is none.
fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |peak, value| if value.abs() <= peak { peak } else { value.abs() })
}

fn difference(of: &[f64], to: &[f64]) -> Vec<f64> {
    of.iter().zip(to).map(|(of, to)| of - to).collect()
}

/// The lag of the highest correlation, samples.
fn lag(measured: &[f64], wanted: &[f64]) -> usize {
    let (mut best, mut highest) = (0, f64::NEG_INFINITY);
    for lag in 0..=LAG_MAX.min(measured.len().saturating_sub(1)) {
        let correlation = product(&measured[lag..], &wanted[..wanted.len() - lag]);
        if correlation > highest {
            (best, highest) = (lag, correlation);
        }
    }
    best
}

/// A scalar product in four sums, which a processor forms side by side.
fn product(a: &[f64], b: &[f64]) -> f64 {
    let (a, a_rest) = a.as_chunks::<4>();
    let (b, b_rest) = b.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        for n in 0..4 {
            sums[n] += a[n] * b[n];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn criteria_of_a_delayed_and_scaled_motion_are_known() {
        let wave = |k: i32, amplitude: f64| amplitude * libm::sin(0.02 * f64::from(k));
        let samples = 0..6283;
        let trace = Trace {
            measured_m: samples.clone().map(|k| wave(k - 5, 1.0)).collect(),
            simulated_m: samples
                .clone()
                .map(|k| [wave(k, 1.0), wave(k, 1.1), wave(k, 0.7)])
                .collect(),
            is_saturated: false,
            has_run_away: false,
        };
        let reference: Vec<[f64; 3]> =
            samples.map(|k| [wave(k, 0.8), wave(k, 1.0), wave(k, 1.0)]).collect();
        let found = Criteria::of(&trace, &reference, 1e-3);
        // |exp(-0.1 i) - 1|, and over an amplitude of 0.8.
        let delayed = 200.0 * libm::sin(0.05);
        let (sin, cos) = libm::sincos(0.1);
        let scaled = 100.0 * libm::hypot(cos - 0.8, sin) / 0.8;
        let expected = [5.0, delayed, delayed, scaled, scaled, 10.0, 30.0, 10.0, 30.0];
        for (n, (found, expected)) in found.0.iter().zip(expected).enumerate() {
            assert!((found - expected).abs() < 0.03, "J{}: {found}, {expected}", n + 1);
        }
        let [mean, deviation] = Criteria::mean_and_deviation(&[found, found]);
        assert!((mean.j(4) - found.j(4)).abs() < 1e-12 && deviation.j(4) == 0.0);
    }

    #[test]
    fn a_motion_that_is_no_number_has_no_criterion() {
        assert!(peak(&[1.0, f64::NAN, 2.0]).is_nan() || peak(&[1.0, f64::NAN]).is_nan());
        assert!(deviation(&[1.0, f64::NAN]).is_nan());
    }
}
