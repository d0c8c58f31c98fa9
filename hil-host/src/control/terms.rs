//! What a host brings into the arming exchange: its numbers, and what it requires of a rig.

use crate::draw::Draw;
use can_protocol::arming::Requirements;
use scenario::run::Readiness;
use std::time::Duration;

/// What a host brings into the exchange.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arming {
    /// Its number of this session.
    pub number: u32,
    /// The number that it drew when it started.
    pub boot: u32,
    /// What it requires of a rig.
    pub requirements: Requirements,
    /// Real time of a cycle without commands; zero where rigs are in memory.
    pub cycle: Duration,
    /// Whether a rig with tighter limits of motion is refused, and does not rule.
    pub needs_what_it_asks: bool,
}

impl Arming {
    /// With rigs in memory: always the same numbers, no key switch, no time.
    pub fn in_memory() -> Self {
        Self::with(Draw::seeded(0, 0), required(&Readiness::default(), false), Duration::ZERO)
    }

    /// With rigs on a real bus: numbers that nobody can foresee, and a key switch.
    pub fn on_a_bus(draw: Draw, cycle: Duration) -> Self {
        Self::with(draw, required(&Readiness::default(), true), cycle)
    }

    /// The same, with the readiness that a scenario asks for.
    #[must_use]
    pub fn requiring(self, readiness: &Readiness) -> Self {
        Self { requirements: required(readiness, self.requirements.enabled), ..self }
    }

    fn with(mut draw: Draw, requirements: Requirements, cycle: Duration) -> Self {
        let (number, boot) = (draw.number(), draw.number());
        Self { number, boot, requirements, cycle, needs_what_it_asks: false }
    }
}

/// Readiness in the units of the exchange.
fn required(readiness: &Readiness, enabled: bool) -> Requirements {
    Requirements {
        enabled,
        zero_age_s: readiness.zero_age_s as u32,
        shunt_passed: readiness.shunt_check,
        force_at_rest_n: readiness.force_at_rest_n as u32,
        stroke_um: (readiness.stroke_left_m * 1e6).round() as u32,
    }
}
