//! One control step, as one straight line: guard, vehicle step, compensation.
//!
//! ```text
//! received forces -> guard -> vehicle step (modelled dampers inside) -> compensation -> commands
//!
//! compensation: extension -> wear -> fade -> wanted -> compensator -> limits -> command
//! ```
//! A rig is coupled gradually ([`Fade`]): its ram takes up the vehicle's motion from where it
//! stands, then its measured force takes the place of a model's. At the end it is the other way
//! round. One that is lost may drop out alone: its slot goes on with the model
//! ([`LineState::drop_out`]). A rig may stand for the damper of another slot ([`StandIn`]).
//!
//! The step of a cycle takes the forces that were received since the last one and holds them over
//! the cycle; modelled dampers act at every substep. Forces are applied in slot order. What goes
//! out is each rig's displacement and velocity at the end of the cycle.
//!
//! **Delay of the force.** Cycle `k` holds its forces over `[kT, (k+1)T]`, and commands the
//! extension at `(k+1)T`. A rig without any lag runs on from there and measures at `(k+2)T`. What
//! it measures arrives in cycle `k+1` and is the extension that leaves in the same cycle; its force
//! is held over `[(k+1)T, (k+2)T]`, half a cycle too early in the mean. With the delay `tau_x` of
//! the measured displacement that arrives in a cycle against the wanted one that leaves in it,
//!
//! ```text
//! tau = tau_x - T / 2
//! ```
//!
//! is the delay of the force, at every pace: what is older on a clock is part of `tau_x`. So
//! [`KNOWN_DELAY_CYCLES`] is the part that a compensator knows without a measurement, and an answer
//! is paired with the command of the cycle in which it arrives.

mod ahead;
mod drop_out;
mod fade;
mod motion;
mod open_loop;
mod plausible;
mod residual_delay;
mod slot;
mod stand_in;
mod trajectory;
#[cfg(test)]
mod yawing_bogie;

pub use ahead::Ahead;
pub use fade::{Fade, TooFar, URGENT_S};
pub use plausible::is_plausible;
pub use residual_delay::{
    BLOCK_S, DelayBlocks, FEWEST_BLOCKS, ResidualDelay, Sensitivity, block_cycles,
};
pub use slot::{RigSlot, Slot, SlotState};
pub use stand_in::StandIn;

use crate::command::Command;
use crate::compensation::Answer;
use crate::damper::DamperState;
use crate::guard::ForceInput;
use crate::lanes::Lanes;
use crate::supervision::{Event, Outcome, State};
use crate::track::Track;
use crate::vehicle::{DAMPER_SLOTS, Running, Vehicle, VehicleState};
use crate::wheel_rail::table::ContactTable;
use slot::SlotForces;

/// Delay of the force outside of the rigs, in cycles: it is held over a cycle, from its beginning.
pub const KNOWN_DELAY_CYCLES: f64 = -0.5;

/// Everything that does not change during a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Line<'a> {
    /// The vehicle.
    pub vehicle: &'a Vehicle,
    /// The track, or its first stretch.
    pub track: &'a Track<'a>,
    /// The contact table of wheels that run on profiles.
    pub contact: Option<&'a ContactTable>,
    /// Running speed (m/s).
    pub speed_m_per_s: f64,
    /// Length of a cycle (s).
    pub cycle_s: f64,
    /// Substeps per cycle.
    pub substeps: u32,
    /// The damper slots.
    pub slots: [Slot<'a>; DAMPER_SLOTS],
    /// How long the coupling of rigs is faded in and out.
    pub fade: Fade,
}

/// Everything that does change. Copying it is a snapshot.
#[derive(Debug, Clone, PartialEq)]
pub struct LineState {
    /// The vehicle.
    pub vehicle: VehicleState,
    /// The slots.
    pub slots: [SlotState; DAMPER_SLOTS],
    /// Cycles done.
    pub cycle: u64,
    /// State of the host. In SAFE and FAULT the vehicle stands and rigs are brought to rest.
    pub state: State,
    /// The fades of this run: longer than the line's where a ram begins far away.
    pub fade: Fade,
    /// Cycles before RUN.
    pub ramp_in_cycles: u32,
}

impl LineState {
    /// A vehicle in steady motion, with slots in which nothing has happened yet.
    #[expect(clippy::large_stack_arrays, reason = "a board makes it a constant")]
    pub const fn of(vehicle: VehicleState) -> Self {
        Self {
            vehicle,
            slots: [SlotState::NEW; DAMPER_SLOTS],
            cycle: 0,
            state: State::Init,
            fade: Fade::NONE,
            ramp_in_cycles: 0,
        }
    }

    /// Takes an event.
    pub fn on(&mut self, event: Event) -> Outcome {
        let outcome = self.state.on(event);
        if let Outcome::Enters(state) = outcome {
            self.state = state;
        }
        outcome
    }

    /// Whether the vehicle stands and rigs are brought to rest.
    pub fn is_safe(&self) -> bool {
        matches!(self.state, State::Safe | State::Fault)
    }

    /// Cycles of RUN, or what would have been them, that have begun.
    pub fn run_cycles(&self) -> u64 {
        self.cycle.saturating_sub(u64::from(self.ramp_in_cycles))
    }

    /// Time of the cycle that was done last: zero in the first cycle of RUN (s).
    pub fn time_s(&self, cycle_s: f64) -> f64 {
        self.time_of_s(self.cycle, cycle_s)
    }

    /// Time of a cycle, counted from one (s).
    pub fn time_of_s(&self, cycle: u64, cycle_s: f64) -> f64 {
        let since = cycle as i64 - i64::from(self.ramp_in_cycles) - 1;
        since as f64 * cycle_s
    }
}

/// The arrows of a step, for whoever times them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrow {
    /// The forces of the cycle are chosen.
    Guard,
    /// The vehicle has moved.
    VehicleStep,
    /// The commands stand.
    Compensation,
}

impl Line<'_> {
    fn running<'t>(&'t self, track: &'t Track<'t>) -> Running<'t> {
        Running {
            speed_m_per_s: Lanes([self.speed_m_per_s]),
            tracks: [track],
            contact: self.contact,
            substep_s: self.cycle_s / f64::from(self.substeps),
        }
    }

    /// What the step relies on and the configuration provides.
    fn assert_configured(&self) {
        debug_assert!(self.substeps > 0, "a cycle has at least one substep");
        debug_assert!(
            self.cycle_s > 0.0 && self.cycle_s.is_finite(),
            "cycle of {} s",
            self.cycle_s
        );
        debug_assert!(
            self.contact.is_some() || !self.vehicle.runs_on_profiles(),
            "wheels on profiles need a contact table"
        );
        debug_assert!(
            self.slots.iter().skip(self.vehicle.dampers.len()).all(|slot| *slot == Slot::Empty),
            "a damper in a slot that the vehicle does not have"
        );
        debug_assert!(
            self.slots.iter().all(|slot| match slot {
                Slot::StandIn(own) => matches!(self.slots.get(own.of), Some(Slot::Rig(_))),
                Slot::Empty | Slot::Modelled(_) | Slot::Rig(_) => true,
            }),
            "only a rig stands for another damper"
        );
    }

    /// The state at the start of a run, from a vehicle in steady motion: INIT, or RUN where no
    /// damper is on a rig.
    pub fn start(&self, vehicle: VehicleState) -> LineState {
        let mut state = LineState::of(vehicle);
        self.begin(&mut state);
        state
    }

    /// The same in a state's own place, which is [`LineState::of`] a vehicle: it is large.
    pub fn begin(&self, state: &mut LineState) {
        self.assert_configured();
        debug_assert!(self.vehicle.check().is_ok(), "a vehicle that cannot run");
        debug_assert!(state.cycle == 0, "begun after {} cycles", state.cycle);
        state.fade = self.fade;
        if !self.slots.iter().any(|slot| matches!(slot, Slot::Rig(_))) {
            // There is nobody to agree with.
            state.state = State::Run;
        }
        let running = self.running(self.track);
        self.vehicle.start(&mut state.vehicle, &running);
        let motions = self.vehicle.damper_motions(&state.vehicle, &running);
        for ((slot, memory), (extension_m, _)) in
            self.slots.iter().zip(&mut state.slots).zip(motions)
        {
            memory.mid_stroke_m = extension_m.lane(0);
            memory.damper = DamperState::rest();
            if let Slot::Rig(rig) = slot {
                memory.limits = rig.limits;
                memory.compensator = rig.compensator.start();
            }
        }
    }

    /// One cycle: takes what arrived, leaves the commands in the slots.
    pub fn step(&self, state: &mut LineState, inputs: &[ForceInput; DAMPER_SLOTS]) {
        self.step_on(self.track, state, inputs, &[None; DAMPER_SLOTS]);
    }

    /// The same on any stretch of the line's track that holds the whole vehicle, with the measured
    /// displacements that arrived with the forces.
    pub fn step_on(
        &self,
        track: &Track<'_>,
        state: &mut LineState,
        inputs: &[ForceInput; DAMPER_SLOTS],
        answers: &[Option<Answer>; DAMPER_SLOTS],
    ) {
        self.step_in_arrows(track, state, inputs, answers, |_| {});
    }

    /// The same, and says behind each arrow of the module's drawing that it is done; in the safe
    /// state the guard alone. The core has no clock: who wants times takes them.
    #[inline]
    pub fn step_in_arrows(
        &self,
        track: &Track<'_>,
        state: &mut LineState,
        inputs: &[ForceInput; DAMPER_SLOTS],
        answers: &[Option<Answer>; DAMPER_SLOTS],
        mut done: impl FnMut(Arrow),
    ) {
        self.assert_configured();
        debug_assert!(state.state.moves() || state.is_safe(), "a step in {:?}", state.state);
        let held_n = self.choose_forces(state, inputs);
        done(Arrow::Guard);
        if state.is_safe() {
            self.stop_rams(state);
            return;
        }
        let running = self.running(track);
        self.move_vehicle(state, &running, held_n);
        done(Arrow::VehicleStep);
        if self.command_rams(state, &running, inputs, answers) {
            done(Arrow::Compensation);
        }
    }

    /// The measured forces that act in this cycle (N), and the fades one cycle further.
    fn choose_forces(
        &self,
        state: &mut LineState,
        inputs: &[ForceInput; DAMPER_SLOTS],
    ) -> [f64; DAMPER_SLOTS] {
        let mut held_n = [0.0; DAMPER_SLOTS];
        for (((slot, memory), input), force_n) in
            self.slots.iter().zip(&mut state.slots).zip(inputs).zip(&mut held_n)
        {
            if let Slot::Rig(_) = slot {
                *force_n = if memory.is_force_believed {
                    memory.guard.take(*input)
                } else {
                    memory.guard.force_n
                };
            }
        }
        if !state.is_safe() {
            self.advance_fades(state);
        }
        state.cycle += 1;
        held_n
    }

    /// SAFE: the rams come to rest where they are.
    fn stop_rams(&self, state: &mut LineState) {
        for (slot, memory) in self.slots.iter().zip(&mut state.slots) {
            let Slot::Rig(_) = slot else { continue };
            let most = memory.limits.acceleration_m_per_s2;
            memory.command = memory.command.stopping(self.cycle_s, most);
        }
        debug_assert!(
            state.slots.iter().all(|slot| slot.command.is_finite()),
            "a safe stop starts from a sound command"
        );
    }

    /// The vehicle, one cycle further.
    ///
    /// A function of its own, without parameters of type: one that its caller's crate compiled
    /// would have that crate's optimisation.
    #[inline(never)]
    fn move_vehicle(
        &self,
        state: &mut LineState,
        running: &Running<'_>,
        held_n: [f64; DAMPER_SLOTS],
    ) {
        let mut forces = SlotForces { line: self, slots: &mut state.slots, held_n };
        self.vehicle.step(&mut state.vehicle, running, &mut forces, self.substeps);
    }

    /// The commands of the rigs; false where the model has blown up and there are none.
    fn command_rams(
        &self,
        state: &mut LineState,
        running: &Running<'_>,
        inputs: &[ForceInput; DAMPER_SLOTS],
        answers: &[Option<Answer>; DAMPER_SLOTS],
    ) -> bool {
        let motions = self.vehicle.damper_motions(&state.vehicle, running);
        if !is_plausible(self.vehicle, &state.vehicle, &motions, &state.slots, 0) {
            // The last sound command is the one to stop from.
            state.on(Event::Stop);
            return false;
        }
        let (fade, phase) = (state.fade, state.state);
        let arrived = inputs.iter().zip(answers);
        for (((slot, memory), (extension, rate)), (input, answer)) in
            self.slots.iter().zip(&mut state.slots).zip(motions).zip(arrived)
        {
            let Slot::Rig(rig) = slot else { continue };
            if memory.has_dropped_out {
                memory.come_to_rest(self.cycle_s);
                continue;
            }
            let vehicle = Command {
                displacement_m: extension.lane(0) - memory.mid_stroke_m,
                velocity_m_per_s: rate.lane(0),
            };
            memory.take_motion(rig, vehicle, (*input, *answer), (fade, phase), self.cycle_s);
            debug_assert!(memory.command.is_finite(), "a plausible state gives a finite command");
        }
        debug_assert!(!state.is_safe(), "a line in its safe state moves nothing");
        true
    }
}

#[cfg(all(test, debug_assertions))]
#[expect(clippy::large_stack_arrays, reason = "slots of tests")]
mod tests {
    use super::*;
    use crate::compensation::Compensator;
    use crate::damper::{Damper, Nominal};
    use crate::supervision::CommandLimits;
    use crate::track::Track;
    use crate::vehicle::DamperForces as _;

    fn rig() -> RigSlot<'static> {
        let Ok(model) = Damper::new(Nominal::NEW, &[]) else { panic!("a new damper") };
        RigSlot {
            model,
            wear: None,
            compensator: Compensator::None,
            limits: CommandLimits {
                stroke_m: 0.05,
                velocity_m_per_s: 0.3,
                acceleration_m_per_s2: 20.0,
            },
        }
    }

    fn line<'a>(vehicle: &'a Vehicle, track: &'a Track<'a>) -> Line<'a> {
        Line {
            vehicle,
            track,
            contact: None,
            speed_m_per_s: 20.0,
            cycle_s: 1e-3,
            substeps: 4,
            slots: core::array::from_fn(|_| Slot::Empty),
            fade: Fade::default(),
        }
    }

    fn force_of(slot: usize, lane: usize) -> f64 {
        let (vehicle, track) = (Vehicle::default(), Track::default());
        let line = line(&vehicle, &track);
        let mut slots = [SlotState::default(); DAMPER_SLOTS];
        let mut forces = SlotForces { line: &line, slots: &mut slots, held_n: [0.0; DAMPER_SLOTS] };
        forces.force_n(slot, lane, 0.0, 0.0, 1e-3)
    }

    #[test]
    #[should_panic(expected = "slot 4 of 4")]
    fn a_slot_that_does_not_exist_stops_a_debug_build() {
        force_of(DAMPER_SLOTS, 0);
    }

    #[test]
    #[should_panic(expected = "not lane 1")]
    fn a_second_lane_of_the_line_stops_a_debug_build() {
        force_of(0, 1);
    }

    #[test]
    #[should_panic(expected = "a slot that the vehicle does not have")]
    fn a_damper_without_a_mount_stops_a_debug_build() {
        let (vehicle, track) = (Vehicle::default(), Track::default());
        let mut line = line(&vehicle, &track);
        line.slots[1] = Slot::Rig(rig());
        line.start(VehicleState::default());
    }

    #[test]
    #[should_panic(expected = "at least one substep")]
    fn a_cycle_without_substeps_stops_a_debug_build() {
        let (vehicle, track) = (Vehicle::default(), Track::default());
        let line = Line { substeps: 0, ..line(&vehicle, &track) };
        line.start(VehicleState::default());
    }

    #[test]
    fn a_model_that_diverges_is_a_state_and_stops_nothing() {
        let (vehicle, track) = (Vehicle::default(), Track::default());
        let line = line(&vehicle, &track);
        let mut state = line.start(VehicleState::default());
        state.vehicle.position[0][1] = Lanes([f64::NAN]);
        line.step(&mut state, &[ForceInput::Missing; DAMPER_SLOTS]);
        assert!(state.is_safe());
        line.step(&mut state, &[ForceInput::Missing; DAMPER_SLOTS]);
        assert!(state.is_safe());
    }
}
