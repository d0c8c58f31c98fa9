//! From the vehicle's motion between the eyes of a damper to the command for its rig.
//!
//! ```text
//! extension -> wear -> fade -> wanted -> compensator -> limits -> command
//! ```
//! Wear looks ahead by whole cycles, and the compensator acts on what it sees there; what is wanted
//! now is what was seen so many cycles ago.

use super::fade::Fade;
use super::slot::{RigSlot, SlotState};
use crate::command::Command;
use crate::compensation::{Answer, Compensator};
use crate::damper::DamperState;
use crate::guard::ForceInput;
use crate::supervision::{Ramp, State};
use crate::virtual_wear::Reading;

impl SlotState {
    /// A ram in the middle of its stroke that is coupled from the first cycle on.
    pub fn coupled(rig: &RigSlot<'_>) -> Self {
        let mut state = Self {
            limits: rig.limits,
            compensator: rig.compensator.start(),
            damper: DamperState::rest(),
            ..Self::default()
        };
        state.begin(0.0);
        (state.motion, state.coupling) = (Ramp::FULL, Ramp::FULL);
        state
    }

    /// The command to a coupled rig for the vehicle's motion between the eyes.
    pub fn follow(
        &mut self,
        rig: &RigSlot<'_>,
        vehicle: Command,
        arrived: (ForceInput, Option<Answer>),
        cycle_s: f64,
    ) -> Command {
        debug_assert!(self.motion.is_full() && self.coupling.is_full(), "a rig that is coupled");
        self.take_motion(rig, vehicle, arrived, (Fade::default(), State::Run), cycle_s);
        self.command
    }

    /// From the vehicle's motion between the eyes to the command: wear, fade, compensator, limits.
    pub(super) fn take_motion(
        &mut self,
        rig: &RigSlot<'_>,
        vehicle: Command,
        (input, answer): (ForceInput, Option<Answer>),
        (fade, phase): (Fade, State),
        cycle_s: f64,
    ) {
        let ahead = match &rig.wear {
            None => {
                self.wanted = self.faded(vehicle, (fade, phase), cycle_s);
                self.wanted
            }
            Some(wear) => {
                let reading = self.reading(input, answer);
                let damper = wear.step(&mut self.wear, vehicle, reading, cycle_s);
                let ahead = self.faded(damper, (fade, phase), cycle_s);
                self.wanted = self.ahead.take(ahead, wear.ahead_cycles);
                ahead
            }
        };
        let compensated = if rig.compensator == Compensator::None {
            ahead
        } else {
            self.compensated(&rig.compensator, ahead, answer, (fade, phase), cycle_s)
        };
        let limited = self.limits.limited(self.command, compensated, cycle_s);
        self.limited += u64::from(limited.is_saturated);
        self.demand = self.demand.larger(limited.demand);
        self.command = limited.command;
        self.compensator.sent(self.command);
    }

    /// What the rig measured at one instant, if it has arrived and its force is believed.
    fn reading(&self, input: ForceInput, answer: Option<Answer>) -> Option<Reading> {
        let (ForceInput::Fresh(force_n), Some(answer)) = (input, answer) else { return None };
        let reading = Reading { displacement_m: answer.displacement_m, force_n };
        self.is_force_believed.then_some(reading)
    }
}
