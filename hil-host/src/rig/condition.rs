//! What a rig knows of itself besides its motion, and answers before it is armed.

use super::{Emulator, EmulatorState};
use can_protocol::arming::{Limits, Readiness, Requirements};
use scenario::rig::{Mounted, RigSetup};

/// What an emulated rig agrees to with a bar between its eyes (um): no host that needs more arms
/// it.
const BAR_STROKE_UM: u32 = 100;

/// The condition of a rig. An emulated one is ready; a test may make it anything.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Condition {
    /// The key switch enables motion.
    pub enabled: bool,
    /// Age of the load cell's zero (s).
    pub zero_age_s: Option<u32>,
    /// The shunt check of the load cell passed.
    pub shunt_passed: bool,
    /// A latched rig may be reset over the bus.
    pub may_reset: bool,
    /// Its own limits.
    pub limits: Limits,
}

impl Condition {
    /// That of an emulated rig: ready, limited by its ram, or by the bar that is mounted.
    pub(super) fn of(setup: &RigSetup) -> Self {
        let micro = |value: f64| (value * 1e6).round() as u32;
        Self {
            enabled: true,
            zero_age_s: Some(0),
            shunt_passed: true,
            may_reset: true,
            limits: Limits {
                stroke_um: match setup.mounted {
                    Mounted::Bar { .. } => BAR_STROKE_UM,
                    Mounted::Damper | Mounted::Load { .. } => micro(setup.stroke_m),
                },
                velocity_um_per_s: micro(setup.rate_m_per_s),
                // Neither has a limit of its own here.
                acceleration_mm_per_s2: u32::MAX,
                force_n: u32::MAX,
            },
        }
    }

    /// What the rig answers, with its ram and its damper as they are.
    pub(super) fn readiness(
        &self,
        boot: u32,
        emulator: &Emulator,
        state: &EmulatorState,
    ) -> Readiness {
        let micro = |value: f64| (value * 1e6).max(0.0) as u32;
        let (stroke_m, ram_m) = (emulator.stroke_m(), state.ram().displacement_m);
        let force_n = state.force_n().abs();
        Readiness {
            boot,
            enabled: self.enabled,
            zero_age_s: self.zero_age_s,
            shunt_passed: self.shunt_passed,
            force_at_rest_n: force_n.is_finite().then_some(force_n.round() as u32),
            stroke_out_um: micro(stroke_m - ram_m),
            stroke_in_um: micro(stroke_m + ram_m),
        }
    }

    /// What an emulated rig requires of itself: its key switch, whatever the host asks for.
    pub(super) const fn requirements() -> Requirements {
        Requirements {
            enabled: true,
            zero_age_s: u32::MAX - 1,
            shunt_passed: false,
            force_at_rest_n: u32::MAX - 1,
            stroke_um: 0,
        }
    }
}
