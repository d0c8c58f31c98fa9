//! How the oil of a damper warms.

use crate::specimen::Load;

/// A heat balance: `C T' = |F v| - H (T - T_ambient)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeatBalance {
    /// Heat capacity C, J/K.
    pub capacity_j_per_k: f64,
    /// Cooling H, W/K.
    pub cooling_w_per_k: f64,
}

impl HeatBalance {
    /// A yaw damper of some 20 kg in still air (estimated).
    pub const YAW_DAMPER: Self = Self { capacity_j_per_k: 21e3, cooling_w_per_k: 5.0 };

    /// The temperature after a constant power.
    ///
    /// ```
    /// use virtual_bench::bench_visit::HeatBalance;
    /// // 74 J a cycle at 3.5 Hz are a quarter of a kilowatt: 0.7 K in a minute.
    /// let degc = HeatBalance::YAW_DAMPER.after(20.0, 74.0 * 3.5, 20.0, 60.0);
    /// assert!((degc - 20.73).abs() < 0.01);
    /// ```
    pub fn after(&self, degc: f64, power_w: f64, ambient_degc: f64, duration_s: f64) -> f64 {
        let rest_degc = ambient_degc + power_w / self.cooling_w_per_k;
        let decay = libm::exp(-self.cooling_w_per_k / self.capacity_j_per_k * duration_s);
        rest_degc + (degc - rest_degc) * decay
    }

    pub(crate) fn step(&self, degc: f64, power_w: f64, ambient_degc: f64, step_s: f64) -> f64 {
        let rate = (power_w - self.cooling_w_per_k * (degc - ambient_degc)) / self.capacity_j_per_k;
        degc + step_s * rate
    }

    /// The temperature over time, from displacement and force.
    pub(crate) fn over(&self, load: &Load<'_>, force_n: &[f64]) -> Vec<f64> {
        let mut degc = load.start_degc;
        let mut temperatures = Vec::with_capacity(force_n.len());
        for (step, force) in force_n.iter().enumerate() {
            temperatures.push(degc);
            let power_w = force * load.at(step).1;
            degc = self.step(degc, power_w, load.ambient_degc, load.grid.step_s);
        }
        temperatures
    }
}
