//! What a host brings into the arming exchange: its numbers, and what it requires of a rig.

use crate::draw::Draw;
use can_protocol::arming::Requirements;
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
}

impl Arming {
    /// With rigs in memory: always the same numbers, no key switch, no time.
    pub fn in_memory() -> Self {
        let requirements = Requirements { enabled: false, ..REQUIRED };
        Self::with(Draw::seeded(0, 0), requirements, Duration::ZERO)
    }

    /// With rigs on a real bus: numbers that nobody can foresee, and a key switch.
    pub fn on_a_bus(draw: Draw, cycle: Duration) -> Self {
        Self::with(draw, REQUIRED, cycle)
    }

    fn with(mut draw: Draw, requirements: Requirements, cycle: Duration) -> Self {
        Self { number: draw.number(), boot: draw.number(), requirements, cycle }
    }
}

/// Readiness that a host requires of every rig: a zero of this shift, a force at rest that a gas
/// preload explains, and way to move.
const REQUIRED: Requirements = Requirements {
    enabled: true,
    zero_age_s: 8 * 3600,
    shunt_passed: true,
    force_at_rest_n: 2000,
    stroke_um: 5000,
};
