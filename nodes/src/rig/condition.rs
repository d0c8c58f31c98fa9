//! What a rig knows of itself besides its motion, and answers before it is armed.

use can_protocol::arming::{Limits, Readiness, Requirements};

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
    /// A rig that is ready, with these limits of its own.
    pub const fn ready(limits: Limits) -> Self {
        Self { enabled: true, zero_age_s: Some(0), shunt_passed: true, may_reset: true, limits }
    }

    /// A rig that is ready, whose own limits are the stroke (m) and the speed (m/s) of its ram;
    /// neither its acceleration nor its force has one.
    pub(super) fn of_ram(stroke_m: f64, rate_m_per_s: f64) -> Self {
        let micro = |value: f64| libm::round(value * 1e6) as u32;
        Self::ready(Limits {
            stroke_um: micro(stroke_m),
            velocity_um_per_s: micro(rate_m_per_s),
            acceleration_mm_per_s2: u32::MAX,
            force_n: u32::MAX,
        })
    }

    /// What the rig answers: its ram stands at `ram_m` of a stroke to either side, under a force.
    pub(super) fn readiness(
        &self,
        boot: u32,
        (stroke_m, ram_m): (f64, f64),
        force_n: f64,
    ) -> Readiness {
        let micro = |value: f64| (value * 1e6).max(0.0) as u32;
        let force_n = force_n.abs();
        Readiness {
            boot,
            enabled: self.enabled,
            zero_age_s: self.zero_age_s,
            shunt_passed: self.shunt_passed,
            force_at_rest_n: force_n.is_finite().then_some(libm::round(force_n) as u32),
            stroke_out_um: micro(stroke_m - ram_m),
            stroke_in_um: micro(stroke_m + ram_m),
        }
    }

    /// What a rig requires of itself: its key switch, whatever the host asks for.
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
