//! The joint wears: the clearance grows with the distance that the piston has travelled.
//!
//! ```text
//! 2a = 2a_0 + g s        s = integral of |x_p'| dt
//! ```
//!
//! In service wear is of the order of 1e-9 m per m (a millimetre in a thousand kilometres of piston
//! travel) and no record shows it; a seat that works loose on the bench is a thousand to a million
//! times quicker. The typical value, a start for fits, is one of those. Frozen in each step.
//!
//! Limits: wear by travel only, not by force or impacts; the same on both sides. Source: Archard's
//! law with force and hardness in one number.

use super::draw::Draw;
use super::parameter::effect_parameters;
use super::{DamperEffect, Memory, Place, Slow};
use crate::damper::nominal::Nominal;
use crate::damper::parts::Factors;
use crate::damper::{Done, Instant};

effect_parameters! {
    /// A clearance that grows with travel.
    ClearanceGrowth {
        growth_per_travel: One in 0.0 to 1.0, typical 1e-4,
            "Growth of the total clearance 2a per distance travelled by the piston.";
    }
}

impl DamperEffect for ClearanceGrowth {
    const NAME: &'static str = "clearance_growth";
    const PLACE: Place = Place::Attachment;
    const EQUATION: &'static str = "2a = 2a_0 + g integral |v_p| dt";
    const SHOWN_BY: &'static str = "The same slow sine at the beginning and the end of the test.";
    const SLOW: Slow = Slow::Attachment;
    const STRONGEST: f64 = 0.02;
    const IN_HYDRAULIC_MODEL: bool = false;

    fn slow(&self, at: &Instant, memory: &Memory, factors: &mut Factors) {
        let [travelled_m, ..] = *memory;
        let grown_m = self.growth_per_travel * (travelled_m + at.piston_travel_m.abs());
        factors.added_half_clearance_m += 0.5 * grown_m;
    }

    fn remember(&self, _nominal: &Nominal, memory: &mut Memory, done: &Done) {
        memory[0] += done.piston_travel_m.abs();
    }

    fn drawn(strength: f64, _draw: &Draw) -> Self {
        Self { growth_per_travel: strength }
    }

    fn in_service(_nominal: &Nominal, size: f64) -> Self {
        Self { growth_per_travel: 2e-3 * size }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion};

    fn run(growth_per_travel: f64, steps: i32) -> DamperState {
        let wear = ClearanceGrowth { growth_per_travel };
        let damper = Damper::new(Nominal::NEW, &[wear.into()]).unwrap();
        let mut state = DamperState::rest();
        for i in 1..=steps {
            let t = 1e-3 * f64::from(i);
            let motion = Motion::new(4e-3 * libm::sin(22.0 * t), 0.088 * libm::cos(22.0 * t));
            damper.advance(&mut state, motion, 1e-3);
        }
        state
    }

    #[test]
    fn clearance_is_growth_times_travel() {
        // After some cycles the damper is pulled until it is slack, then by what carries no force.
        let growth = 2e-3;
        let damper =
            Damper::new(Nominal::NEW, &[ClearanceGrowth { growth_per_travel: growth }.into()])
                .unwrap();
        let mut state = run(growth, 2000);
        let travelled_m = state.memory[0][0];
        // Four quarters of some 3 mm, 7 cycles.
        assert!((0.04..0.12).contains(&travelled_m), "{travelled_m}");
        let half_m = 0.5 * Nominal::NEW.clearance_2a_m + 0.5 * growth * travelled_m;
        let piston_m = state.piston_m();
        for (share, loaded) in [(0.99, false), (-0.99, false), (1.01, true)] {
            let there = Motion::new(piston_m + share * half_m, 0.0);
            damper.advance(&mut state, there, 1e-9);
            assert_eq!(state.force_n() != 0.0, loaded, "{share}: {}", state.force_n());
        }
        let expected = Nominal::NEW.ke_n_per_m * 0.01 * half_m;
        assert!((state.force_n() / expected - 1.0).abs() < 1e-3, "{} {expected}", state.force_n());
    }

    #[test]
    fn travel_counts_both_ways() {
        // Beyond relief at constant speed, out and back: the piston follows nearly all of the way.
        let damper =
            Damper::new(Nominal::NEW, &[ClearanceGrowth { growth_per_travel: 0.0 }.into()])
                .unwrap();
        let mut state = DamperState::rest();
        let (mut x, mut way_m) = (0.0, 0.0);
        for i in 0..2000 {
            x += if i < 1000 { 1e-4 } else { -1e-4 };
            let before_m = state.piston_m();
            damper.advance(&mut state, Motion::new(x, 0.0), 1e-3);
            way_m += (state.piston_m() - before_m).abs();
        }
        assert!((state.memory[0][0] - way_m).abs() < 1e-12);
        // 0.2 m between the eyes less some deflections of 24.56 kN/Ke + a = 2.06 mm.
        assert!((0.2 - 3.0 * 2.06e-3..0.2).contains(&way_m), "{way_m}");
    }

    #[test]
    fn no_wear_is_the_nominal_damper() {
        let plain = Damper::new(Nominal::NEW, &[]).unwrap();
        let mut state = DamperState::rest();
        for i in 1..=777 {
            let t = 1e-3 * f64::from(i);
            let motion = Motion::new(4e-3 * libm::sin(22.0 * t), 0.088 * libm::cos(22.0 * t));
            plain.advance(&mut state, motion, 1e-3);
        }
        assert_eq!(run(0.0, 777).force_n(), state.force_n());
        assert!((run(1e-15, 777).force_n() - state.force_n()).abs() < 1e-6);
    }
}
