//! A piece of a step, solved.
//!
//! Slow effects change the law from step to step, and most pieces begin and end on one segment of
//! it. So the segment around the beginning is worked out first ([`super::near`]); only a piece that
//! leaves it, or a piston with a law of its own at rest, has the whole law joined. Both give the
//! same bits.

use core::convert::Infallible;

use super::chain::{Arrival, Drive, Gains, Stand};
use super::implicit::{self, Creep};
use super::law::Law;
use super::near::segment_around;
use super::parts::{Factors, attachment_force_n};
use super::series;
use super::{Damper, DamperState, Instant, Motion};

/// A piece of a step to be solved.
#[derive(Clone, Copy)]
pub(super) struct Piece {
    /// Where the chain stands at its beginning.
    pub stand: Stand,
    /// The parabola from its beginning.
    pub drive: Drive,
    /// Its length, s.
    pub step_s: f64,
    /// What the attachment creeps in it.
    pub creep: Creep,
    /// Force in the chain at its beginning, N.
    pub start_force_n: f64,
}

impl Damper {
    /// Solves a piece under the factors of its slow effects: the half clearance that they add, m,
    /// and where the piece ends.
    pub(super) fn solve_slow(&self, state: &DamperState, piece: Piece) -> (f64, Arrival) {
        let factors = self.factors(state, &self.instant(state, piece));
        let arrival = if factors == Factors::NONE {
            self.solve(&self.law, piece)
        } else {
            // Most pieces begin and end on one segment: no other is worked out then.
            self.solve_near(&factors, piece).unwrap_or_else(|| self.solve_joined(&factors, piece))
        };
        (factors.added_half_clearance_m, arrival)
    }

    /// The piece on the one segment around its beginning, or nothing if it is not on one.
    fn solve_near(&self, factors: &Factors, piece: Piece) -> Option<Arrival> {
        let Piece { stand, drive, step_s, .. } = piece;
        let stand = Stand { resting: false, ..stand };
        let mut near = segment_around(&self.parts, &self.body, factors, stand.deflection_m)?;
        near.gains = Gains::over(near.rate_per_s, step_s);
        let chain = |drive| series::within(step_s, &near, stand, drive, step_s);
        if self.in_step.creeps {
            let chain = |drive| chain(drive).ok_or(());
            implicit::advance_with_creep(drive, step_s, piece.creep, piece.start_force_n, chain)
                .ok()
        } else {
            chain(drive)
        }
    }

    /// The piece on a law that is joined for it. Apart from the rest for the sake of its large
    /// frame.
    #[inline(never)]
    fn solve_joined(&self, factors: &Factors, piece: Piece) -> Arrival {
        let mut joined = Law::empty();
        joined.join(&self.parts, &self.body, factors);
        self.solve(&joined, piece)
    }

    /// The piece on a given law.
    #[inline]
    pub(super) fn solve(&self, law: &Law, piece: Piece) -> Arrival {
        let Piece { stand, drive, step_s, creep, start_force_n } = piece;
        let chain = |drive| series::advance(law, stand, drive, step_s);
        if self.in_step.creeps {
            let chain = |drive| Ok::<_, Infallible>(chain(drive));
            let Ok(arrival) =
                implicit::advance_with_creep(drive, step_s, creep, start_force_n, chain);
            arrival
        } else {
            chain(drive)
        }
    }

    /// The instant that stands for the piece: its middle where the chain is slow, its end where the
    /// chain has forgotten the beginning by then.
    fn instant(&self, state: &DamperState, piece: Piece) -> Instant {
        let time_s = series::weight_of_step(&self.law, piece.stand, piece.step_s);
        let Drive { velocity_m_per_s: velocity, acceleration_m_per_s2: acceleration } = piece.drive;
        Instant {
            motion: Motion {
                displacement_m: state.motion.displacement_m
                    + time_s * (velocity + 0.5 * acceleration * time_s),
                velocity_m_per_s: velocity + acceleration * time_s,
            },
            piston_m: state.piston_m() + time_s * state.piston_velocity_m_per_s,
            piston_velocity_m_per_s: state.piston_velocity_m_per_s,
            since_s: time_s,
            piston_travel_m: time_s * state.piston_velocity_m_per_s,
            temperature_degc: state.temperature_degc,
        }
    }

    fn factors(&self, state: &DamperState, at: &Instant) -> Factors {
        let mut factors = Factors::NONE;
        for (effect, memory) in self.effects.iter().zip(&state.memory) {
            effect.slow(at, memory, &mut factors);
        }
        factors
    }

    /// Reads the force with the attachment as it is at the end of the piece: with the frozen one, a
    /// stiffness that changes would leave the force half a step behind.
    pub(super) fn read_attachment(&self, state: &DamperState, arrival: &mut Arrival, at: &Instant) {
        let factors = self.factors(state, at);
        if factors.change_attachment() {
            let deflection_m = arrival.stand.deflection_m;
            arrival.force_n = attachment_force_n(&self.parts, &factors, deflection_m);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Nominal;
    use super::super::effects::{CATALOGUE, Effect, Slow, Values};
    use super::*;

    /// A piece of 1 ms at the start of which a state stands.
    fn piece(damper: &Damper, state: &DamperState, velocity_m_per_s: f64) -> Piece {
        let mut creep = Creep::NONE;
        for (effect, memory) in damper.effects.iter().zip(&state.memory) {
            let from_n = state.chain_force_n;
            creep = creep.plus(effect.creep(&damper.nominal, memory, from_n, 1e-3));
        }
        Piece {
            stand: Stand { deflection_m: state.deflection_m, resting: state.resting },
            drive: Drive { velocity_m_per_s, acceleration_m_per_s2: 2.0 },
            step_s: 1e-3,
            creep,
            start_force_n: state.chain_force_n,
        }
    }

    #[test]
    fn piece_on_one_segment_is_that_on_the_joined_law() {
        let scale = Nominal::NEW.scale();
        let effect = |name: &str| {
            let info = CATALOGUE.iter().find(|info| info.name == name).unwrap();
            let usual: Values = info.parameters.iter().map(|row| row.usual(&scale)).collect();
            Effect::from_values(name, &usual).unwrap()
        };
        for info in CATALOGUE.iter().filter(|info| effect(info.name).slow_part() != Slow::Nothing) {
            let others = CATALOGUE.iter().map(|other| other.name).filter(|name| *name != info.name);
            for other in core::iter::once(None).chain(others.map(Some)) {
                let effects: heapless::Vec<Effect, 2> =
                    core::iter::once(info.name).chain(other).map(effect).collect();
                let damper = Damper::new(Nominal::NEW, &effects).unwrap();
                let mut state = DamperState::rest();
                let mut near = 0;
                for i in 1..=1000 {
                    let t = 1e-3 * f64::from(i);
                    let motion =
                        Motion::new(4e-3 * libm::sin(22.0 * t), 88e-3 * libm::cos(22.0 * t));
                    damper.advance(&mut state, motion, 1e-3);
                    let piece = piece(&damper, &state, motion.velocity_m_per_s);
                    let factors = damper.factors(&state, &damper.instant(&state, piece));
                    assert!(
                        damper.in_step.slow == Slow::Attachment || !factors.change_attachment()
                    );
                    let joined = damper.solve_joined(&factors, piece);
                    let alone = damper.solve_near(&factors, piece);
                    let names = (info.name, other);
                    assert!(alone.is_none_or(|alone| alone == joined), "{names:?} at {t} s");
                    near += u32::from(alone.is_some());
                }
                let least = match other {
                    None | Some("rubber_hysteresis") => 701,
                    // A piston with a law of its own at rest always has the whole law.
                    Some("seal_friction") => 0,
                    // Longer laws have more knots to cross.
                    Some(_) => 600,
                };
                assert!(near >= least, "{} and {other:?}: {near} of 1000 pieces", info.name);
            }
        }
    }
}
