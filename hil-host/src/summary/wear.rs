//! Wear in software before a damper on a rig.

use crate::control::SessionState;
use firmware_core::line::{Line, Slot};
use firmware_core::virtual_wear::{FORCE_ERROR_MAX, LOOP_GAIN_MAX};
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
    /// Travel in which a contact at the fastest motion of the vehicle was rounded (m).
    pub rounding_m: f64,
    /// Gain of the loop over the mismatch before RUN; null where it was not judged.
    pub loop_gain: Option<f64>,
    /// What the force would be off, over the force of the healthy damper, before RUN; null where it
    /// was not judged.
    pub force_error: Option<f64>,
    /// Gain of the loop in RUN; null where there was no RUN.
    pub run_loop_gain: Option<f64>,
    /// What the force was off in RUN.
    pub run_force_error: Option<f64>,
}

impl WearSummary {
    /// That of a slot; none without.
    pub(crate) fn of(line: &Line<'_>, state: &SessionState, slot: usize) -> Option<Self> {
        let Slot::Rig(rig) = line.slots.get(slot)? else { return None };
        let (wear, found) = (rig.wear.as_ref()?, state.gate.wear.get(slot)?);
        let memory = &state.line.slots.get(slot)?.wear;
        let in_run = memory.found(wear).filter(|_| state.line.run_cycles() > 0);
        let has_contacts = wear.clearance_2a_m > 0.0;
        Some(Self {
            clearance_2a_m: wear.clearance_2a_m,
            compliance_m_per_n: wear.compliance_m_per_n,
            ahead_cycles: wear.ahead_cycles,
            rounding_m: if has_contacts {
                wear.rounding_m(memory.fastest_m_per_s(), line.cycle_s)
            } else {
                0.0
            },
            loop_gain: found.map(|found| found.loop_gain),
            force_error: found.map(|found| found.force_error),
            run_loop_gain: in_run.map(|found| found.loop_gain),
            run_force_error: in_run.map(|found| found.force_error),
        })
    }

    /// What was found of it, in words; none where there was nothing.
    pub fn in_words(&self) -> Option<String> {
        let of = |error: f64, gain: f64| {
            format!("the force is {:.2} % off, loop gain {gain:.2}", 100.0 * error)
        };
        let before = self.force_error.zip(self.loop_gain);
        let in_run = self.run_force_error.zip(self.run_loop_gain);
        let found =
            [("before RUN", before), ("in RUN", in_run)].into_iter().filter_map(|(when, found)| {
                found.map(|(error, gain)| format!("{when} {}", of(error, gain)))
            });
        let found: Vec<String> = found.collect();
        (!found.is_empty()).then(|| {
            format!(
                "wear in software, {} cycles ahead, contacts rounded over {:.2} mm: {}",
                self.ahead_cycles,
                1e3 * self.rounding_m,
                found.join("; ")
            )
        })
    }

    /// What to be warned of: in RUN the force was beyond what the gate before it lets through.
    pub fn warning(&self) -> Option<String> {
        let (error, gain) = self.run_force_error.zip(self.run_loop_gain)?;
        let is_beyond = error > FORCE_ERROR_MAX || gain > LOOP_GAIN_MAX;
        is_beyond.then(|| {
            format!(
                "wear in software: in RUN the force was {:.1} % off, expected at most {:.1} %, and \
                 the loop gain {gain:.2}, expected at most {LOOP_GAIN_MAX}",
                100.0 * error,
                100.0 * FORCE_ERROR_MAX
            )
        })
    }
}
