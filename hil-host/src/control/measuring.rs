//! What is measured between the fades and judged once, before a force acts: the delay of every rig,
//! as the gate asks, and how far its damper is off the model that wear in software relies on.

use super::cycle::Inputs;
use super::delay_gate::{COST_REFUSED, DelayGate, SETTLING_S};
use super::session::{Session, SessionState};
use firmware_core::compensation::delay_that_costs;
use firmware_core::line::{Sensitivity, Slot};
use firmware_core::supervision::{Action, Cause, Signal, State};
use firmware_core::virtual_wear::{FORCE_ERROR_MAX, LOOP_GAIN_MAX};

impl Session<'_> {
    /// Measures the delay of every rig between the fades, and judges it once.
    pub(super) fn measure_delay(&self, state: &mut SessionState, inputs: &Inputs) {
        if state.line.run_cycles() == 1 {
            // What is found from here on is that of RUN.
            state.line.slots.iter_mut().for_each(|slot| slot.wear.clear());
        }
        let Some(gate) = &self.delay_gate else { return };
        let fade = state.line.fade;
        let begin = u64::from(fade.motion_cycles);
        let end = begin + u64::from(fade.measuring_cycles);
        let cycle = state.line.cycle;
        if state.line.state != State::RampIn || state.gate.is_judged || cycle <= begin {
            return;
        }
        let settled = begin + self.cycles(SETTLING_S);
        if cycle == settled {
            state.line.slots.iter_mut().for_each(|slot| slot.wear.clear());
        }
        if cycle > settled {
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
            self.judge_wear(state);
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

    fn judge_wear(&self, state: &mut SessionState) {
        for port in &self.ports {
            let Slot::Rig(rig) = &self.line.slots[port.slot] else { continue };
            let Some(wear) = &rig.wear else { continue };
            let found = state.line.slots[port.slot].wear.found(wear);
            state.gate.wear[port.slot] = found;
            let Some(found) = found else { continue };
            let causes = [
                (Signal::WearLoopGain, found.loop_gain, LOOP_GAIN_MAX),
                (Signal::WearForceError, found.force_error, FORCE_ERROR_MAX),
            ];
            let beyond = causes.into_iter().find(|(_, value, limit)| value > limit);
            if let Some((signal, value, limit)) = beyond {
                let cause = Cause { signal, value, limit, action: Action::RampOut };
                self.stop(state, Some(port.node.number()), cause, Action::RampOut);
            }
        }
    }

    /// What the damper of a slot makes of a delay, by the slot's model.
    fn sensitivity(&self, slot: usize, gate: &DelayGate) -> Option<Sensitivity> {
        let Some(Slot::Rig(rig)) = self.line.slots.get(slot) else { return None };
        Some(Sensitivity::of(&rig.model, gate.hunting_hz))
    }
}
