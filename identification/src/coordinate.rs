//! Unbounded coordinates for bounded parameters, so that a solver for free ones can be used.
//!
//! ```text
//! spread   lower > 0, upper / lower large   ln t = ln lower + L / (1 + e^-u),
//!                                           L = ln(upper / lower)
//! from 0   lower = 0                        t = s ln(1 + e^u), capped at upper
//! of either sign                            t = d sinh u, capped at both bounds
//! between                                   t = lower + (upper - lower) / (1 + e^-u)
//! ```
//!
//! with s a tenth of the usual value and d the usual value: nearly linear in the relevant range.
//! Close to zero a parameter from 0 is flat: a fit that is to leave zero has to start above it
//! ([`Coordinate::lifted`]).

/// The coordinate of one parameter in the solver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coordinate {
    /// Over several decades.
    Spread {
        /// Logarithm of the lower bound.
        ln_lower: f64,
        /// Logarithm of upper over lower bound.
        ln_ratio: f64,
    },
    /// From zero upwards.
    FromZero {
        /// Where it turns from exponential to linear.
        bend: f64,
        /// Upper bound.
        upper: f64,
    },
    /// Of either sign, over several decades.
    Signed {
        /// Where it turns from linear to exponential.
        bend: f64,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// Between two bounds.
    Between {
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
}

/// Ratio of bounds from which a parameter is spread over decades.
const SPREAD: f64 = 30.0;
/// Coordinate up to which a parameter near a bound still moves: 0.25 % of the way from it.
const ALIVE: f64 = 6.0;
/// Share of the bend below which a parameter from zero is stuck.
const STUCK: f64 = 1e-2;
/// A coordinate stays within this, or exponentials underflow.
const FAR: f64 = 30.0;

/// A parameter closer to its bound than this share is on it.
pub(crate) const ON_BOUND: f64 = 1e-3;

impl Coordinate {
    /// The coordinate for bounds and a usual size above zero.
    pub fn new(lower: f64, upper: f64, usual: f64) -> Self {
        debug_assert!(lower < upper, "bounds {lower} and {upper} enclose nothing");
        if lower == 0.0 {
            Self::FromZero { bend: 0.1 * usual.abs(), upper }
        } else if lower > 0.0 && upper / lower > SPREAD {
            Self::Spread { ln_lower: libm::log(lower), ln_ratio: libm::log(upper / lower) }
        } else if lower < 0.0 && upper > 0.0 && usual != 0.0 {
            Self::Signed { bend: usual.abs(), lower, upper }
        } else {
            Self::Between { lower, upper }
        }
    }

    /// A start value that is not stuck at zero.
    pub fn lifted(&self, value: f64) -> f64 {
        match *self {
            Self::FromZero { bend, .. } => value.max(bend),
            _ => value,
        }
    }

    /// The same for a value so close to zero that no fit leaves it again.
    pub fn freed(&self, value: f64) -> f64 {
        match *self {
            Self::FromZero { bend, .. } if value < STUCK * bend => bend,
            _ => value,
        }
    }

    /// The coordinate itself, or, where it lies so close to a bound that the parameter does not
    /// change with it, the nearest one at which it does.
    pub fn inside(&self, u: f64) -> f64 {
        match *self {
            Self::FromZero { .. } => u.max(-ALIVE),
            Self::Spread { .. } | Self::Between { .. } => u.clamp(-ALIVE, ALIVE),
            Self::Signed { .. } => u,
        }
    }

    /// The parameter at a coordinate.
    pub fn value(&self, u: f64) -> f64 {
        let u = u.clamp(-FAR, 1e9);
        match *self {
            // Rounding may lift the exponential above the bound that it was made from.
            Self::Spread { ln_lower, ln_ratio } => {
                libm::exp(ln_lower + ln_ratio * logistic(u).min(1.0 - 1e-15))
                    .max(libm::exp(ln_lower))
            }
            Self::FromZero { bend, upper } => {
                let rise = if u > 30.0 { u } else { libm::log1p(libm::exp(u)) };
                (bend * rise).min(upper)
            }
            Self::Signed { bend, lower, upper } => {
                (bend * libm::sinh(u.min(FAR))).clamp(lower, upper)
            }
            Self::Between { lower, upper } => lower + (upper - lower) * logistic(u),
        }
    }

    /// The coordinate of a parameter; values on or beyond a bound are taken just inside it.
    pub fn at(&self, value: f64) -> f64 {
        let between = |share: f64| {
            let share = share.clamp(1e-6, 1.0 - 1e-6);
            libm::log(share / (1.0 - share))
        };
        match *self {
            Self::Spread { ln_lower, ln_ratio } => {
                between((libm::log(value.max(1e-300)) - ln_lower) / ln_ratio)
            }
            Self::FromZero { bend, upper } => {
                let rise = (value.clamp(0.0, upper) / bend).max(1e-6);
                if rise > 30.0 { rise } else { libm::log(libm::expm1(rise)) }
            }
            Self::Signed { bend, lower, upper } => libm::asinh(value.clamp(lower, upper) / bend),
            Self::Between { lower, upper } => between((value - lower) / (upper - lower)),
        }
    }

    /// Change of the parameter per change of the coordinate.
    pub fn slope(&self, u: f64) -> f64 {
        let step = 1e-5;
        (self.value(u + step) - self.value(u - step)) / (2.0 * step)
    }
}

/// The physical limit that a value lies on, if it does. Zero as the lower bound is no such limit:
/// it means that the effect is absent.
pub(crate) fn physical_limit(value: f64, (lower, upper): (f64, f64)) -> Option<&'static str> {
    let near = ON_BOUND * (upper - lower);
    if lower < 0.0 && value < lower + near {
        Some("negative")
    } else {
        (value > upper - near).then_some("large")
    }
}

fn logistic(u: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-u))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        for (lower, upper, usual, values) in [
            (1e-5, 100.0, 0.01, [2e-5, 0.01, 50.0]),
            (0.0, 1.0, 0.05, [1e-4, 0.05, 0.9]),
            (-1.0, 1.0, 0.05, [-0.9, 0.0, 0.5]),
            (-100.0, 100.0, 0.3, [-50.0, 0.02, 3.0]),
            (1.0, 10.0, 1.3, [1.01, 1.3, 9.0]),
        ] {
            let coordinate = Coordinate::new(lower, upper, usual);
            for value in values {
                let back = coordinate.value(coordinate.at(value));
                assert!((back - value).abs() < 1e-9 * value.abs().max(1e-3), "{value} {back}");
                assert!(coordinate.slope(coordinate.at(value)) > 0.0);
            }
            for u in [-1e12, -40.0, 0.0, 40.0, 1e12] {
                let value = coordinate.value(u);
                assert!(value >= lower && value <= upper, "{u}: {value}");
            }
        }
    }
}
