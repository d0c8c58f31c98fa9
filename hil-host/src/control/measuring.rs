//! The delay of every rig, measured between the fades and judged once, as the gate before RUN asks.

use super::cycle::Inputs;
use super::delay_gate::{COST_REFUSED, DelayGate, SETTLING_CYCLES};
use super::session::{Session, SessionState};
use firmware_core::compensation::delay_that_costs;
use firmware_core::line::{Sensitivity, Slot};
use firmware_core::supervision::{Action, Cause, Signal, State};

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
                state.gate.delays[port.slot].take(wanted_m, measured_m, self.line.cycle_s);
            }
        }
        if cycle >= end {
            state.gate.is_judged = true;
            self.judge_delay(state, gate);
        }
    }

    fn judge_delay(&self, state: &mut SessionState, gate: &DelayGate) {
        for port in &self.ports {
            let found = state.gate.delays[port.slot].residual(self.line.cycle_s);
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
