//! Rubber bushings that relax: a standard linear solid in series with the clearance.
//!
//! ```text
//! F = Ke d + r Ke (d - z)      tau z' = d - z      Ke*(w) = Ke (1 + r i w tau / (1 + i w tau))
//! ```
//!
//! Ke stays the static stiffness, Ke (1 + r) is the one at high frequency. The same solid as a
//! spring Ke (1 + r) in series with a creep c:
//!
//! ```text
//! d = F / (Ke (1 + r)) + c        tau_c c' = F r / (Ke (1 + r)) - c        tau_c = tau (1 + r)
//! ```
//!
//! which needs no case for the open clearance: there F is zero and the rubber springs back slowly.
//! Limits: no softening with amplitude. Where the attachment stiffens (`stiffening_attachment`),
//! the quick deflection follows the cubic law at 1 + r times its stiffness and the creep stays
//! linear.

use super::draw::{Draw, decades};
use super::parameter::effect_parameters;
use super::{DamperEffect, Memory, Place};
use crate::damper::Done;
use crate::damper::chain::Gains;
use crate::damper::implicit::Creep;
use crate::damper::nominal::Nominal;
use crate::damper::parts::Parts;

effect_parameters! {
    /// A bushing with one relaxation time.
    RubberHysteresis {
        dynamic_stiffening: One in 0.0 to 20.0, typical 0.15,
            "Stiffness at high frequency over static stiffness, less one.";
        relaxation_time_s: Second in 1e-5 to 100.0, typical 0.01,
            "Time constant of relaxation at constant deflection, s.";
    }
}

impl RubberHysteresis {
    /// Compliance of the creep, m/N, and its time constant, s.
    fn creep_of(&self, nominal: &Nominal) -> (f64, f64) {
        let dynamic = 1.0 + self.dynamic_stiffening;
        let compliance = self.dynamic_stiffening / (dynamic * nominal.ke_n_per_m);
        (compliance, self.relaxation_time_s * dynamic)
    }
}

impl DamperEffect for RubberHysteresis {
    const NAME: &'static str = "rubber_hysteresis";
    const PLACE: Place = Place::Attachment;
    const EQUATION: &'static str = "F = Ke d + r Ke (d - z), tau z' = d - z";
    const SHOWN_BY: &'static str =
        "Small sines below relief over one and a half decades of frequency at one amplitude.";
    const STARTS: &'static [&'static [f64]] = &[&[0.15, 0.001], &[0.15, 0.1], &[0.15, 1.0]];
    const CREEPS: bool = true;
    const STRONGEST: f64 = 5.0;
    const IN_HYDRAULIC_MODEL: bool = true;

    fn shape(&self, parts: &mut Parts, _nominal: &Nominal) {
        parts.scale_compliance(1.0 / (1.0 + self.dynamic_stiffening));
    }

    fn creep(&self, nominal: &Nominal, memory: &Memory, start_force_n: f64, step_s: f64) -> Creep {
        let [creep_m, ..] = *memory;
        let (compliance, time_s) = self.creep_of(nominal);
        let rate = 1.0 / time_s;
        let gains = Gains::over(rate, step_s);
        // Response to a force that runs straight from its start value to its end value.
        let hold = gains.velocity_s * rate;
        let ramp = gains.acceleration_s2 * rate / step_s;
        let from_start = creep_m + hold * (compliance * start_force_n - creep_m);
        Creep {
            start_m: creep_m,
            end_without_force_m: from_start - ramp * compliance * start_force_n,
            compliance_m_per_n: ramp * compliance,
        }
    }

    fn remember(&self, nominal: &Nominal, memory: &mut Memory, done: &Done) {
        let creep = self.creep(nominal, memory, done.start_force_n, done.step_s);
        memory[0] = creep.end_m(done.chain_force_n);
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let [a, ..] = draw.shape;
        Self { dynamic_stiffening: strength, relaxation_time_s: decades(a, 2e-3, 0.3) }
    }

    fn in_service(_nominal: &Nominal, size: f64) -> Self {
        Self { dynamic_stiffening: 0.15 * size, relaxation_time_s: 5e-3 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion};

    const RUBBER: RubberHysteresis =
        RubberHysteresis { dynamic_stiffening: 0.3, relaxation_time_s: 8e-3 };

    /// A dashpot that hardly moves, so that the rubber takes all of the motion.
    fn locked(clearance_2a_m: f64) -> Damper {
        let nominal = Nominal {
            ce_n_s_per_m: 1e14,
            f_relief_n: f64::INFINITY,
            clearance_2a_m,
            ..Nominal::NEW
        };
        Damper::new(nominal, &[RUBBER.into()]).unwrap()
    }

    #[test]
    fn held_deflection_relaxes_to_the_static_stiffness() {
        let damper = locked(0.2e-3);
        let mut state = DamperState::rest();
        let stretched = Motion::new(1.1e-3, 0.0);
        damper.advance(&mut state, stretched, 1e-9);
        for i in 1..=500 {
            let force = damper.advance(&mut state, stretched, 1e-4);
            let decayed = libm::exp(-1e-4 * f64::from(i) / RUBBER.relaxation_time_s);
            let expected = 12.5e6 * 1e-3 * (1.0 + 0.3 * decayed);
            assert!((force / expected - 1.0).abs() < 2e-5, "{i}: {force} {expected}");
        }
    }

    #[test]
    fn unloaded_rubber_springs_back_slowly() {
        // Held until relaxed, then let go by 1 mm: F = 0, and the rest of the deflection creeps
        // back with tau (1 + r).
        let damper = locked(1e-3);
        let mut state = DamperState::rest();
        for _ in 0..1000 {
            damper.advance(&mut state, Motion::new(1.0e-3, 0.0), 1e-3);
        }
        let relaxed = 0.5e-3 * 0.3 / 1.3;
        damper.advance(&mut state, Motion::new(0.0, 0.0), 1e-9);
        for i in 1..=50 {
            assert_eq!(damper.advance(&mut state, Motion::new(0.0, 0.0), 1e-3), 0.0);
            let expected = relaxed * libm::exp(-1e-3 * f64::from(i) / (8e-3 * 1.3));
            assert!((state.creep_m - expected).abs() < 1e-6 * relaxed, "{i}");
        }
    }

    #[test]
    fn complex_stiffness_is_that_of_the_standard_linear_solid() {
        let damper = locked(0.0);
        let amplitude_m = 0.5e-3;
        for hz in [1.0, 5.0, 20.0, 80.0] {
            let w = 2.0 * core::f64::consts::PI * hz;
            let per_cycle = 400;
            let step_s = 1.0 / (hz * f64::from(per_cycle));
            let mut state = DamperState::starting(Motion::new(0.0, amplitude_m * w));
            let (mut real, mut imaginary) = (0.0, 0.0);
            let settle = 10 + (0.2 * hz) as i32;
            for i in 1..=(settle + 1) * per_cycle {
                let t = f64::from(i) * step_s;
                let (sine, cosine) = (libm::sin(w * t), libm::cos(w * t));
                let motion = Motion::new(amplitude_m * sine, amplitude_m * w * cosine);
                let force = damper.advance(&mut state, motion, step_s);
                if i > settle * per_cycle {
                    real += force * sine * 2.0 / (f64::from(per_cycle) * amplitude_m);
                    imaginary += force * cosine * 2.0 / (f64::from(per_cycle) * amplitude_m);
                }
            }
            let wt = w * RUBBER.relaxation_time_s;
            let share = 0.3 / (1.0 + wt * wt);
            let expected = (12.5e6 * (1.0 + share * wt * wt), 12.5e6 * share * wt);
            assert!((real / expected.0 - 1.0).abs() < 1e-4, "{hz} Hz: {real} {expected:?}");
            assert!((imaginary / expected.1 - 1.0).abs() < 1e-3, "{hz} Hz: {imaginary}");
        }
    }
}
