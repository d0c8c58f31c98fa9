//! What is mounted between the eyes of an emulated rig, and what its sensors show.
//!
//! ```toml
//! mounted = "damper"               # "bar", "nothing", or "load": what a calibration needs
//! bar_n_per_m = 1e9                # stiffness of the bar
//! load_n = 0.0                     # a load that hangs on the load cell, tension positive
//!
//! [sensors]
//! displacement = "eyes"            # or "ram": then the fixture is part of the displacement
//! force_skew_s = 0.0               # how late the force is against the displacement
//! force_gain = 1.0                 # reading = gain * force + offset
//! force_offset_n = 0.0
//! ```
//! The bar is a spring without mass and damping: `F = k (x - x_0)`, unloaded where the ram stood
//! when the rig was started. Steel of 60 mm and 0.6 m, `E A / L`, is the default. The skew is a
//! pure delay; between two cycles the force is interpolated.

use crate::error::ScenarioError;
use crate::quantity::Quantity;
use crate::source::Source;
use serde::{Deserialize, Serialize};

/// Longest skew of the force (s).
pub const FORCE_SKEW_MAX_S: f64 = 8e-3;

/// Stiffness of a bar without `bar_n_per_m` (N/m).
pub const BAR_N_PER_M: f64 = 1e9;

/// The kinds of what may be mounted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MountedKind {
    /// The damper of the file.
    #[default]
    Damper,
    /// A rigid bar.
    Bar,
    /// Nothing: the load cell shows the inertia of what is fixed to it.
    Nothing,
    /// A constant load.
    Load,
}

/// What is mounted.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Mounted {
    /// The damper of the rig.
    #[default]
    Damper,
    /// A rigid bar.
    Bar {
        /// Its stiffness (N/m).
        stiffness_n_per_m: f64,
    },
    /// A constant load, zero where nothing is mounted.
    Load {
        /// Tension positive (N).
        force_n: f64,
    },
}

/// The sensors as they stand in the file.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SensorsFile {
    /// Where the displacement is measured.
    pub displacement: Option<DisplacementSensor>,
    /// How late the force is against the displacement.
    pub force_skew_s: Option<Quantity>,
    /// Reading over force.
    pub force_gain: Option<Quantity>,
    /// Reading without force.
    pub force_offset_n: Option<Quantity>,
}

/// Where the displacement is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DisplacementSensor {
    /// Across the eyes of the damper.
    #[default]
    Eyes,
    /// At the ram.
    Ram,
}

/// The sensors, ready to be emulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorSetup {
    /// Where the displacement is measured.
    pub displacement: DisplacementSensor,
    /// How late the force is against the displacement (s).
    pub force_skew_s: f64,
    /// Reading over force.
    pub force_gain: f64,
    /// Reading without force (N).
    pub force_offset_n: f64,
}

impl Default for SensorSetup {
    fn default() -> Self {
        let displacement = DisplacementSensor::Eyes;
        Self { displacement, force_skew_s: 0.0, force_gain: 1.0, force_offset_n: 0.0 }
    }
}

impl Mounted {
    /// What is mounted by these keys of a file.
    ///
    /// # Errors
    /// A number that does not fit, or that means nothing to what is mounted.
    pub(crate) fn of(
        kind: Option<MountedKind>,
        (bar_n_per_m, load_n): (Option<&Quantity>, Option<&Quantity>),
        source: &Source,
    ) -> Result<Self, ScenarioError> {
        let kind = kind.unwrap_or_default();
        let foreign = [
            ("bar_n_per_m", bar_n_per_m, kind == MountedKind::Bar, "bar"),
            ("load_n", load_n, kind == MountedKind::Load, "load"),
        ];
        for (key, given, has_meaning, needed) in foreign {
            if let (Some(given), false) = (given, has_meaning) {
                let message = format!("{key} means nothing without mounted = \"{needed}\"");
                return Err(given.error(source, message));
            }
        }
        Ok(match kind {
            MountedKind::Damper => Self::Damper,
            MountedKind::Nothing => Self::Load { force_n: 0.0 },
            MountedKind::Bar => Self::Bar {
                stiffness_n_per_m: Quantity::within_or(
                    bar_n_per_m,
                    source,
                    "bar_n_per_m",
                    (1e6, 1e10, "N/m"),
                    BAR_N_PER_M,
                )?,
            },
            MountedKind::Load => Self::Load {
                force_n: Quantity::within_or(load_n, source, "load_n", (-1e5, 1e5, "N"), 0.0)?,
            },
        })
    }
}

impl SensorsFile {
    /// Builds the sensors.
    ///
    /// # Errors
    /// The first number that does not fit, with file and line.
    pub(crate) fn build(&self, source: &Source) -> Result<SensorSetup, ScenarioError> {
        let usual = SensorSetup::default();
        let within = |given: &Option<Quantity>, key, bounds, default| {
            Quantity::within_or(given.as_ref(), source, key, bounds, default)
        };
        Ok(SensorSetup {
            displacement: self.displacement.unwrap_or_default(),
            force_skew_s: within(
                &self.force_skew_s,
                "force_skew_s",
                (0.0, FORCE_SKEW_MAX_S, "s"),
                usual.force_skew_s,
            )?,
            force_gain: within(&self.force_gain, "force_gain", (0.5, 2.0, ""), usual.force_gain)?,
            force_offset_n: within(
                &self.force_offset_n,
                "force_offset_n",
                (-1e5, 1e5, "N"),
                usual.force_offset_n,
            )?,
        })
    }
}
