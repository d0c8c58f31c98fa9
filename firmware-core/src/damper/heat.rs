//! How the oil of a damper warms.
//!
//! ```text
//! C T' = F v - H (T - T_ambient)
//! ```
//!
//! One temperature for all of the oil and its steel. What the attachment stores comes back within a
//! cycle of the motion, so the power over a cycle is what the damper dissipates.

use super::{Damper, Effect};

/// A heat balance.
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

    /// That of a damper: as its `temperature_fade` states, or that of a yaw damper.
    pub fn of(damper: &Damper) -> Self {
        let fades = damper.effects().iter().find_map(|effect| match effect {
            Effect::TemperatureFade(oil) => Some(Self {
                capacity_j_per_k: oil.heat_capacity_j_per_k,
                cooling_w_per_k: oil.cooling_w_per_k,
            }),
            _ => None,
        });
        fades.unwrap_or(Self::YAW_DAMPER)
    }

    /// The temperature after a time of any length with a constant power, degrees Celsius.
    ///
    /// ```
    /// use firmware_core::damper::HeatBalance;
    /// // 74 J a cycle at 3.5 Hz are a quarter of a kilowatt: 0.7 K in a minute.
    /// let degc = HeatBalance::YAW_DAMPER.after(20.0, 74.0 * 3.5, 20.0, 60.0);
    /// assert!((degc - 20.73).abs() < 0.01);
    /// ```
    #[must_use]
    pub fn after(&self, degc: f64, power_w: f64, ambient_degc: f64, duration_s: f64) -> f64 {
        debug_assert!(self.cooling_w_per_k > 0.0 && self.capacity_j_per_k > 0.0);
        let rest_degc = ambient_degc + power_w / self.cooling_w_per_k;
        let decay = libm::exp(-self.cooling_w_per_k / self.capacity_j_per_k * duration_s);
        rest_degc + (degc - rest_degc) * decay
    }

    /// The temperature after a step with this power, degrees Celsius.
    ///
    /// ```
    /// use firmware_core::damper::HeatBalance;
    /// // 1 kW warms a yaw damper of 21 kJ/K by one kelvin in 21 s.
    /// let warmer = HeatBalance::YAW_DAMPER.step(20.0, 1000.0, 20.0, 21.0);
    /// assert!((warmer - 21.0).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn step(&self, degc: f64, power_w: f64, ambient_degc: f64, step_s: f64) -> f64 {
        let rate = (power_w - self.cooling_w_per_k * (degc - ambient_degc)) / self.capacity_j_per_k;
        degc + step_s * rate
    }
}
