//! How a run begins and ends: motion and coupling of every rig are faded in and out.
//!
//! ```text
//! x = x_0 + g_m (x_vehicle - x_0)              x_0: where the ram stood
//! F = (1 - g_c) F_model + g_c F_measured       the vehicle always has a damper
//!
//! RAMP_IN:   g_m from 0 to 1, both stay while the delay is measured, then g_c from 0 to 1
//! RAMP_OUT:  g_c to 0, then g_m to 0: the ram rests where it began
//! ```
//! A force that is not believed any more is faded out within [`URGENT_S`], from its last believed
//! value. A compensator acts on as much of the command as the motion is faded in, so that a ram
//! begins and ends where it stands. A ram is never brought back along a displacement that is not
//! believed: that is SAFE.

use super::ahead::Ahead;
use super::slot::SlotState;
use super::{Line, LineState, Slot};
use crate::command::Command;
use crate::compensation::{Answer, Compensator};
use crate::supervision::{CommandLimits, Event, Outcome, Ramp, State};
use crate::vehicle::DAMPER_SLOTS;

/// Length of both fades, and of the pause between them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Fade {
    /// Cycles in which the ram takes up the vehicle's motion.
    pub motion_cycles: u32,
    /// Cycles between them, in which the ram moves with the vehicle and its force does not act: the
    /// delay is measured.
    pub measuring_cycles: u32,
    /// Cycles in which the measured force takes the place of the model's.
    pub coupling_cycles: u32,
}

/// Time within which a force that is not believed leaves the vehicle (s).
pub const URGENT_S: f64 = 0.02;

/// Longest fade of the motion (s): a ram that needs more is to be centred first.
const LONGEST_S: f64 = 2.0;

/// A ram that stands too far from where the vehicle is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TooFar {
    /// Its damper slot.
    pub slot: usize,
    /// Where it stands (m).
    pub ram_m: f64,
}

impl Fade {
    /// At once.
    pub const NONE: Self = Self { motion_cycles: 0, measuring_cycles: 0, coupling_cycles: 0 };

    /// The same, with a fade of the motion that is long enough for a way within half the limits.
    ///
    /// The steepest speed of a raised cosine over `T` is `pi x / (2 T)`, its strongest acceleration
    /// `pi^2 x / (2 T^2)`; the other half of the limits is for the vehicle's own motion.
    fn over(self, way_m: f64, limits: &CommandLimits, cycle_s: f64) -> Option<Self> {
        use core::f64::consts::PI;
        if self.motion_cycles == 0 {
            // The limits alone drive it there.
            return Some(self);
        }
        let by_velocity_s = PI * way_m / limits.velocity_m_per_s;
        let by_acceleration_s = PI * crate::sqrt::sqrt(way_m / limits.acceleration_m_per_s2);
        let least_s = by_velocity_s.max(by_acceleration_s);
        let cycles = libm::ceil(least_s / cycle_s) as u32;
        (least_s <= LONGEST_S)
            .then_some(Self { motion_cycles: self.motion_cycles.max(cycles), ..self })
    }
}

impl Line<'_> {
    /// Couples the rigs of an armed line, whose rams stand at these displacements (m, by slot).
    ///
    /// RUN begins after as many cycles as the fades take.
    ///
    /// # Errors
    /// A ram that stands too far away.
    pub fn couple(&self, state: &mut LineState, rams_m: [f64; DAMPER_SLOTS]) -> Result<(), TooFar> {
        let motions = self.vehicle.damper_motions(&state.vehicle, &self.running(self.track));
        let mut fade = self.fade;
        let rams = self.slots.iter().zip(&mut state.slots).zip(motions).zip(rams_m).enumerate();
        for (slot, (((kind, memory), (extension, _)), ram_m)) in rams {
            let Slot::Rig(rig) = kind else { continue };
            memory.begin(ram_m);
            memory.compensator = rig.compensator.start();
            let way_m = (extension.lane(0) - memory.mid_stroke_m - ram_m).abs();
            let longer = fade.over(way_m, &memory.limits, self.cycle_s);
            fade = longer.ok_or(TooFar { slot, ram_m })?;
        }
        if fade.motion_cycles == 0 {
            state.slots.iter_mut().for_each(|memory| memory.motion = Ramp::FULL);
        }
        if fade.coupling_cycles == 0 && fade.measuring_cycles == 0 {
            state.slots.iter_mut().for_each(|memory| memory.coupling = Ramp::FULL);
        }
        state.fade = fade;
        if state.state == State::Run {
            // Without a rig there is nothing to couple.
            return Ok(());
        }
        let before = fade.motion_cycles + fade.measuring_cycles;
        state.ramp_in_cycles = before + fade.coupling_cycles;
        let outcome = state.on(Event::Couple);
        debug_assert!(outcome == Outcome::Enters(State::RampIn), "coupled without being armed");
        Ok(())
    }

    /// One cycle of the fades; a fade-in that is done enters RUN.
    pub(super) fn advance_fades(&self, state: &mut LineState) {
        if state.state == State::RampIn && state.cycle >= u64::from(state.ramp_in_cycles) {
            state.on(Event::RampDone);
        }
        let (phase, fade) = (state.state, state.fade);
        let is_measuring = state.is_measuring();
        let urgent_cycles = libm::ceil(URGENT_S / self.cycle_s) as u32;
        let slots = self.slots.iter().zip(&mut state.slots);
        for (_, memory) in slots.filter(|(slot, _)| matches!(slot, Slot::Rig(_))) {
            if memory.has_dropped_out {
                memory.coupling.down(urgent_cycles);
                continue;
            }
            match phase {
                State::RampIn if !memory.motion.is_full() => memory.motion.up(fade.motion_cycles),
                State::RampIn if is_measuring => {}
                State::RampIn => memory.coupling.up(fade.coupling_cycles),
                State::RampOut if !memory.coupling.is_empty() => {
                    let cycles = fade.coupling_cycles;
                    memory.coupling.down(if memory.is_force_believed {
                        cycles
                    } else {
                        cycles.min(urgent_cycles)
                    });
                }
                State::RampOut => memory.motion.down(fade.motion_cycles),
                _ => {
                    debug_assert!(memory.motion.is_full() && memory.coupling.is_full());
                }
            }
        }
    }

    /// Whether every fade-out is done: the rams rest where they began.
    pub fn is_faded_out(&self, state: &LineState) -> bool {
        let slots = self.slots.iter().zip(&state.slots);
        let mut rigs = slots.filter(|(slot, _)| matches!(slot, Slot::Rig(_)));
        state.state == State::RampOut
            && rigs.all(|(_, memory)| {
                memory.is_out() && (memory.has_dropped_out || memory.motion.is_empty())
            })
    }
}

impl LineState {
    /// Whether the rigs move with the vehicle and their forces do not act yet.
    pub fn is_measuring(&self) -> bool {
        let Fade { motion_cycles, measuring_cycles, .. } = self.fade;
        let begin = u64::from(motion_cycles);
        let end = begin + u64::from(measuring_cycles);
        self.state == State::RampIn && (begin..end).contains(&self.cycle)
    }

    /// Has RUN begin after at least so many cycles, so that it begins at the same place on the
    /// track as that of another run. For a line that was not stepped yet.
    pub fn delay_run(&mut self, cycles: u32) {
        debug_assert!(self.cycle == 0, "RUN is delayed after {} cycles", self.cycle);
        self.ramp_in_cycles = self.ramp_in_cycles.max(cycles);
        if self.ramp_in_cycles > 0 && self.state == State::Run {
            self.state = State::RampIn;
        }
    }
}

impl SlotState {
    /// A ram at rest that takes up nothing yet.
    pub(super) fn begin(&mut self, ram_m: f64) {
        self.ram_start_m = ram_m;
        self.command = Command { displacement_m: ram_m, velocity_m_per_s: 0.0 };
        self.wanted = self.command;
        self.ahead = Ahead::resting(self.command);
        (self.motion, self.coupling) = (Ramp::default(), Ramp::default());
        (self.is_force_believed, self.has_dropped_out) = (true, false);
    }

    /// The command that a rig answers with a wanted motion.
    ///
    /// A compensator gives a ram at rest away from mid-stroke another place, where its gain is not
    /// one; so its share grows with the motion.
    pub(super) fn compensated(
        &mut self,
        compensator: &Compensator,
        wanted: Command,
        answer: Option<Answer>,
        (fade, phase): (Fade, State),
        cycle_s: f64,
    ) -> Command {
        let whole = compensator.step(&mut self.compensator, wanted, answer, cycle_s);
        if self.motion.is_full() {
            return whole;
        }
        let (gain, gain_per_s) = self.motion_gain(fade, phase, cycle_s);
        let way_m = whole.displacement_m - wanted.displacement_m;
        let velocity = whole.velocity_m_per_s - wanted.velocity_m_per_s;
        Command {
            displacement_m: wanted.displacement_m + gain * way_m,
            velocity_m_per_s: wanted.velocity_m_per_s + gain * velocity + gain_per_s * way_m,
        }
    }

    /// The share of the vehicle's motion and its rate (1/s).
    fn motion_gain(&self, fade: Fade, phase: State, cycle_s: f64) -> (f64, f64) {
        let rate_per_s = self.motion.slope(fade.motion_cycles) / cycle_s;
        (self.motion.gain(), if phase == State::RampOut { -rate_per_s } else { rate_per_s })
    }

    /// The command for a rig on its way into or out of the vehicle's motion.
    pub(super) fn faded(
        &self,
        vehicle: Command,
        (fade, phase): (Fade, State),
        cycle_s: f64,
    ) -> Command {
        if self.motion.is_full() {
            return vehicle;
        }
        let (gain, gain_per_s) = self.motion_gain(fade, phase, cycle_s);
        let way_m = vehicle.displacement_m - self.ram_start_m;
        Command {
            displacement_m: self.ram_start_m + gain * way_m,
            velocity_m_per_s: gain * vehicle.velocity_m_per_s + gain_per_s * way_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ram 3 mm away from a vehicle that swings by 4 mm at 3.5 Hz.
    #[test]
    fn the_velocity_of_a_fade_is_the_rate_of_its_displacement() {
        const CYCLE_S: f64 = 1e-3;
        let rate_per_s = 2.0 * core::f64::consts::PI * 3.5;
        let vehicle = |cycle: i32| {
            let (sin, cos) = libm::sincos(rate_per_s * f64::from(cycle) * CYCLE_S);
            Command { displacement_m: 4e-3 * sin, velocity_m_per_s: 4e-3 * rate_per_s * cos }
        };
        let fade = Fade { motion_cycles: 500, ..Fade::default() };
        for phase in [State::RampIn, State::RampOut] {
            let mut memory = SlotState::default();
            memory.begin(-3e-3);
            if phase == State::RampOut {
                memory.motion = Ramp::FULL;
                memory.motion.down(fade.motion_cycles);
            }
            let (mut before, mut most) = ([Command::default(); 2], 0.0_f64);
            for cycle in 0..498 {
                let command = memory.faded(vehicle(cycle), (fade, phase), CYCLE_S);
                let [two_ago, last] = before;
                if cycle >= 2 {
                    let way_m = command.displacement_m - two_ago.displacement_m;
                    let error = last.velocity_m_per_s - way_m / (2.0 * CYCLE_S);
                    most = most.max(error.abs());
                }
                before = [last, command];
                match phase {
                    State::RampIn => memory.motion.up(fade.motion_cycles),
                    _ => memory.motion.down(fade.motion_cycles),
                }
            }
            // Of 88 mm/s from the vehicle and 22 mm/s from the fade.
            assert!(most < 0.02e-3, "{phase:?}: {most} m/s");
        }
    }
}
