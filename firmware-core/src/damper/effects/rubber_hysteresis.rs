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
//! Limit: linear rubber, no softening with amplitude.

use super::parameter::effect_parameters;
use super::{DamperEffect, Memory, Place};
use crate::damper::Done;
use crate::damper::implicit::Creep;
use crate::damper::law::Parts;
use crate::damper::nominal::Nominal;
use crate::damper::series::Gains;

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
    const CREEPS: bool = true;

    fn shape(&self, parts: &mut Parts, nominal: &Nominal) {
        let (compliance, _) = self.creep_of(nominal);
        parts.attachment.add_line(-compliance);
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
}
