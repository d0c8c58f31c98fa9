//! The gas cushion of the reservoir pushes on the rod, inboard.
//!
//! ```text
//! F = f(x_p') - F_0 + k x_p        F_0 preload, k rate
//! ```
//!
//! The pressure of the gas stands on the area of the rod and pushes it out: a positive preload is a
//! force in compression, negative tension, at mid-stroke. Pushing the rod in compresses the gas and
//! pulling it out relaxes it, so the rate resists displacement and centres the piston like a
//! spring: a positive rate adds tension in extension. Below zero stands a preload where the record
//! counts displacement from elsewhere than mid-stroke, or does not say which side is extension.
//! `x_p` is the position of the piston from mid-stroke, frozen in each step. Inside the attachment:
//! with clearance, the joint rests on one side.
//!
//! Limits: constant rate, no cooling of the gas. Source: gas law for small changes of volume.

use super::draw::{Draw, between};
use super::parameter::{Scale, effect_parameters};
use super::{DamperEffect, Memory, Place, Slow};
use crate::damper::Instant;
use crate::damper::nominal::Nominal;
use crate::damper::parts::Factors;

effect_parameters! {
    /// A force and a spring rate on the piston.
    GasPreload {
        preload_n: Newton in -1.0 to 1.0, typical 0.02,
            "Force that pushes the rod out at mid-stroke, N.";
        rate_n_per_m: NewtonPerMetre in 0.0 to 1.0, typical 0.001,
            "Force that resists displacement of the piston, per displacement, N/m.";
    }
}

impl DamperEffect for GasPreload {
    const NAME: &'static str = "gas_preload";
    const PLACE: Place = Place::Inboard;
    const EQUATION: &'static str = "F = f(v_p) - F_0 + k x_p";
    const SHOWN_BY: &'static str =
        "Static holds at three positions, each approached from both sides.";
    const SLOW: Slow = Slow::Body;
    const DIRECTIONAL: bool = true;
    const STRONGEST: f64 = 0.6;
    const IN_HYDRAULIC_MODEL: bool = true;

    fn slow(&self, at: &Instant, _memory: &Memory, factors: &mut Factors) {
        factors.preload_n += self.rate_n_per_m * at.piston_m - self.preload_n;
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let Scale { force_n, displacement_m: stroke_m, .. } = draw.scale;
        let [a, ..] = draw.shape;
        Self {
            preload_n: strength * force_n,
            rate_n_per_m: strength * force_n / stroke_m * between(a, 0.0, 0.2),
        }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        let f = nominal.f_relief_n;
        Self { preload_n: 0.03 * size * f, rate_n_per_m: 3.0 * size * f }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion, Nominal};

    fn held_n(gas: GasPreload, displacement_m: f64) -> f64 {
        let damper = Damper::new(Nominal::NEW, &[gas.into()]).unwrap();
        let mut state = DamperState::starting(Motion::new(displacement_m, 0.0));
        for _ in 0..20_000 {
            damper.advance(&mut state, Motion::new(displacement_m, 0.0), 1e-3);
        }
        state.force_n()
    }

    #[test]
    fn held_rod_is_pushed_out() {
        let gas = GasPreload { preload_n: 400.0, rate_n_per_m: 0.0 };
        // Compression at any position: the piston stands on one side of the clearance.
        for x in [-30e-3, 0.0, 30e-3] {
            assert!((held_n(gas, x) + 400.0).abs() < 1e-6, "{x}: {}", held_n(gas, x));
        }
    }

    #[test]
    fn rate_centres_the_piston() {
        let gas = GasPreload { preload_n: 400.0, rate_n_per_m: 2e4 };
        for x in [-30e-3, 10e-3, 50e-3] {
            // The piston stands where its own force has put the attachment.
            let force = held_n(gas, x);
            let (a, ke) = (0.5 * Nominal::NEW.clearance_2a_m, Nominal::NEW.ke_n_per_m);
            let piston = x - force / ke - a * force.signum();
            let expected = 2e4 * piston - 400.0;
            assert!((force - expected).abs() < 1e-6, "{x}: {force} {expected}");
        }
        assert!(held_n(gas, 50e-3) > 590.0);
    }

    #[test]
    fn strokes_carry_it_unchanged() {
        // At constant speed beyond the lag of the spring: the nominal force less the preload.
        let gas = GasPreload { preload_n: 400.0, rate_n_per_m: 0.0 };
        let damper = Damper::new(Nominal::NEW, &[gas.into()]).unwrap();
        for v in [-0.1, -5e-3, 5e-3, 0.1] {
            let mut state = DamperState::starting(Motion::new(0.0, v));
            for i in 1..=3000 {
                damper.advance(&mut state, Motion::new(v * 1e-3 * f64::from(i), v), 1e-3);
            }
            assert!((state.force_n() - damper.steady_force_n(v) + 400.0).abs() < 1e-6);
        }
    }

    #[test]
    fn no_gas_is_the_nominal_damper() {
        let run = |effects: &[crate::damper::Effect]| {
            let damper = Damper::new(Nominal::NEW, effects).unwrap();
            let mut state = DamperState::rest();
            let at = |i: i32| 3e-3 * libm::sin(0.022 * f64::from(i));
            let forces =
                (1..=300).map(|i| damper.advance(&mut state, Motion::new(at(i), 0.0), 1e-3));
            forces.collect::<heapless::Vec<f64, 300>>()
        };
        assert_eq!(run(&[GasPreload { preload_n: 0.0, rate_n_per_m: 0.0 }.into()]), run(&[]));
    }
}
