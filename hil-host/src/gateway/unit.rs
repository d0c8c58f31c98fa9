//! Units of a DBC, by their text.

/// What a signal measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Dimension {
    Displacement,
    Velocity,
    Force,
    Temperature,
}

impl Dimension {
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
