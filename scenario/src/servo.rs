//! The servo-hydraulic drive of an emulated rig in a file.
//!
//! ```toml
//! kind = "servo"
//!
//! [servo]                          # all of it may be left out; these are the defaults
//! controller_gain_per_s = 100.0    # speed that a distance of 1 m asks for
//! feed_forward = 0.9               # share of the reference's velocity that opens the valve
//! valve_hz = 80.0                  # natural frequency of the spool
//! valve_damping_ratio = 0.7
//! rated_flow_m3_per_s = 1.8e-3     # valve fully open, no load
//! pump_flow_m3_per_s = 2.2e-3      # most that is supplied
//! supply_pa = 21e6
//! area_m2 = 3e-3                   # of the piston, equal on both sides
//! bulk_modulus_pa = 1.0e9          # of the oil with its air and hoses
//! oil_volume_m3 = 7.2e-4           # both chambers and their lines: 1.2 times what the ram sweeps
//! leakage_m3_per_s_pa = 2e-12      # across the piston
//! ram_mass_kg = 60.0
//! friction_n_s_per_m = 5e3         # of the ram, viscous
//! end_mass_kg = 10.0               # between load cell and damper
//! fixture_damping_ratio = 0.02     # of the end mass on the fixture
//! heat_capacity_j_per_k = 21e3     # of the damper, unless its temperature_fade says
//! cooling_w_per_k = 5.0            # the same
//! ambient_degc = 20.0
//! ```
//! The defaults are assumed, and are the numbers of no machine: a class of rig for dampers of 25 kN
//! that moves at 0.6 m/s without load and stalls at 63 kN.
//!
//! No part may vibrate faster than the emulator's substeps can follow ([`FASTEST_HZ`]).

use crate::error::ScenarioError;
use crate::quantity::Quantity;
use crate::source::Source;
use firmware_core::damper::{Damper, HeatBalance};
use serde::{Deserialize, Serialize};

/// Highest natural frequency of ram, end mass and spool: with substeps of 1/32 ms half a radian
/// each.
pub const FASTEST_HZ: f64 = 2500.0;

/// Stiffness of the fixture of a servo rig without `fixture_n_per_m` (N/m).
pub(crate) const FIXTURE_N_PER_M: f64 = 100e6;

/// Oil in chambers and lines over the volume that the ram sweeps.
const OIL_OVER_SWEPT: f64 = 1.2;

/// A table of the drive: each row is a key, its bounds and its default.
macro_rules! servo_drive {
    ($($(#[doc = $doc:literal])+ $key:ident: $least:literal to $most:literal $unit:literal
        or $default:literal;)+) => {
        /// The drive as it stands in its file.
        #[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
        #[serde(deny_unknown_fields)]
        pub struct ServoFile {
            $($(#[doc = $doc])+ pub $key: Option<Quantity>,)+
            /// Oil of both chambers and their lines.
            pub oil_volume_m3: Option<Quantity>,
            /// Heat that warms the damper by one kelvin.
            pub heat_capacity_j_per_k: Option<Quantity>,
            /// Heat that leaves the damper per kelvin above its surroundings.
            pub cooling_w_per_k: Option<Quantity>,
        }

        /// A servo-hydraulic drive, ready to be emulated.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct ServoSetup {
            $($(#[doc = $doc])+ pub $key: f64,)+
            /// Oil of both chambers and their lines.
            pub oil_volume_m3: f64,
            /// How the damper warms.
            pub heat: HeatBalance,
        }

        impl ServoFile {
            /// The same with every default written out, as it was built.
            pub(crate) fn with_defaults(&self, built: &ServoSetup) -> Self {
                let or = |given: &Option<Quantity>, value| Some(Quantity::or(given.as_ref(), value));
                let HeatBalance { capacity_j_per_k, cooling_w_per_k } = built.heat;
                Self {
                    $($key: or(&self.$key, built.$key),)+
                    oil_volume_m3: or(&self.oil_volume_m3, built.oil_volume_m3),
                    heat_capacity_j_per_k: or(&self.heat_capacity_j_per_k, capacity_j_per_k),
                    cooling_w_per_k: or(&self.cooling_w_per_k, cooling_w_per_k),
                }
            }

            /// The numbers, each within its bounds, with oil and heat as given.
            fn numbers(
                &self,
                source: &Source,
                (oil_volume_m3, heat): (f64, HeatBalance),
            ) -> Result<ServoSetup, ScenarioError> {
                Ok(ServoSetup {
                    $($key: Quantity::within_or(
                        self.$key.as_ref(),
                        source,
                        stringify!($key),
                        ($least, $most, $unit),
                        $default,
                    )?,)+
                    oil_volume_m3,
                    heat,
                })
            }
        }
    };
}

servo_drive! {
    /// Gain of the position controller: speed that is asked for per distance to the reference.
    controller_gain_per_s: 1.0 to 1000.0 "1/s" or 100.0;
    /// Share of the reference's velocity that goes to the valve directly.
    feed_forward: 0.0 to 1.0 "(a share)" or 0.9;
    /// Natural frequency of the spool.
    valve_hz: 5.0 to 500.0 "Hz" or 80.0;
    /// Damping ratio of the spool.
    valve_damping_ratio: 0.1 to 2.0 "(a ratio)" or 0.7;
    /// Flow of the open valve without load.
    rated_flow_m3_per_s: 1e-5 to 0.1 "m3/s" or 1.8e-3;
    /// Most flow that the supply gives.
    pump_flow_m3_per_s: 1e-5 to 0.1 "m3/s" or 2.2e-3;
    /// Supply pressure above that of the return line.
    supply_pa: 1e5 to 1e8 "Pa" or 21e6;
    /// Area of the piston, equal on both sides.
    area_m2: 1e-5 to 1.0 "m2" or 3e-3;
    /// Effective bulk modulus of the oil.
    bulk_modulus_pa: 1e8 to 3e9 "Pa" or 1e9;
    /// Leakage across the piston per pressure.
    leakage_m3_per_s_pa: 0.0 to 1e-8 "m3/s/Pa" or 2e-12;
    /// Mass of the ram.
    ram_mass_kg: 1.0 to 1e4 "kg" or 60.0;
    /// Viscous friction of the ram.
    friction_n_s_per_m: 0.0 to 1e6 "N s/m" or 5e3;
    /// Mass between load cell and damper.
    end_mass_kg: 1.0 to 1e4 "kg" or 10.0;
    /// Damping ratio of the end mass on the fixture.
    fixture_damping_ratio: 0.0 to 0.5 "(a ratio)" or 0.02;
    /// Temperature of the surroundings, and of the damper at the start.
    ambient_degc: -40.0 to 80.0 "degrees Celsius" or 20.0;
}

/// What the drive needs to know of the rest of the rig.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Around<'a> {
    /// Largest travel to either side (m).
    pub(crate) stroke_m: f64,
    /// Stiffness of the fixture (N/m).
    pub(crate) fixture_n_per_m: f64,
    /// Stiffness of what is mounted (N/m).
    pub(crate) mounted_n_per_m: f64,
    /// The damper.
    pub(crate) damper: &'a Damper,
}

impl ServoFile {
    /// Builds the drive.
    ///
    /// # Errors
    /// The first number that does not fit, with file and line; a part that vibrates too fast.
    pub(crate) fn build(
        &self,
        source: &Source,
        around: Around<'_>,
    ) -> Result<ServoSetup, ScenarioError> {
        let usual = HeatBalance::of(around.damper);
        let within = |given: &Option<Quantity>, key, bounds, default| {
            Quantity::within_or(given.as_ref(), source, key, bounds, default)
        };
        let heat = HeatBalance {
            capacity_j_per_k: within(
                &self.heat_capacity_j_per_k,
                "heat_capacity_j_per_k",
                (1.0, 1e7, "J/K"),
                usual.capacity_j_per_k,
            )?,
            cooling_w_per_k: within(
                &self.cooling_w_per_k,
                "cooling_w_per_k",
                (0.0, 1e5, "W/K"),
                usual.cooling_w_per_k,
            )?,
        };
        let mut drive = self.numbers(source, (0.0, heat))?;
        let swept_m3 = 2.0 * around.stroke_m * drive.area_m2;
        drive.oil_volume_m3 = oil_volume_m3(drive.area_m2, around.stroke_m);
        if let Some(given) = &self.oil_volume_m3 {
            let expected = format!("{swept_m3:.3e} m3, which the ram sweeps, to 1 m3");
            // Rounding may not refuse the volume that the message names.
            let least_m3 = 0.999 * swept_m3;
            drive.oil_volume_m3 =
                given.within(source, "oil_volume_m3", least_m3, 1.0, &expected)?;
        }
        for (part, found_hz) in drive.fastest_hz(around) {
            if found_hz > FASTEST_HZ {
                return Err(source.whole_error(format!(
                    "[servo]: {part} vibrates at {found_hz:.0} Hz, expected at most {FASTEST_HZ} Hz"
                )));
            }
        }
        Ok(drive)
    }
}

fn oil_volume_m3(area_m2: f64, stroke_m: f64) -> f64 {
    OIL_OVER_SWEPT * 2.0 * stroke_m * area_m2
}

impl ServoSetup {
    /// Speed of the ram without load and leakage, valve fully open (m/s).
    pub fn no_load_speed_m_per_s(&self) -> f64 {
        self.rated_flow_m3_per_s.min(self.pump_flow_m3_per_s) / self.area_m2
    }

    /// Stiffness of the enclosed oil, `4 beta A^2 / V` (N/m).
    ///
    /// ```
    /// # use std::path::Path;
    /// # use scenario::rig::{Drive, RigFile};
    /// # use scenario::source::Source;
    /// let text = "kind = \"servo\"";
    /// let rig: RigFile = Source::from_text(Path::new("rig.toml"), text).parse()?;
    /// let rig = rig.build(&Source::from_text(Path::new("rig.toml"), text))?;
    /// let Drive::Servo(servo) = &rig.drive else { panic!("a servo rig") };
    /// assert!((servo.oil_stiffness_n_per_m() - 50e6).abs() < 1.0);
    /// # Ok::<(), scenario::ScenarioError>(())
    /// ```
    pub fn oil_stiffness_n_per_m(&self) -> f64 {
        4.0 * self.bulk_modulus_pa * self.area_m2 * self.area_m2 / self.oil_volume_m3
    }

    /// Upper bounds of the frequencies of the moving parts, each with both of its springs (Hz).
    fn fastest_hz(&self, around: Around<'_>) -> [(&'static str, f64); 2] {
        let hz = |stiffness_n_per_m: f64, mass_kg: f64| {
            (stiffness_n_per_m / mass_kg).sqrt() / std::f64::consts::TAU
        };
        let fixture_n_per_m = around.fixture_n_per_m;
        let against_ram = 1.0 + self.end_mass_kg / self.ram_mass_kg;
        [
            ("the ram", hz(self.oil_stiffness_n_per_m() + fixture_n_per_m, self.ram_mass_kg)),
            (
                "the end mass",
                hz(fixture_n_per_m * against_ram + around.mounted_n_per_m, self.end_mass_kg),
            ),
        ]
    }
}
