//! The damper model of the core as a specimen.

use crate::specimen::{Load, Response, Specimen};
use firmware_core::damper::{Damper, DamperState, HeatBalance, Motion};

/// A damper of the core with its effects. Its oil warms as its `temperature_fade` states, or as
/// that of a yaw damper; where there is a thermometer, the effect follows its reading.
#[derive(Debug, Clone, PartialEq)]
pub struct Modelled {
    /// The damper.
    pub damper: Damper,
}

impl Specimen for Modelled {
    fn longest_step_s(&self) -> f64 {
        100e-6
    }

    fn respond(&self, load: &Load<'_>) -> Response {
        let step_s = load.grid.step_s;
        let damper = self.damper.clone().prepared(step_s);
        let (x, v) = load.at(0);
        let half_clearance_m = 0.5 * damper.nominal().clearance_2a_m;
        let mut state = DamperState::starting(Motion::new(x, v))
            .with_piston_m(x - load.start * half_clearance_m);
        let (heat, mut degc) = (HeatBalance::of(&self.damper), load.start_degc);
        let mut response = Response::default();
        response.force_n.push(0.0);
        response.temperature_degc.push(degc);
        for step in 1..=load.grid.steps {
            if load.is_stopped() {
                break;
            }
            if load.thermometer {
                state.set_temperature_degc(Some(degc));
            }
            let (x, v) = load.at(step);
            let force_n = damper.advance(&mut state, Motion::new(x, v), step_s);
            degc = heat.step(degc, force_n * v, load.ambient_degc, step_s);
            response.force_n.push(force_n);
            response.temperature_degc.push(degc);
        }
        // The first force is not known before the first step; a bench reads it at rest.
        response.force_n[0] = response.force_n.get(1).copied().unwrap_or(0.0);
        response.doubtful_steps = state.fallbacks();
        response
    }
}
