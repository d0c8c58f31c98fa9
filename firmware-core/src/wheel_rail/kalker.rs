//! Kalker's creep coefficients C11, C22 and C23 of the linear theory.
//!
//! Table over the axis ratio of the contact ellipse for Poisson's ratio 0, 1/4 and 1/2 (Kalker,
//! table E.3 of his 1990 book): linear between the ratios, the quadratic rule on `1/C` between
//! Poisson's ratios, and the asymptotes of the slender ellipse up to a ratio of 0.101, the rules of
//! the open program CONTACT. C33 is left out, as in most vehicle codes: its moment is small.

/// The three coefficients for one contact ellipse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KalkerCoefficients {
    /// Longitudinal creepage to longitudinal force.
    pub c11: f64,
    /// Lateral creepage to lateral force.
    pub c22: f64,
    /// Spin to lateral force, and lateral creepage to spin moment.
    pub c23: f64,
}

/// Coefficients for semi-axes `a` (rolling direction) and `b` (across), in any one unit.
///
/// ```
/// let c = firmware_core::wheel_rail::kalker::coefficients(1.0, 1.0, 0.25);
/// assert!((c.c11 - 4.12).abs() < 1e-12 && (c.c22 - 3.67).abs() < 1e-12);
/// ```
pub fn coefficients(a: f64, b: f64, poisson: f64) -> KalkerCoefficients {
    let wide = a <= b;
    let ratio = if wide { a / b } else { b / a };
    if ratio < 0.101 {
        return if wide { wide_asymptote(ratio, poisson) } else { long_asymptote(ratio, poisson) };
    }
    let table = if wide { &WIDE } else { &LONG };
    let place = (ratio * 10.0 - 1.0).clamp(0.0, 9.0);
    let index = (place as usize).min(8);
    let fraction = place - index as f64;
    debug_assert!(index + 1 < table.len(), "row {index} of {}", table.len());
    debug_assert!(
        fraction.is_nan() || (0.0..=1.0).contains(&fraction),
        "{fraction} between two rows"
    );
    let (Some(low), Some(high)) = (table.get(index), table.get(index + 1)) else {
        return wide_asymptote(ratio, poisson);
    };
    let between = |low: [f64; 3], high: [f64; 3]| {
        let [at_0, at_quarter, at_half] = low;
        let [next_0, next_quarter, next_half] = high;
        let mix = |low, high| low * (1.0 - fraction) + high * fraction;
        over_poisson(
            [mix(at_0, next_0), mix(at_quarter, next_quarter), mix(at_half, next_half)],
            poisson,
        )
    };
    KalkerCoefficients {
        c11: between(low.c11, high.c11),
        c22: between(low.c22, high.c22),
        c23: between(low.c23, high.c23),
    }
}

/// `1/C` is quadratic in Poisson's ratio.
fn over_poisson([at_0, at_quarter, at_half]: [f64; 3], nu: f64) -> f64 {
    let inverse = 8.0 * (nu - 0.25) * (nu - 0.5) / at_0 - 16.0 * nu * (nu - 0.5) / at_quarter
        + 8.0 * nu * (nu - 0.25) / at_half;
    1.0 / inverse
}

const PI: f64 = core::f64::consts::PI;

/// Slender ellipse across the rolling direction, `g = a/b`.
fn wide_asymptote(g: f64, nu: f64) -> KalkerCoefficients {
    KalkerCoefficients {
        c11: PI * PI / 4.0 / (1.0 - nu),
        c22: PI * PI / 4.0,
        c23: PI * crate::sqrt::sqrt(g) / 3.0 / (1.0 - nu)
            * (1.0 + nu * (libm::log(16.0 / g) - 5.0)),
    }
}

/// Slender ellipse along the rolling direction, `g = b/a`.
fn long_asymptote(g: f64, nu: f64) -> KalkerCoefficients {
    let log = libm::log(16.0 / (g * g));
    let along = log - 2.0 * nu;
    let across = (1.0 - nu) * log + 2.0 * nu;
    let bend = 3.0 - libm::log(4.0);
    KalkerCoefficients {
        c11: 2.0 * PI / (along * g) * (1.0 + bend / along),
        c22: 2.0 * PI / (across * g) * (1.0 + (1.0 - nu) * bend / across),
        c23: 2.0 * PI / 3.0 / (g * crate::sqrt::sqrt(g)) / ((1.0 - nu) * log - 2.0 + 4.0 * nu),
    }
}

/// One axis ratio: each coefficient at Poisson's ratio 0, 1/4, 1/2.
struct Row {
    c11: [f64; 3],
    c22: [f64; 3],
    c23: [f64; 3],
}

const fn row(c11: [f64; 3], c22: [f64; 3], c23: [f64; 3]) -> Row {
    Row { c11, c22, c23 }
}

/// `a/b` = 0.1, 0.2 ... 1.0.
#[expect(clippy::approx_constant, reason = "3.14 stands in the published table")]
static WIDE: [Row; 10] = [
    row([2.51, 3.31, 4.85], [2.51, 2.52, 2.53], [0.334, 0.473, 0.731]),
    row([2.59, 3.37, 4.81], [2.59, 2.63, 2.66], [0.483, 0.603, 0.809]),
    row([2.68, 3.44, 4.80], [2.68, 2.75, 2.81], [0.607, 0.715, 0.889]),
    row([2.78, 3.53, 4.82], [2.78, 2.88, 2.98], [0.720, 0.823, 0.977]),
    row([2.88, 3.62, 4.83], [2.88, 3.01, 3.14], [0.827, 0.929, 1.07]),
    row([2.98, 3.72, 4.91], [2.98, 3.14, 3.31], [0.930, 1.03, 1.18]),
    row([3.09, 3.81, 4.97], [3.09, 3.28, 3.48], [1.03, 1.14, 1.29]),
    row([3.19, 3.91, 5.05], [3.19, 3.41, 3.65], [1.13, 1.25, 1.40]),
    row([3.29, 4.01, 5.12], [3.29, 3.54, 3.82], [1.23, 1.36, 1.51]),
    row([3.40, 4.12, 5.20], [3.40, 3.67, 3.98], [1.33, 1.47, 1.63]),
];

/// `b/a` = 0.1, 0.2 ... 1.0.
static LONG: [Row; 10] = [
    row([10.7, 11.7, 12.9], [10.7, 12.8, 16.0], [12.2, 14.6, 18.0]),
    row([6.96, 7.78, 8.82], [6.96, 8.14, 9.79], [5.72, 6.63, 7.89]),
    row([5.57, 6.34, 7.34], [5.57, 6.40, 7.51], [3.79, 4.32, 5.01]),
    row([4.84, 5.57, 6.57], [4.84, 5.48, 6.31], [2.88, 3.24, 3.70]),
    row([4.37, 5.10, 6.11], [4.37, 4.90, 5.56], [2.35, 2.62, 2.96]),
    row([4.06, 4.78, 5.80], [4.06, 4.50, 5.04], [2.01, 2.23, 2.50]),
    row([3.82, 4.54, 5.58], [3.82, 4.21, 4.67], [1.76, 1.95, 2.18]),
    row([3.65, 4.36, 5.42], [3.65, 3.99, 4.39], [1.58, 1.75, 1.94]),
    row([3.51, 4.22, 5.30], [3.51, 3.81, 4.16], [1.44, 1.59, 1.77]),
    row([3.40, 4.12, 5.20], [3.40, 3.67, 3.98], [1.33, 1.47, 1.63]),
];
