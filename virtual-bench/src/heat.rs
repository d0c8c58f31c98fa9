//! The temperature of the oil over a test.

use crate::specimen::Load;
use firmware_core::damper::HeatBalance;

/// The temperature over time, from displacement and force.
pub(crate) fn temperatures_degc(heat: HeatBalance, load: &Load<'_>, force_n: &[f64]) -> Vec<f64> {
    let mut degc = load.start_degc;
    let mut temperatures = Vec::with_capacity(force_n.len());
    for (step, force) in force_n.iter().enumerate() {
        temperatures.push(degc);
        let power_w = force * load.at(step).1;
        degc = heat.step(degc, power_w, load.ambient_degc, load.grid.step_s);
    }
    temperatures
}
