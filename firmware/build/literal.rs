//! Values of the core as Rust source.
//!
//! Every struct is taken apart field by field, so that a field that is added later does not get
//! lost here: it does not compile.

use firmware_core::compensation::{Compensator, Feedforward, Series};
use firmware_core::damper::Nominal;
use firmware_core::lanes::Lanes;
use firmware_core::track::IrregularitySample;
use firmware_core::vehicle::{
    Anchor, Axle, Body, BodyId, BumpStop, DamperMount, RailSupport, Suspension, Torsion, Vehicle,
    VehicleState,
};
use firmware_core::wheel_rail::creep::{CreepForce, CreepLaw, Creepage};
use firmware_core::wheel_rail::hertz::Material;
use firmware_core::wheel_rail::table::{ContactTable, ZoneTable};
use firmware_core::wheel_rail::wheel::{Rolling, Surface, Wheel, WheelForce};

/// A value that can be written as an expression of Rust.
pub(crate) trait Literal {
    fn literal(&self) -> String;
}

impl Literal for f64 {
    /// The shortest text that reads back as the same bits.
    fn literal(&self) -> String {
        match self {
            value if value.is_nan() => panic!("NaN is no part of a set-up"),
            value if value.is_infinite() && *value > 0.0 => "f64::INFINITY".into(),
            value if value.is_infinite() => "f64::NEG_INFINITY".into(),
            value => format!("{value:?}"),
        }
    }
}

impl Literal for bool {
    fn literal(&self) -> String {
        self.to_string()
    }
}

impl Literal for BodyId {
    fn literal(&self) -> String {
        if *self == Self::GROUND {
            "BodyId::GROUND".into()
        } else {
            format!("body({})", self.index())
        }
    }
}

impl<T: Literal> Literal for Option<T> {
    fn literal(&self) -> String {
        self.as_ref().map_or("None".into(), |value| format!("Some({})", value.literal()))
    }
}

impl<T: Literal> Literal for [T] {
    fn literal(&self) -> String {
        let items: Vec<String> = self.iter().map(Literal::literal).collect();
        format!("[{}]", items.join(", "))
    }
}

impl<T: Literal, const N: usize> Literal for [T; N] {
    fn literal(&self) -> String {
        self.as_slice().literal()
    }
}

impl Literal for (f64, f64) {
    fn literal(&self) -> String {
        format!("({}, {})", self.0.literal(), self.1.literal())
    }
}

impl Literal for nalgebra::Vector3<f64> {
    fn literal(&self) -> String {
        let [x, y, z] = [self.x, self.y, self.z].map(|value| value.literal());
        format!("Vector3::new({x}, {y}, {z})")
    }
}

impl Literal for Lanes<1> {
    fn literal(&self) -> String {
        format!("Lanes([{}])", self.lane(0).literal())
    }
}

impl Literal for Surface {
    fn literal(&self) -> String {
        assert!(*self == Self::Profiles, "only wheels on profiles are taken to a board");
        "Surface::Profiles".into()
    }
}

impl Literal for CreepLaw {
    /// The image chooses its law when it runs.
    fn literal(&self) -> String {
        "CreepLaw::LinearSaturated".into()
    }
}

impl Literal for Compensator {
    fn literal(&self) -> String {
        match self {
            Self::None => "Compensator::None".into(),
            Self::Feedforward(fixed) => format!(
                "{{ use firmware_core::compensation::{{Feedforward, Series}}; \
                 Compensator::Feedforward({}) }}",
                fixed.literal()
            ),
            Self::Adaptive(_) => panic!("no adaptive compensator is taken to a board"),
        }
    }
}

impl Literal for ZoneTable {
    fn literal(&self) -> String {
        format!("ZoneTable::from_rows({})", self.rows().literal())
    }
}

impl Literal for Series {
    fn literal(&self) -> String {
        format!("Series({})", self.0.literal())
    }
}

impl<T: Literal, const N: usize> Literal for heapless::Vec<T, N> {
    fn literal(&self) -> String {
        format!("heapless::Vec::from_array({})", self.as_slice().literal())
    }
}

macro_rules! by_fields {
    ($($type:ident { $($field:ident),* })*) => {
        $(impl Literal for $type {
            fn literal(&self) -> String {
                let Self { $($field),* } = self;
                let fields = [$(format!("{}: {}", stringify!($field), $field.literal())),*];
                format!("{} {{ {} }}", stringify!($type), fields.join(", "))
            }
        })*
    };
}

/// A state of one vehicle.
type OneVehicle = VehicleState<1>;

by_fields! {
    Anchor { body, point_m }
    Axle { body, wheel, rail }
    Body { mass_kg, inertia_kg_m2, free, station_m, height_m, rolling_radius_m }
    BumpStop { first, second, characteristic }
    ContactTable { tread, flange }
    CreepForce { longitudinal_n, lateral_n, spin_moment_n_m }
    Creepage { longitudinal, lateral, spin_per_m }
    DamperMount { first, second, direction }
    Feedforward { series, known_delay_s, takes_jerk }
    IrregularitySample { vertical_m, alignment_m, cross_level_m, gauge_m }
    Material { shear_modulus_pa, poisson }
    Nominal { ce_n_s_per_m, ke_n_per_m, clearance_2a_m, f_relief_n, c2_n_s_per_m }
    OneVehicle {
        distance_m, position, half_velocity, acceleration, rail_position, rail_half_velocity,
        rail_acceleration, wheels, shifts_m, extension_m, extension_m_per_s, damper_n
    }
    RailSupport { mass_kg, stiffness_n_per_m, damping_n_s_per_m }
    Rolling { creepage, force }
    Suspension { first, second, stiffness_n_per_m, damping_n_s_per_m, play_m }
    Torsion { first, second, stiffness_n_m_per_rad, damping_n_m_s_per_rad }
    Vehicle { bodies, suspensions, torsions, bump_stops, dampers, axles }
    Wheel { tape_m, radius_m, friction, material, surface, creep }
    WheelForce {
        longitudinal_n, lateral_n, vertical_n, roll_n_m, pitch_n_m, yaw_n_m, tread_n, flange_n,
        wear_w, tread, flange
    }
}
