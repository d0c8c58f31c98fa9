//! Open loop: rigs follow a motion of their own, and no force reaches the vehicle, which stands.
//!
//! ```text
//! prescribed motion -> limits -> commands
//! ```
//! It is what a laboratory begins with: warm-up, sines, triangles, the measurement of the delay.
//! The end is orderly where the rams come to rest ([`State::RampOut`]), wherever they are then.

use super::{Line, LineState, Slot};
use crate::command::Command;
use crate::supervision::{Event, Outcome, Ramp, State};
use crate::vehicle::DAMPER_SLOTS;

impl Line<'_> {
    /// Begins an open loop of an armed line, whose rams stand at these displacements (m, by slot).
    pub fn open(&self, state: &mut LineState, rams_m: [f64; DAMPER_SLOTS]) {
        for ((slot, memory), ram_m) in self.slots.iter().zip(&mut state.slots).zip(rams_m) {
            let Slot::Rig(_) = slot else { continue };
            memory.begin(ram_m);
        }
        let outcome = state.on(Event::StartOpenLoop);
        debug_assert!(outcome == Outcome::Enters(State::OpenLoop), "opened without being armed");
    }

    /// One cycle of an open loop: leaves the commands in the slots. What is wanted counts in
    /// [`State::OpenLoop`] alone; in every other state the rams come to rest.
    pub fn follow(&self, state: &mut LineState, wanted: &[Command; DAMPER_SLOTS]) {
        debug_assert!(state.state != State::Run && state.state != State::RampIn, "a coupled line");
        state.cycle += 1;
        let is_open = state.state == State::OpenLoop;
        for ((slot, memory), wanted) in self.slots.iter().zip(&mut state.slots).zip(wanted) {
            let Slot::Rig(_) = slot else { continue };
            if is_open && wanted.is_finite() {
                let limited = memory.limits.limited(memory.command, *wanted, self.cycle_s);
                memory.limited += u64::from(limited.is_saturated);
                memory.command = limited.command;
            } else {
                let most = memory.limits.acceleration_m_per_s2;
                memory.command = memory.command.stopping(self.cycle_s, most);
            }
            debug_assert!(memory.motion == Ramp::default(), "no motion of the vehicle is faded in");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::RigSlot;
    use super::*;
    use crate::compensation::Compensator;
    use crate::damper::{Damper, Nominal};
    use crate::line::Fade;
    use crate::supervision::CommandLimits;
    use crate::track::Track;
    use crate::vehicle::{Vehicle, VehicleState};

    #[test]
    fn rams_follow_within_their_limits_and_come_to_rest_at_the_end() {
        let vehicle = Vehicle::of_one_damper();
        let track = Track::default();
        let limits =
            CommandLimits { stroke_m: 0.05, velocity_m_per_s: 0.1, acceleration_m_per_s2: 5.0 };
        let model = Damper::new(Nominal::NEW, &[]).unwrap();
        let rig = RigSlot { model, wear: None, compensator: Compensator::None, limits };
        let mut slots = core::array::from_fn(|_| Slot::Empty);
        slots[0] = Slot::Rig(rig);
        let line = Line {
            vehicle: &vehicle,
            track: &track,
            contact: None,
            speed_m_per_s: 1.0,
            cycle_s: 1e-3,
            substeps: 1,
            slots,
            fade: Fade::default(),
        };
        let mut state = line.start(VehicleState::default());
        for event in [Event::Agreed, Event::Arm] {
            state.on(event);
        }
        line.open(&mut state, [0.01, 0.0, 0.0, 0.0]);
        let mut last = state.slots[0].command;
        assert_eq!(last, Command { displacement_m: 0.01, velocity_m_per_s: 0.0 });
        let mut step = |state: &mut LineState, x_m: f64| {
            let wanted = Command { displacement_m: x_m, velocity_m_per_s: 0.0 };
            line.follow(state, &[wanted; DAMPER_SLOTS]);
            let now = state.slots[0].command;
            assert!((now.displacement_m - last.displacement_m).abs() <= 0.1e-3 + 1e-12);
            assert!((now.velocity_m_per_s - last.velocity_m_per_s).abs() <= 5e-3 + 1e-12);
            last = now;
            now
        };
        // A jump of 40 mm to a place beyond the stroke.
        let reached = (0..2000).map(|_| step(&mut state, 0.06)).last().unwrap();
        assert!((reached.displacement_m - 0.05).abs() < 1e-6, "{reached:?}");
        assert!(state.slots[0].limited > 0);
        for _ in 0..100 {
            step(&mut state, 0.0);
        }
        state.on(Event::End);
        let rest = (0..100).map(|_| step(&mut state, 0.0)).last().unwrap();
        assert!(rest.velocity_m_per_s == 0.0 && line.is_faded_out(&state), "{rest:?}");
        // What is no number moves nothing.
        assert_eq!(step(&mut state, f64::NAN), rest);
    }
}
