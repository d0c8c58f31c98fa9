//! The gate before RUN: what the delay of a rig costs, measured before its force acts.
//!
//! ```text
//! RAMP_IN:  motion faded in | delay measured | force faded in | RUN
//! ```
//! Between the fades the ram moves with the vehicle and the model's force acts. The first second
//! is for the compensator to settle; the blocks behind it give the delay with its interval
//! ([`DelayBlocks`]). Where the worse end of it costs more than [`COST_REFUSED`] of the damping at
//! the hunting frequency the session ramps out before the measured force has acted, unless the slot
//! accepts that. A slot whose motion is too small to measure passes: nothing is known of it, and
//! the summary says so.

use super::cycle::Inputs;
use super::session::{Session, SessionState};
use crate::residual_delay::{BLOCK_CYCLES, DelayBlocks, FEWEST_BLOCKS, Sensitivity};
use firmware_core::compensation::delay_that_costs;
use firmware_core::line::Slot;
use firmware_core::supervision::{Action, Cause, Signal, State};
use firmware_core::vehicle::DAMPER_SLOTS;
use scenario::run::MEASURING_CYCLES;

/// Share of the damping from which on a run is warned of.
pub const COST_WARNED: f64 = 0.02;
/// Share of the damping from which on it is refused.
pub const COST_REFUSED: f64 = 0.05;

/// Cycles before the blocks: a compensator settles.
const SETTLING_CYCLES: u32 = BLOCK_CYCLES;

// One block more than an interval needs.
const _: () = assert!(MEASURING_CYCLES == SETTLING_CYCLES + (FEWEST_BLOCKS + 1) * BLOCK_CYCLES);

/// Parameters of the gate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DelayGate {
    /// The hunting frequency, Hz.
    pub hunting_hz: f64,
    /// Slots whose cost is accepted whatever it is.
    pub accepted: [bool; DAMPER_SLOTS],
}

/// What the gate has measured.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DelayGateState {
    /// The delays by slot.
    pub delays: [DelayBlocks; DAMPER_SLOTS],
    is_judged: bool,
}

impl Session<'_> {
    /// Measures the delay of every rig between the fades, and judges it once.
    pub(super) fn measure_delay(&self, state: &mut SessionState, inputs: &Inputs) {
        let Some(gate) = &self.delay_gate else { return };
        let fade = state.line.fade;
        let begin = u64::from(fade.motion_cycles);
        let end = begin + u64::from(fade.measuring_cycles);
        let cycle = state.line.cycle;
        if state.line.state != State::RampIn || state.gate.is_judged || cycle <= begin {
            return;
        }
        if cycle > begin + u64::from(SETTLING_CYCLES) {
            for port in &self.ports {
                let answer = inputs.answer[port.slot];
                let measured_m = answer.map_or(f64::NAN, |answer| answer.displacement_m);
                let wanted_m = state.line.slots[port.slot].wanted.displacement_m;
                state.gate.delays[port.slot].take(wanted_m, measured_m);
            }
        }
        if cycle >= end {
            state.gate.is_judged = true;
            self.judge_delay(state, gate);
        }
    }

    fn judge_delay(&self, state: &mut SessionState, gate: &DelayGate) {
        for port in &self.ports {
            let found = state.gate.delays[port.slot].residual();
            let (Some(delay), Some(sensitivity)) = (found, self.sensitivity(port.slot, gate))
            else {
                continue;
            };
            if gate.accepted[port.slot] || delay.worst_cost(sensitivity) <= COST_REFUSED {
                continue;
            }
            let value = delay.worst_s(sensitivity);
            let Sensitivity { frequency_hz, relaxation_s } = sensitivity;
            let share = COST_REFUSED.copysign(value);
            let limit = delay_that_costs(share, frequency_hz, relaxation_s);
            let action = Action::RampOut;
            let cause = Cause { signal: Signal::Delay, value, limit, action };
            self.stop(state, Some(port.node.number()), cause, action);
        }
    }

    /// What the damper of a slot makes of a delay, by the slot's model.
    fn sensitivity(&self, slot: usize, gate: &DelayGate) -> Option<Sensitivity> {
        let Some(Slot::Rig(rig)) = self.line.slots.get(slot) else { return None };
        Some(Sensitivity::of(&rig.model, gate.hunting_hz))
    }
}
