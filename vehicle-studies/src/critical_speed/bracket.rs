//! A speed at which something begins, between two that were tried.

use serde::{Deserialize, Serialize};

/// A critical speed, or on which side of the range it lies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(from = "Form", into = "Form")]
pub enum Critical {
    /// Here (km/h).
    At(f64),
    /// Below the lowest speed tried (km/h).
    Below(f64),
    /// Above the highest speed tried (km/h).
    Above(f64),
}

/// As it is written.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Form {
    kmh: Option<f64>,
    below_kmh: Option<f64>,
    above_kmh: Option<f64>,
}

impl From<Critical> for Form {
    fn from(critical: Critical) -> Self {
        match critical {
            Critical::At(kmh) => Self { kmh: Some(kmh), ..Self::default() },
            Critical::Below(kmh) => Self { below_kmh: Some(kmh), ..Self::default() },
            Critical::Above(kmh) => Self { above_kmh: Some(kmh), ..Self::default() },
        }
    }
}

impl From<Form> for Critical {
    fn from(form: Form) -> Self {
        match form {
            Form { kmh: Some(kmh), .. } => Self::At(kmh),
            Form { below_kmh: Some(kmh), .. } => Self::Below(kmh),
            Form { above_kmh, .. } => Self::Above(above_kmh.unwrap_or(f64::INFINITY)),
        }
    }
}

impl Critical {
    /// The speed, where it is in the range (km/h).
    pub const fn kmh(self) -> Option<f64> {
        match self {
            Self::At(kmh) => Some(kmh),
            Self::Below(_) | Self::Above(_) => None,
        }
    }
}

impl std::fmt::Display for Critical {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::At(kmh) => write!(f, "{kmh:.1}"),
            Self::Below(kmh) => write!(f, "< {kmh:.0}"),
            Self::Above(kmh) => write!(f, "> {kmh:.0}"),
        }
    }
}

/// The first speed of a climb at which `unstable` holds, met within a resolution by halving the
/// last step. Speeds in km/h.
///
/// # Errors
/// The first error of `unstable`; no further speed is tried.
pub(super) fn first_unstable<E>(
    [from, to]: [f64; 2],
    step: f64,
    resolution: f64,
    mut unstable: impl FnMut(f64) -> Result<bool, E>,
) -> Result<Critical, E> {
    debug_assert!(from < to && step > 0.0 && resolution > 0.0, "{from} to {to} in {step}");
    if unstable(from)? {
        return Ok(Critical::Below(from));
    }
    let (mut low, mut high) = (from, from);
    loop {
        if high >= to {
            return Ok(Critical::Above(to));
        }
        high = (high + step).min(to);
        if unstable(high)? {
            break;
        }
        low = high;
    }
    while high - low > resolution {
        let middle = 0.5 * (low + high);
        if unstable(middle)? {
            high = middle;
        } else {
            low = middle;
        }
    }
    // The last speed that is known to be unstable.
    Ok(Critical::At(high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn the_first_unstable_speed_is_met_within_the_resolution() {
        let climb = |critical_kmh: f64| {
            first_unstable([100.0, 300.0], 5.0, 0.5, |kmh| Ok::<_, Infallible>(kmh >= critical_kmh))
        };
        assert_eq!(climb(211.3), Ok(Critical::At(211.5625)));
        assert_eq!(climb(301.0), Ok(Critical::Above(300.0)));
        assert_eq!(climb(90.0), Ok(Critical::Below(100.0)));
    }

    #[test]
    fn an_error_ends_the_climb_at_once() {
        let mut tried = 0;
        let climbed = first_unstable([100.0, 300.0], 5.0, 0.5, |kmh| {
            tried += 1;
            if kmh < 110.0 { Ok(false) } else { Err("stopped") }
        });
        assert_eq!((climbed, tried), (Err("stopped"), 3));
    }
}
