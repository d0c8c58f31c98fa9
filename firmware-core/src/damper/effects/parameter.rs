//! The parameter table of an effect: what the scenario format, the fitter, the report and the
//! documentation read.

/// Size of a damper or of a record, from which bounds and start values follow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// A large force of it, N.
    pub force_n: f64,
    /// A large velocity, m/s.
    pub velocity_m_per_s: f64,
    /// A large displacement from its mean, m.
    pub displacement_m: f64,
    /// The farthest position from the datum in extension, m.
    pub extension_m: f64,
    /// The farthest position from the datum in compression, m.
    pub compression_m: f64,
}

/// Unit of a parameter; those that grow with the size of a damper know how.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// No unit.
    One,
    /// s.
    Second,
    /// N.
    Newton,
    /// m.
    Metre,
    /// m; a position in extension.
    MetreOfExtension,
    /// m; a position in compression.
    MetreOfCompression,
    /// m/s.
    MetrePerSecond,
    /// N/m.
    NewtonPerMetre,
    /// N s/m.
    NewtonSecondPerMetre,
    /// N s2/m2.
    NewtonSecond2PerMetre2,
    /// kg.
    Kilogram,
    /// 1/m.
    PerMetre,
    /// 1/m2.
    PerMetre2,
    /// K.
    Kelvin,
    /// 1/K.
    PerKelvin,
    /// J/K.
    JoulePerKelvin,
    /// W/K.
    WattPerKelvin,
}

impl Unit {
    /// As it is written.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::One => "1",
            Self::Second => "s",
            Self::Newton => "N",
            Self::Metre | Self::MetreOfExtension | Self::MetreOfCompression => "m",
            Self::MetrePerSecond => "m/s",
            Self::NewtonPerMetre => "N/m",
            Self::NewtonSecondPerMetre => "N s/m",
            Self::NewtonSecond2PerMetre2 => "N s2/m2",
            Self::Kilogram => "kg",
            Self::PerMetre => "1/m",
            Self::PerMetre2 => "1/m2",
            Self::Kelvin => "K",
            Self::PerKelvin => "1/K",
            Self::JoulePerKelvin => "J/K",
            Self::WattPerKelvin => "W/K",
        }
    }

    /// The natural size of a quantity of this unit; one where it does not grow with the damper.
    pub fn natural(self, scale: &Scale) -> f64 {
        let Scale { force_n, velocity_m_per_s, displacement_m, .. } = *scale;
        match self {
            Self::One | Self::Second | Self::Kelvin | Self::PerKelvin => 1.0,
            Self::Newton => force_n,
            Self::Metre => displacement_m,
            Self::MetreOfExtension => scale.extension_m,
            Self::MetreOfCompression => scale.compression_m,
            Self::MetrePerSecond => velocity_m_per_s,
            Self::NewtonPerMetre => force_n / displacement_m,
            Self::NewtonSecondPerMetre => force_n / velocity_m_per_s,
            Self::NewtonSecond2PerMetre2 => force_n / (velocity_m_per_s * velocity_m_per_s),
            Self::Kilogram => force_n * displacement_m / (velocity_m_per_s * velocity_m_per_s),
            Self::PerMetre => 1.0 / displacement_m,
            Self::PerMetre2 => 1.0 / (displacement_m * displacement_m),
            Self::JoulePerKelvin => force_n * displacement_m,
            Self::WattPerKelvin => force_n * velocity_m_per_s,
        }
    }

    /// True when the size of such a quantity does not depend on the damper.
    pub const fn is_absolute(self) -> bool {
        matches!(self, Self::One | Self::Second | Self::Kelvin | Self::PerKelvin)
    }
}

/// One row of a parameter table. `lower`, `upper` and `typical` are multiples of the natural size
/// of the unit; the bounds exclude the impossible, and typical is no bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name, with the unit at its end.
    pub name: &'static str,
    /// Unit.
    pub unit: Unit,
    /// Smallest possible value, in natural sizes.
    pub lower: f64,
    /// Largest possible value, in natural sizes.
    pub upper: f64,
    /// A usual value, in natural sizes.
    pub typical: f64,
    /// What it is.
    pub meaning: &'static str,
}

impl Parameter {
    /// Lower and upper bound in the parameter's unit.
    pub fn bounds(&self, scale: &Scale) -> (f64, f64) {
        let natural = self.unit.natural(scale);
        (self.lower * natural, self.upper * natural)
    }

    /// A usual value in the parameter's unit.
    pub fn usual(&self, scale: &Scale) -> f64 {
        self.typical * self.unit.natural(scale)
    }

    /// The bounds that hold for a damper of any size: both for a ratio or a time; for everything
    /// else the sign, and whether it can be zero.
    pub fn bounds_at_any_scale(&self) -> (f64, f64) {
        if self.unit.is_absolute() {
            return (self.lower, self.upper);
        }
        let lower = match self.lower {
            below if below < 0.0 => -f64::MAX,
            0.0 => 0.0,
            _ => f64::MIN_POSITIVE,
        };
        let upper = if self.upper > 0.0 { f64::MAX } else { 0.0 };
        (lower, upper)
    }
}

/// Declares the struct of an effect from its parameter table, one row per field, so that field,
/// row and order of values cannot part.
macro_rules! effect_parameters {
    (
        $(#[$doc:meta])*
        $effect:ident {
            $($field:ident: $unit:ident in $lower:literal to $upper:literal,
              typical $typical:literal, $meaning:literal;)+
        }
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $effect {
            $(#[doc = $meaning] pub $field: f64,)+
        }

        impl $crate::damper::effects::Table for $effect {
            const PARAMETERS: &'static [$crate::damper::effects::Parameter] = &[
                $($crate::damper::effects::Parameter {
                    name: stringify!($field),
                    unit: $crate::damper::effects::Unit::$unit,
                    lower: $lower,
                    upper: $upper,
                    typical: $typical,
                    meaning: $meaning,
                },)+
            ];

            fn from_table(values: &[f64]) -> Option<Self> {
                let mut values = values.iter().copied();
                let effect = Self { $($field: values.next()?,)+ };
                if values.next().is_some() { None } else { Some(effect) }
            }

            fn values(&self) -> $crate::damper::effects::Values {
                $crate::damper::effects::Values::from_iter([$(self.$field,)+])
            }
        }
    };
}

pub(super) use effect_parameters;
