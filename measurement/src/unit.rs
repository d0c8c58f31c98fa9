//! Units of laboratories, turned into SI: `si = factor * (reading + shift)`.

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Time, s.
    Time,
    /// Displacement, m.
    Displacement,
    /// Velocity, m/s.
    Velocity,
    /// Force, N.
    Force,
    /// Temperature, degrees Celsius.
    Temperature,
    /// Acceleration, m/s2.
    Acceleration,
}

/// A unit of one kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unit {
    factor: f64,
    shift: f64,
}

const TIME: &[(&str, f64)] = &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("min", 60.0)];
const DISPLACEMENT: &[(&str, f64)] =
    &[("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("in", 0.0254)];
const VELOCITY: &[(&str, f64)] =
    &[("m/s", 1.0), ("cm/s", 1e-2), ("mm/s", 1e-3), ("um/s", 1e-6), ("in/s", 0.0254)];
/// Pound-force and kilogram-force by the standard acceleration 9.80665 m/s2.
const FORCE: &[(&str, f64)] = &[
    ("N", 1.0),
    ("kN", 1e3),
    ("MN", 1e6),
    ("daN", 10.0),
    ("lbf", 4.448_221_615_260_5),
    ("kgf", 9.806_65),
];
/// Standard gravity 9.80665 m/s2.
const ACCELERATION: &[(&str, f64)] =
    &[("m/s2", 1.0), ("m/s^2", 1.0), ("mm/s2", 1e-3), ("g", 9.806_65), ("mg", 9.806_65e-3)];
const TEMPERATURE: &[(&str, f64)] = &[("degC", 1.0), ("degF", 5.0 / 9.0), ("K", 1.0)];

impl Kind {
    fn table(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Time => TIME,
            Self::Displacement => DISPLACEMENT,
            Self::Velocity => VELOCITY,
            Self::Force => FORCE,
            Self::Temperature => TEMPERATURE,
            Self::Acceleration => ACCELERATION,
        }
    }

    /// Names of the units that it knows.
    pub(crate) fn names(self) -> String {
        let names: Vec<&str> = self.table().iter().map(|(name, _)| *name).collect();
        names.join(", ")
    }

    /// The unit of this name; brackets, the signs for micro and degree, and `C` or `F` alone count
    /// as what they mean.
    pub(crate) fn unit(self, name: &str) -> Option<Unit> {
        let plain = name.trim().trim_matches(['[', ']', '(', ')']).trim();
        let plain = plain.replace(['µ', 'μ'], "u").replace('°', "deg").replace("deg ", "deg");
        let plain = match (self, plain.as_str()) {
            (Self::Temperature, "C" | "c" | "degc") => "degC",
            (Self::Temperature, "F" | "f" | "degf") => "degF",
            (Self::Time, "sec") => "s",
            (_, other) => other,
        };
        let (name, factor) = self.table().iter().find(|(known, _)| *known == plain)?;
        let shift = match *name {
            "degF" => -32.0,
            "K" => -273.15,
            _ => 0.0,
        };
        Some(Unit { factor: *factor, shift })
    }
}

impl Unit {
    /// The unit that this project uses.
    pub(crate) const SI: Self = Self { factor: 1.0, shift: 0.0 };

    /// A reading in the project's unit.
    pub(crate) fn si(self, reading: f64) -> f64 {
        self.factor * (reading + self.shift)
    }

    /// Size of a difference of one in the project's unit.
    pub(crate) fn factor(self) -> f64 {
        self.factor
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_known_unit_is_found_by_its_own_name() {
        for kind in [
            Kind::Time,
            Kind::Displacement,
            Kind::Velocity,
            Kind::Force,
            Kind::Temperature,
            Kind::Acceleration,
        ] {
            for (name, factor) in kind.table() {
                assert_eq!(kind.unit(name).unwrap().factor(), *factor);
                assert!(kind.names().contains(name));
            }
            assert_eq!(kind.unit("furlong"), None);
        }
    }

    #[test]
    fn laboratory_spellings_mean_what_they_say() {
        assert_eq!(Kind::Force.unit("[kN]").unwrap().si(18.0), 18.0e3);
        assert_eq!(Kind::Temperature.unit("°F").unwrap().si(68.0), 20.0);
        assert_eq!(Kind::Displacement.unit("inches"), None);
        assert_eq!(Kind::Displacement.unit("µm").unwrap().si(1e6), 1.0);
        assert_eq!(Kind::Displacement.unit(" (mm) ").unwrap().si(25.0), 0.025);
        assert!((Kind::Force.unit("lbf").unwrap().si(1000.0) - 4_448.221_615).abs() < 1e-6);
        assert_eq!(Kind::Temperature.unit("K").unwrap().si(293.15), 20.0);
        assert_eq!(Kind::Temperature.unit("° C").unwrap().si(20.0), 20.0);
        assert_eq!(Kind::Velocity.unit("mm/s").unwrap().si(250.0), 0.25);
    }
}
