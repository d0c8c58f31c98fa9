//! Wear in software before a damper on a rig.

use crate::control::SessionState;
use firmware_core::line::{Line, Slot};
use scenario::run::CYCLE_S;
use serde::Serialize;

/// Wear in software, and what the ramp-in found of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WearSummary {
    /// Clearance that is added (m).
    pub clearance_2a_m: f64,
    /// Compliance that is added (m/N).
    pub compliance_m_per_n: f64,
    /// Cycles by which the motion is computed ahead.
    pub ahead_cycles: u8,
    /// Travel in which the fastest contact was rounded (m).
    pub rounding_m: f64,
    /// Gain of the loop over the mismatch; null where it was not judged.
    pub loop_gain: Option<f64>,
    /// Error of the force that the mismatch makes, over the force of the healthy damper.
    pub force_error: Option<f64>,
}

impl WearSummary {
    /// That of a slot; none without.
    pub(crate) fn of(line: &Line<'_>, state: &SessionState, slot: usize) -> Option<Self> {
        let Slot::Rig(rig) = line.slots.get(slot)? else { return None };
        let (wear, found) = (rig.wear.as_ref()?, state.gate.wear.get(slot)?);
        let fastest = state.line.slots.get(slot)?.demand.velocity_m_per_s;
        let has_contacts = wear.clearance_2a_m > 0.0;
        Some(Self {
            clearance_2a_m: wear.clearance_2a_m,
            compliance_m_per_n: wear.compliance_m_per_n,
            ahead_cycles: wear.ahead_cycles,
            rounding_m: if has_contacts { wear.rounding_m(fastest, CYCLE_S) } else { 0.0 },
            loop_gain: found.map(|found| found.loop_gain),
            force_error: found.map(|found| found.force_error),
        })
    }
}
