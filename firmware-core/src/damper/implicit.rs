//! Implicit steps: the fallback, and the coupling of attachments that creep.
//!
//! **Backward Euler** on a piecewise-linear law has a closed form: the left side of
//! e1 + h v(e1) = e0 + h V rises with e1, so the segment that holds the solution is found by
//! walking the knots. It is unconditionally stable, first order, works with a hard cap and with no
//! clearance, and cannot fail.
//!
//! **Creep.** A viscoelastic attachment adds a deflection d that follows the force with a memory of
//! its own. Over a step its end value is a rising line in the force at the end, d1 = c0 + c1 F1,
//! exact for a force that is linear in the step. The chain sees it as a change D = (d1 - d0)/h of
//! its driving velocity, so that F1 is the root of
//!
//! ```text
//! chain(V - (c0 + c1 F1 - d0)/h) - F1 = 0
//! ```
//!
//! which falls with slope -1 or steeper: one root, bracketed by any guess and its answer. Newton's
//! step from the slope of the last segment finds it at once while no knot is crossed. Second order,
//! and for a fast creep d1 is F1 times its compliance with no memory left: L-stable. Knots of the
//! law stay exact.

use super::law::{Law, Segments};
use super::series::{Arrival, Drive, Stand, advance};

/// Most evaluations of the chain in one coupled step.
pub const MAX_COUPLING: u32 = 12;

/// End deflection of one backward Euler step with the driving velocity at its end.
pub fn backward_euler(
    segments: &Segments,
    start_m: f64,
    velocity_m_per_s: f64,
    step_s: f64,
) -> f64 {
    let aim = start_m + step_s * velocity_m_per_s;
    for segment in segments {
        if aim > segment.to_m + step_s * segment.velocity_to {
            continue;
        }
        if aim < segment.from_m + step_s * segment.velocity_from {
            return segment.from_m;
        }
        let anchor = &segment.anchor;
        let beyond = aim - anchor.deflection_m - step_s * anchor.velocity_m_per_s;
        return anchor.deflection_m + beyond / (1.0 + step_s * segment.rate_per_s);
    }
    segments.last().map_or(aim, |last| last.to_m)
}

/// Creep of the whole attachment over one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Creep {
    /// Creep at the beginning, m.
    pub start_m: f64,
    /// Creep at the end if the force ends at zero, m.
    pub end_without_force_m: f64,
    /// Further creep at the end per force at the end, m/N, zero or more.
    pub compliance_m_per_n: f64,
}

impl Creep {
    /// None.
    pub const NONE: Self = Self { start_m: 0.0, end_without_force_m: 0.0, compliance_m_per_n: 0.0 };

    /// Parts in series creep together.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            start_m: self.start_m + other.start_m,
            end_without_force_m: self.end_without_force_m + other.end_without_force_m,
            compliance_m_per_n: self.compliance_m_per_n + other.compliance_m_per_n,
        }
    }

    /// Creep at the end of the step, m.
    pub fn end_m(&self, force_n: f64) -> f64 {
        self.end_without_force_m + self.compliance_m_per_n * force_n
    }
}

/// Moves a chain whose attachment creeps through one step. `guess_n` is any force near the end's.
pub fn advance_with_creep(
    law: &Law,
    stand: Stand,
    drive: Drive,
    step_s: f64,
    creep: Creep,
    guess_n: f64,
) -> Arrival {
    let per_step = 1.0 / step_s;
    let mut force_n = guess_n;
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut arrival = advance(law, stand, drive, 0.0);
    for _ in 0..MAX_COUPLING {
        let rate = (creep.end_m(force_n) - creep.start_m) * per_step;
        let velocity_m_per_s = drive.velocity_m_per_s - rate;
        arrival = advance(law, stand, Drive { velocity_m_per_s, ..drive }, step_s);
        let miss = arrival.force_n - force_n;
        if miss.abs() <= 1e-9 * arrival.force_n.abs().max(force_n.abs()) {
            break;
        }
        if miss > 0.0 {
            low = low.max(force_n);
            high = high.min(arrival.force_n);
        } else {
            high = high.min(force_n);
            low = low.max(arrival.force_n);
        }
        let slope = 1.0 + arrival.sensitivity_n_s_per_m * creep.compliance_m_per_n * per_step;
        let newton = force_n + miss / slope;
        force_n = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
    }
    arrival
}
