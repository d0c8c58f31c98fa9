//! A step of a damper with effects, cut into pieces where it has to be.
//!
//! Between two samples the eyes move on one parabola. The step is cut
//! - where an effect switches: the piece ends where its margin has just fallen below zero, found by
//!   trying pieces of other lengths, which changes nothing;
//! - where a late sensor will look in a later step.
//!
//! Every piece is a whole step of the chain ([`super::piece`]), so creep, slow factors and memories
//! need not know. A step that is not cut is one piece.

use super::chain::{Arrival, Drive, Stand};
use super::delay::DelayLine;
use super::effects::Slow;
use super::implicit::Creep;
use super::piece::Piece;
use super::{Damper, DamperState, Done, Instant, Motion, without_tiny};

/// Most pieces between two cuts of the sensor; the last one goes to the end in any case.
const MAX_PIECES: u32 = 8;

/// Most pieces tried for one switch.
const MAX_TRIES: u32 = 40;

/// Shortest piece tried, and how closely a switch is met, relative to the remainder of the step.
const LEAST: f64 = 1e-9;

/// A step as the caller gave it.
pub(super) struct Sample {
    /// Motion at its end.
    pub motion: Motion,
    /// The parabola from its beginning.
    pub drive: Drive,
    /// Its length, s.
    pub step_s: f64,
}

/// A piece that was tried; the state does not know of it.
struct Tried {
    arrival: Arrival,
    creep_m: f64,
    done: Done,
}

impl Damper {
    /// Moves the state through a step and returns the force that is read at its end.
    pub(super) fn advance_with_effects(&self, state: &mut DamperState, sample: &Sample) -> f64 {
        let step_s = sample.step_s;
        if self.delay_s <= 0.0 {
            return self.stretch(state, sample, 0.0, step_s);
        }
        state.delay.pass(step_s);
        if let Some(cut_s) = DelayLine::cut_s(self.delay_s, step_s) {
            let force_n = self.stretch(state, sample, 0.0, cut_s);
            state.delay.keep(step_s - cut_s, self.delay_s, force_n);
            self.stretch(state, sample, cut_s, step_s);
        } else {
            let force_n = self.stretch(state, sample, 0.0, step_s);
            state.delay.keep(0.0, self.delay_s, force_n);
        }
        state.delay.read(self.delay_s)
    }

    /// Moves the state from one time within a step to another, and returns the force there.
    #[inline]
    fn stretch(&self, state: &mut DamperState, sample: &Sample, from_s: f64, to_s: f64) -> f64 {
        if self.in_step.switches {
            return self.stretch_with_switches(state, sample, from_s, to_s);
        }
        let tried = self.attempt(state, sample, from_s, to_s);
        self.finish(state, &tried)
    }

    fn stretch_with_switches(
        &self,
        state: &mut DamperState,
        sample: &Sample,
        from_s: f64,
        to_s: f64,
    ) -> f64 {
        let mut at_s = from_s;
        let mut force_n = state.chain_force_n;
        for piece in 1..=MAX_PIECES {
            let mut end_s = to_s;
            let mut tried = self.attempt(state, sample, at_s, end_s);
            if piece < MAX_PIECES {
                for index in 0..self.effects.len() {
                    if self.margin(state, index, &tried) < 0.0 {
                        (end_s, tried) = self.switch(state, sample, at_s, end_s, index, tried);
                    }
                }
            }
            force_n = self.finish(state, &tried);
            at_s = end_s;
            if at_s >= to_s {
                break;
            }
        }
        force_n
    }

    fn margin(&self, state: &DamperState, index: usize, tried: &Tried) -> f64 {
        debug_assert!(index < self.effects.len(), "effect {index} of {}", self.effects.len());
        let effect = self.effects.get(index).zip(state.memory.get(index));
        effect.map_or(f64::INFINITY, |(effect, memory)| effect.margin(memory, &tried.done))
    }

    /// The shortest piece at whose end the effect has switched, knowing that it has at `late_s`:
    /// false position (Illinois) with every third try in the middle.
    fn switch(
        &self,
        state: &DamperState,
        sample: &Sample,
        at_s: f64,
        late_s: f64,
        index: usize,
        tried: Tried,
    ) -> (f64, Tried) {
        let least_s = LEAST * (late_s - at_s);
        let mut late = (late_s, self.margin(state, index, &tried));
        let mut found = (late_s, tried);
        let at_once = self.attempt(state, sample, at_s, at_s + least_s);
        let mut early = (at_s + least_s, self.margin(state, index, &at_once));
        if early.1 < 0.0 {
            return (early.0, at_once);
        }
        let mut last_late = None;
        for attempt in 1..=MAX_TRIES {
            let length_s = late.0 - early.0;
            if length_s <= least_s {
                break;
            }
            let share = if attempt % 3 == 0 { 0.5 } else { early.1 / (early.1 - late.1) };
            // Never on an end of the bracket itself.
            let inset = 0.25 * least_s;
            let end_s = early.0 + (share * length_s).max(inset).min(length_s - inset);
            let tried = self.attempt(state, sample, at_s, end_s);
            let margin = self.margin(state, index, &tried);
            let is_late = margin < 0.0;
            if last_late == Some(is_late) {
                let stale = if is_late { &mut early } else { &mut late };
                stale.1 *= 0.5;
            }
            last_late = Some(is_late);
            if is_late {
                late = (end_s, margin);
                found = (end_s, tried);
            } else {
                early = (end_s, margin);
            }
        }
        found
    }

    /// Tries a piece of a step.
    #[inline]
    fn attempt(&self, state: &DamperState, sample: &Sample, from_s: f64, to_s: f64) -> Tried {
        debug_assert!(from_s >= 0.0 && to_s <= sample.step_s, "{from_s} s to {to_s} s");
        let step_s = to_s - from_s;
        let acceleration = sample.drive.acceleration_m_per_s2;
        let velocity = sample.drive.velocity_m_per_s + acceleration * from_s;
        let drive = Drive { velocity_m_per_s: velocity, acceleration_m_per_s2: acceleration };
        let end_velocity_m_per_s = velocity + acceleration * step_s;
        let motion = if to_s == sample.step_s {
            sample.motion
        } else {
            let travel_m = step_s * (velocity + 0.5 * acceleration * step_s);
            Motion::new(state.motion.displacement_m + travel_m, end_velocity_m_per_s)
        };
        let start_force_n = state.chain_force_n;
        let stand = Stand { deflection_m: state.deflection_m, resting: state.resting };
        let creep = self.creep(state, start_force_n, step_s);
        let mut half_clearance_m = 0.5 * self.nominal.clearance_2a_m;
        let piece = Piece { stand, drive, step_s, creep, start_force_n };
        let mut arrival = if self.in_step.slow == Slow::Nothing {
            self.solve(&self.law, piece)
        } else {
            let (added_m, arrival) = self.solve_slow(state, piece);
            half_clearance_m += added_m;
            arrival
        };
        let creep_m =
            if self.in_step.creeps { creep.end_m(arrival.force_n) } else { state.creep_m };
        let deflection_m = arrival.stand.deflection_m;
        let piston_m = motion.displacement_m - deflection_m - creep_m;
        let piston_travel_m = piston_m - state.piston_m();
        if self.in_step.slow == Slow::Attachment {
            let at = Instant {
                motion,
                piston_m,
                piston_velocity_m_per_s: arrival.piston_velocity_m_per_s,
                since_s: step_s,
                piston_travel_m,
                temperature_degc: state.temperature_degc,
            };
            self.read_attachment(state, &mut arrival, &at);
        }
        let done = Done {
            step_s,
            whole_s: sample.step_s,
            ahead_s: sample.step_s - to_s,
            motion,
            acceleration_m_per_s2: acceleration,
            end_velocity_m_per_s,
            start_force_n,
            chain_force_n: arrival.force_n,
            piston_m,
            piston_travel_m,
            piston_velocity_m_per_s: arrival.piston_velocity_m_per_s,
            deflection_m,
            half_clearance_m,
            temperature_degc: state.temperature_degc,
        };
        Tried { arrival, creep_m, done }
    }

    /// Takes a piece as done and returns the force at its end, not yet delayed.
    #[inline]
    fn finish(&self, state: &mut DamperState, tried: &Tried) -> f64 {
        let Tried { arrival, creep_m, done } = tried;
        state.creep_m = *creep_m;
        state.arrive(arrival, done.motion);
        let mut force_n = arrival.force_n;
        for (effect, memory) in self.effects.iter().zip(state.memory.iter_mut()) {
            effect.remember(&self.nominal, memory, done);
            force_n = effect.output(memory, done, force_n);
            for value in memory.iter_mut() {
                *value = without_tiny(*value);
            }
        }
        force_n
    }

    fn creep(&self, state: &DamperState, start_force_n: f64, step_s: f64) -> Creep {
        let mut creep = Creep::NONE;
        if self.in_step.creeps {
            for (effect, memory) in self.effects.iter().zip(&state.memory) {
                creep = creep.plus(effect.creep(&self.nominal, memory, start_force_n, step_s));
            }
        }
        creep
    }
}

#[cfg(test)]
mod tests {
    use super::super::Nominal;
    use super::super::effects::{CATALOGUE, Effect, Values};
    use super::*;

    #[test]
    fn effect_that_is_its_law_alone_needs_no_step_of_its_own() {
        let scale = Nominal::NEW.scale();
        let mut alone = 0;
        for info in CATALOGUE {
            let usual: Values = info.parameters.iter().map(|row| row.usual(&scale)).collect();
            let effect = Effect::from_values(info.name, &usual).unwrap();
            let short = Damper::new(Nominal::NEW, &[effect]).unwrap();
            if !short.law_alone {
                continue;
            }
            alone += 1;
            let asked = Damper { law_alone: false, ..short.clone() };
            let (mut a, mut b) = (DamperState::rest(), DamperState::rest());
            for i in 1..=2000 {
                let t = 1e-3 * f64::from(i);
                let motion = Motion::new(4e-3 * libm::sin(22.0 * t), 88e-3 * libm::cos(22.0 * t));
                let forces =
                    (short.advance(&mut a, motion, 1e-3), asked.advance(&mut b, motion, 1e-3));
                assert_eq!(forces.0, forces.1, "{} at {t} s", info.name);
            }
            assert_eq!(a, b, "{}", info.name);
        }
        assert!(alone >= 8, "{alone}");
    }
}
