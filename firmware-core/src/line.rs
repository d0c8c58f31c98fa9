//! One control step, as one straight line: guard, vehicle step, compensation.
//!
//! ```text
//! received forces -> guard -> vehicle step (modelled dampers inside) -> compensation -> commands
//! ```
//! The step of a cycle takes the forces that were received since the last one and holds them over
//! the cycle; modelled dampers act at every substep. Forces are applied in slot order. What goes
//! out is each rig's displacement and velocity at the end of the cycle.

use crate::compensation::{VirtualWear, VirtualWearState};
use crate::damper::{Damper, DamperState, Motion};
use crate::guard::{Command, ForceInput, Guard, GuardState};
use crate::lanes::Lanes;
use crate::track::Track;
use crate::vehicle::{DAMPER_SLOTS, DamperForces, Running, Vehicle, VehicleState};
use crate::wheel_rail::table::ContactTable;

/// Where the force of a slot comes from.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "four of them, made once, never moved in the loop")]
pub enum Slot {
    /// Nothing is mounted.
    Empty,
    /// The model, inside the vehicle step.
    Modelled(Damper),
    /// A rig.
    Rig(VirtualWear),
}

/// Everything that does not change during a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Line<'a> {
    /// The vehicle.
    pub vehicle: &'a Vehicle,
    /// The track.
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
    pub slots: [Slot; DAMPER_SLOTS],
    /// The guard of every rig.
    pub guard: Guard,
}

/// What a slot remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SlotState {
    /// The model's state.
    pub damper: DamperState,
    /// The guard's state.
    pub guard: GuardState,
    /// Where the injected play stands.
    pub wear: VirtualWearState,
    /// Extension at which the vehicle stands still: mid-stroke (m).
    pub mid_stroke_m: f64,
    /// Last command to a rig.
    pub command: Command,
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
    /// Whether a guard has tripped or the model has blown up: the vehicle stands, rigs are brought
    /// to rest.
    pub safe: bool,
}

impl<'a> Line<'a> {
    fn running(&self) -> Running<'a> {
        Running {
            speed_m_per_s: Lanes([self.speed_m_per_s]),
            track: self.track,
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
    }

    /// The state at the start of a run, from a vehicle in steady motion.
    pub fn start(&self, vehicle: VehicleState) -> LineState {
        self.assert_configured();
        debug_assert!(self.vehicle.check().is_ok(), "a vehicle that cannot run");
        let mut state = LineState {
            vehicle,
            slots: [SlotState::default(); DAMPER_SLOTS],
            cycle: 0,
            safe: false,
        };
        let running = self.running();
        self.vehicle.start(&mut state.vehicle, &running);
        let motions = self.vehicle.damper_motions(&state.vehicle, &running);
        for (slot, (extension_m, _)) in state.slots.iter_mut().zip(motions) {
            slot.mid_stroke_m = extension_m.lane(0);
            slot.damper = DamperState::rest();
        }
        state
    }

    /// One cycle: takes what arrived, leaves the commands in the slots.
    pub fn step(&self, state: &mut LineState, inputs: &[ForceInput; DAMPER_SLOTS]) {
        self.assert_configured();
        let was_safe = state.safe;
        let mut held_n = [0.0; DAMPER_SLOTS];
        for (((slot, memory), input), force_n) in
            self.slots.iter().zip(&mut state.slots).zip(inputs).zip(&mut held_n)
        {
            if let Slot::Rig(_) = slot {
                *force_n = self.guard.take(&mut memory.guard, *input);
                state.safe |= memory.guard.tripped;
            }
        }
        state.cycle += 1;
        if state.safe {
            for slot in &mut state.slots {
                slot.command = slot.command.stopping(self.cycle_s);
            }
            debug_assert!(
                state.slots.iter().all(|slot| slot.command.is_finite()),
                "a safe stop starts from a sound command"
            );
            return;
        }
        let running = self.running();
        let mut forces = SlotForces { line: self, slots: &mut state.slots, held_n };
        self.vehicle.step(&mut state.vehicle, &running, &mut forces, self.substeps);
        let motions = self.vehicle.damper_motions(&state.vehicle, &running);
        if !self.is_plausible(state, &motions) {
            // The model has blown up: the last sound command is the one to stop from.
            state.safe = true;
            return;
        }
        for ((slot, memory), (extension, rate)) in
            self.slots.iter().zip(&mut state.slots).zip(motions)
        {
            let Slot::Rig(wear) = slot else { continue };
            let (displacement_m, moves) = wear.displacement_m(
                &mut memory.wear,
                extension.lane(0) - memory.mid_stroke_m,
                memory.guard.force_n,
            );
            memory.command = Command {
                displacement_m,
                velocity_m_per_s: if moves { rate.lane(0) } else { 0.0 },
            };
            debug_assert!(memory.command.is_finite(), "a plausible state gives a finite command");
        }
        debug_assert!(!was_safe && !state.safe, "a line in its safe state moves nothing");
    }
}

/// No wheel is further than this from its rail (m).
const SHIFT_MAX_M: f64 = 0.1;
/// No yaw damper is stroked further than this (m).
const STROKE_MAX_M: f64 = 0.5;

impl Line<'_> {
    /// Whether the vehicle is still on its track: all numbers, wheels near their rails, dampers
    /// within any stroke.
    fn is_plausible(
        &self,
        state: &LineState,
        motions: &[(Lanes<1>, Lanes<1>); DAMPER_SLOTS],
    ) -> bool {
        let near = |value: f64, bound: f64| value.abs() <= bound;
        let wheels = state.vehicle.shifts_m.iter().take(self.vehicle.axles.len()).flatten();
        let strokes = motions.iter().zip(&state.slots);
        state.vehicle.is_finite()
            && wheels.into_iter().all(|shift| near(shift.lane(0), SHIFT_MAX_M))
            && strokes.into_iter().all(|((extension, _), slot)| {
                near(extension.lane(0) - slot.mid_stroke_m, STROKE_MAX_M)
            })
    }
}

/// Forces of the four slots during one cycle.
struct SlotForces<'a> {
    line: &'a Line<'a>,
    slots: &'a mut [SlotState; DAMPER_SLOTS],
    held_n: [f64; DAMPER_SLOTS],
}

impl DamperForces for SlotForces<'_> {
    #[inline]
    fn force_n(
        &mut self,
        slot: usize,
        lane: usize,
        extension_m: f64,
        rate_m_per_s: f64,
        substep_s: f64,
    ) -> f64 {
        debug_assert!(slot < DAMPER_SLOTS, "slot {slot} of {DAMPER_SLOTS}");
        debug_assert!(lane == 0, "the line has one lane, not lane {lane}");
        let (Some(source), Some(state)) = (self.line.slots.get(slot), self.slots.get_mut(slot))
        else {
            return 0.0;
        };
        match source {
            Slot::Empty => 0.0,
            Slot::Rig(_) => self.held_n.get(slot).copied().unwrap_or(0.0),
            Slot::Modelled(damper) => {
                let motion = Motion::new(extension_m - state.mid_stroke_m, rate_m_per_s);
                damper.advance(&mut state.damper, motion, substep_s)
            }
        }
    }
}

#[cfg(all(test, debug_assertions))]
mod tests {
    use super::*;
    use crate::track::Track;

    fn line<'a>(vehicle: &'a Vehicle, track: &'a Track<'a>) -> Line<'a> {
        Line {
            vehicle,
            track,
            contact: None,
            speed_m_per_s: 20.0,
            cycle_s: 1e-3,
            substeps: 4,
            slots: core::array::from_fn(|_| Slot::Empty),
            guard: Guard::default(),
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
        line.slots[1] = Slot::Rig(VirtualWear::default());
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
        assert!(state.safe);
        line.step(&mut state, &[ForceInput::Missing; DAMPER_SLOTS]);
        assert!(state.safe);
    }
}
