//! Units of a DBC, by their text.

/// What a signal measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Dimension {
    Displacement,
    Velocity,
    Force,
    Temperature,
}

/// The least range that a signal of use has, and its largest step (SI units, or degrees Celsius).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Least {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) step: f64,
}

impl Dimension {
    /// What a signal has to hold to be of use at all.
    pub(super) const fn least(self) -> Least {
        match self {
            Self::Displacement => Least { low: -1e-3, high: 1e-3, step: 1e-4 },
            Self::Velocity => Least { low: -0.01, high: 0.01, step: 1e-3 },
            Self::Force => Least { low: -1e3, high: 1e3, step: 100.0 },
            Self::Temperature => Least { low: 20.0, high: 50.0, step: 5.0 },
        }
    }

    /// The unit of that.
    pub(super) const fn si_unit(self) -> &'static str {
        match self {
            Self::Displacement => "m",
            Self::Velocity => "m/s",
            Self::Force => "N",
            Self::Temperature => "degC",
        }
    }

    /// The units that are known, in words.
    pub(super) const fn units(self) -> &'static str {
        match self {
            Self::Displacement => "m, mm or um",
            Self::Velocity => "m/s or mm/s",
            Self::Force => "N or kN",
            Self::Temperature => "degC",
        }
    }

    /// SI units (or degrees Celsius) in one unit; `None` for one that is not known.
    pub(super) fn scale(self, unit: &str) -> Option<f64> {
        Some(match (self, unit.trim()) {
            // Micro has two characters.
            (Self::Displacement, "um" | "\u{b5}m" | "\u{3bc}m") => 1e-6,
            (Self::Displacement, "mm") | (Self::Velocity, "mm/s") => 1e-3,
            (Self::Displacement, "m")
            | (Self::Velocity, "m/s")
            | (Self::Force, "N")
            | (Self::Temperature, "degC" | "\u{b0}C" | "C") => 1.0,
            (Self::Force, "kN") => 1e3,
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_of_another_dimension_is_not_known() {
        assert_eq!(Dimension::Displacement.scale("\u{b5}m"), Some(1e-6));
        assert_eq!(Dimension::Force.scale("kN"), Some(1e3));
        assert_eq!(Dimension::Force.scale("mm"), None);
        assert_eq!(Dimension::Displacement.scale(""), None);
        assert_eq!(Dimension::Velocity.scale("MM/S"), None);
    }
}
