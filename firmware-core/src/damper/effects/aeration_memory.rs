//! Oil that foams while it is worked and recovers at rest: the stiffness falls over the first
//! cycles.
//!
//! ```text
//! A' = |x_p'|/L (1 - A) - A/tau        K -> K / (1 + s A)
//! ```
//!
//! A, from 0 after a long rest to 1, is the share of the air that can be stirred into the oil.
//! Within a step the piston's speed is constant and the memory follows exactly:
//!
//! ```text
//! A_1 = A_e + (A_0 - A_e) exp(-q)        q = |dx_p|/L + h/tau        A_e = |dx_p|/(L q)
//! ```
//!
//! Limits: the air softens all of the attachment evenly (its curve over force is `entrained_air`);
//! the creep of rubber is not scaled. Source: an empirical law of first order with the known signs.

use super::draw::{Draw, decades};
use super::parameter::effect_parameters;
use super::{DamperEffect, Memory, Place, Slow};
use crate::damper::nominal::Nominal;
use crate::damper::parts::Factors;
use crate::damper::{Done, Instant};

effect_parameters! {
    /// Foam that builds with travel and leaves with time.
    AerationMemory {
        softening: One in 0.0 to 20.0, typical 0.2,
            "Relative growth of the compliance when all the air is in the oil.";
        travel_m: Metre in 1e-3 to 1e7, typical 100.0,
            "Travel of the piston that stirs in 63 % of the air, m.";
        recovery_s: Second in 1e-3 to 1e6, typical 30.0, "Time in which 63 % of it leaves, s.";
    }
}

impl AerationMemory {
    /// The share of air after a time and a travel of the piston at constant speed.
    ///
    /// ```
    /// use firmware_core::damper::effects::AerationMemory;
    /// let oil = AerationMemory { softening: 0.2, travel_m: 0.5, recovery_s: 10.0 };
    /// // No time to recover: 1 - exp(-1). No travel: exp(-1).
    /// assert!((oil.after(0.0, 0.5, 0.0) - 0.632_120_558_828_557_7).abs() < 1e-15);
    /// assert!((oil.after(1.0, 0.0, 10.0) - 0.367_879_441_171_442_3).abs() < 1e-15);
    /// ```
    pub fn after(&self, share: f64, travel_m: f64, time_s: f64) -> f64 {
        let stirred = (travel_m.abs() / self.travel_m).min(1e6);
        let both = stirred + time_s / self.recovery_s;
        if both == 0.0 {
            return share;
        }
        let settled = stirred / both;
        share - (settled - share) * libm::expm1(-both)
    }
}

impl DamperEffect for AerationMemory {
    const NAME: &'static str = "aeration_memory";
    const PLACE: Place = Place::Attachment;
    const EQUATION: &'static str = "A' = |v_p|/L (1 - A) - A/tau, K -> K/(1 + s A)";
    const SHOWN_BY: &'static str =
        "A long sine after a long rest, a rest of some minutes, and the same sine again.";
    const STARTS: &'static [&'static [f64]] = &[&[0.2, 10.0, 3.0], &[0.2, 1000.0, 300.0]];
    const SLOW: Slow = Slow::Attachment;
    const STRONGEST: f64 = 5.0;
    const IN_HYDRAULIC_MODEL: bool = false;

    fn slow(&self, at: &Instant, memory: &Memory, factors: &mut Factors) {
        let [share, ..] = *memory;
        let now = self.after(share, at.piston_travel_m, at.since_s);
        factors.compliance_gain *= 1.0 + self.softening * now;
    }

    fn remember(&self, _nominal: &Nominal, memory: &mut Memory, done: &Done) {
        memory[0] = self.after(memory[0], done.piston_travel_m, done.step_s);
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let stroke_m = draw.scale.displacement_m;
        let [a, b, _] = draw.shape;
        Self {
            softening: strength,
            travel_m: stroke_m * decades(a, 20.0, 300.0),
            recovery_s: decades(b, 3.0, 100.0),
        }
    }

    fn in_service(_nominal: &Nominal, size: f64) -> Self {
        Self { softening: 0.2 * size, travel_m: 0.05, recovery_s: 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion};

    #[test]
    fn foam_builds_and_leaves_as_the_equation_says() {
        let oil = AerationMemory { softening: 0.3, travel_m: 0.05, recovery_s: 2.0 };
        let damper = Damper::new(Nominal::NEW, &[oil.into()]).unwrap();
        let v = 0.02;
        let mut state = DamperState::starting(Motion::new(0.0, v)).with_piston_m(-1.7e-3);
        // From 1.5 s on the attachment hardly changes and the piston moves at v: A' = 0.4 - 0.9 A.
        let mut at_start = 0.0;
        let steps = 6000;
        for i in 1..=steps {
            damper.advance(&mut state, Motion::new(v * 1e-3 * f64::from(i), v), 1e-3);
            if i == 1500 {
                at_start = state.memory[0][0];
            }
        }
        let settled = 0.4 / 0.9;
        let expected = settled + (at_start - settled) * libm::exp(-0.9 * 4.5);
        assert!((state.memory[0][0] - expected).abs() < 2e-4, "{} {expected}", state.memory[0][0]);
        // Held, it leaves with tau once the spring has come to rest.
        let held = state.motion();
        for _ in 0..2000 {
            damper.advance(&mut state, held, 1e-3);
        }
        let before = state.memory[0][0];
        for _ in 0..2000 {
            damper.advance(&mut state, held, 1e-3);
        }
        let left = state.memory[0][0] / before;
        assert!((left / libm::exp(-1.0) - 1.0).abs() < 1e-6, "{left}");
    }

    #[test]
    fn memory_of_one_long_step_is_that_of_many_short_ones() {
        let oil = AerationMemory { softening: 0.3, travel_m: 0.05, recovery_s: 2.0 };
        let mut share = 0.1;
        for _ in 0..1000 {
            share = oil.after(share, -0.1e-3, 3e-3);
        }
        assert!((share - oil.after(0.1, 0.1, 3.0)).abs() < 1e-13);
    }

    #[test]
    fn foamed_attachment_is_softer_by_its_share() {
        let oil = AerationMemory { softening: 0.3, travel_m: 1e-9, recovery_s: 1e6 };
        let damper = Damper::new(Nominal::NEW, &[oil.into()]).unwrap();
        let mut state = DamperState::rest();
        for i in 1..=100 {
            damper.advance(&mut state, Motion::new(1e-4 * f64::from(i), 0.0), 1e-3);
        }
        assert!((state.memory[0][0] - 1.0).abs() < 1e-6);
        let (deflection, force) = (state.deflection_m(), state.force_n());
        assert!((deflection - 0.1e-3 - 1.3 * force / 12.5e6).abs() < 1e-10);
    }

    #[test]
    fn air_that_does_not_soften_is_the_nominal_damper() {
        let oil = AerationMemory { softening: 0.0, travel_m: 0.05, recovery_s: 2.0 };
        let with = Damper::new(Nominal::NEW, &[oil.into()]).unwrap();
        let plain = Damper::new(Nominal::NEW, &[]).unwrap();
        let (mut a, mut b) = (DamperState::rest(), DamperState::rest());
        for i in 1..=500 {
            let motion = Motion::new(4e-3 * libm::sin(0.022 * f64::from(i)), 0.0);
            assert_eq!(with.advance(&mut a, motion, 1e-3), plain.advance(&mut b, motion, 1e-3));
        }
    }
}
