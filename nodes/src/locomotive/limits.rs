//! The limits of a session: what the host asks for, what it needs, and what was agreed.

use can_protocol::arming::Limits;
use firmware_core::supervision::CommandLimits;

/// Limits below which no run makes sense, unless it asks for less itself.
const LEAST: Limits = Limits {
    stroke_um: 5000,
    velocity_um_per_s: 50_000,
    acceleration_mm_per_s2: 1000,
    force_n: 1000,
};

/// The limits that a host asks for: those of its commands, and the largest force that it believes
/// (N). A conversion saturates: no limit is the largest number.
pub fn asked(limits: &CommandLimits, force_n: f64) -> Limits {
    Limits {
        stroke_um: libm::round(limits.stroke_m * 1e6) as u32,
        velocity_um_per_s: libm::round(limits.velocity_m_per_s * 1e6) as u32,
        acceleration_mm_per_s2: libm::round(limits.acceleration_m_per_s2 * 1e3) as u32,
        force_n: libm::round(force_n) as u32,
    }
}

/// The least limits with which a host that asks for these can do its work.
pub fn needed(asked: Limits) -> Limits {
    LEAST.tighter(asked)
}

/// The agreed limits that are tighter than those that were asked for.
pub fn tighter(agreed: Limits, asked: Limits) -> CommandLimits {
    let limit = |agreed: u32, asked: u32, per_unit: f64| {
        if agreed < asked { f64::from(agreed) / per_unit } else { f64::INFINITY }
    };
    CommandLimits {
        stroke_m: limit(agreed.stroke_um, asked.stroke_um, 1e6),
        velocity_m_per_s: limit(agreed.velocity_um_per_s, asked.velocity_um_per_s, 1e6),
        acceleration_m_per_s2: limit(
            agreed.acceleration_mm_per_s2,
            asked.acceleration_mm_per_s2,
            1e3,
        ),
    }
}
