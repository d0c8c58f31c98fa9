//! What every kind of rig has: a ram, a load cell, and a damper between two eyes.

use firmware_core::damper::{DamperState, Motion};
use nodes::rig::RamState;

/// The mechanics of a rig at an instant, without noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mechanics {
    /// The ram.
    pub(crate) ram: RamState,
    /// Displacement across the eyes of the damper (m).
    pub(crate) eyes_m: f64,
    /// Force of the damper (N).
    pub(crate) force_n: f64,
    /// Force that the load cell feels (N).
    pub(crate) load_cell_n: f64,
    /// What is between the eyes.
    pub(crate) mounting: Mounting,
}

/// What is remembered of what is mounted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mounting {
    /// Displacement of the eyes at which it was mounted (m).
    pub(crate) at_m: f64,
    /// The damper.
    pub(crate) damper: DamperState,
}

impl Mechanics {
    /// Everything at rest and without force, the ram and the eyes at a displacement (m).
    pub(crate) fn resting_at(ram_m: f64) -> Self {
        Self {
            ram: RamState { displacement_m: ram_m, ..RamState::default() },
            eyes_m: ram_m,
            force_n: 0.0,
            load_cell_n: 0.0,
            mounting: Mounting {
                at_m: ram_m,
                damper: DamperState::starting(Motion::new(ram_m, 0.0)),
            },
        }
    }
}
