//! Oil that thins as it warms, inboard.
//!
//! ```text
//! v = v_nominal(F) exp(k (T - 20 degC))        C T' = |F x_p'| - W (T - 20 degC)
//! ```
//!
//! At equal force the piston is quicker by k per kelvin: Ce and the slope beyond relief fall, the
//! relief force, set by a spring, stays. T is the temperature that was measured, where the caller
//! has set one; otherwise it follows from the heat that the damper turns out, exactly for a
//! constant power in each step, starting at 20 degC in surroundings of 20 degC. k is 0.01 to 0.03
//! 1/K for a laminar slot and below 0.001 1/K for a sharp orifice.
//!
//! The typical heat capacity and cooling are 21 kJ/K and 5 W/K for a yaw damper of 18 kN: a time
//! constant of 70 minutes, 1.4 K in a minute at 490 W. The factor is held between 1e-3 and 1e3, the
//! temperature below 300 degC. Limits: one temperature for all of the oil; force times velocity of
//! the piston counts as heat, also what a gas cushion gives back. Source: a heat balance, and the
//! usual exponential law of viscosity.

use super::draw::{Draw, between, decades};
use super::parameter::{Scale, effect_parameters};
use super::{DamperEffect, Memory, Place, Slow};
use crate::damper::chain::Gains;
use crate::damper::nominal::Nominal;
use crate::damper::parts::Factors;
use crate::damper::{Done, Instant};

/// Where the nominal damper was measured, and what surrounds it, degrees Celsius.
pub const AMBIENT_DEGC: f64 = 20.0;

effect_parameters! {
    /// A viscosity that falls with temperature.
    TemperatureFade {
        fade_per_k: PerKelvin in 0.0 to 0.2, typical 0.02,
            "Relative loss of damping per kelvin, 1/K.";
        heat_capacity_j_per_k: JoulePerKelvin in 1e-2 to 1e7, typical 750.0,
            "Heat that warms the damper by one kelvin, J/K; unused where temperature is measured.";
        cooling_w_per_k: WattPerKelvin in 0.0 to 1e4, typical 0.015,
            "Heat given off per kelvin above the surroundings, W/K; unused likewise.";
    }
}

impl TemperatureFade {
    /// Warmth above the surroundings after a time at constant power, K.
    ///
    /// ```
    /// use firmware_core::damper::effects::TemperatureFade;
    /// let oil = TemperatureFade {
    ///     fade_per_k: 0.02, heat_capacity_j_per_k: 21e3, cooling_w_per_k: 5.0,
    /// };
    /// // 490 W: 1.4 K in the first minute, 98 K in the end.
    /// assert!((oil.warmed_k(0.0, 490.0, 60.0) - 1.39).abs() < 0.005);
    /// assert!((oil.warmed_k(0.0, 490.0, 1e6) - 98.0).abs() < 1e-9);
    /// ```
    pub fn warmed_k(&self, warmth_k: f64, power_w: f64, time_s: f64) -> f64 {
        let capacity = self.heat_capacity_j_per_k;
        let gains = Gains::over(self.cooling_w_per_k / capacity, time_s);
        let excess_w = power_w - self.cooling_w_per_k * warmth_k;
        let warmed_k = warmth_k + gains.velocity_s * excess_w / capacity;
        // Also for a heat capacity so small that there is no number.
        if warmed_k > 0.0 { warmed_k.min(300.0 - AMBIENT_DEGC) } else { 0.0 }
    }
}

impl DamperEffect for TemperatureFade {
    const NAME: &'static str = "temperature_fade";
    const PLACE: Place = Place::Inboard;
    const EQUATION: &'static str = "v = v_nominal(F) exp(k (T - 20)), C T' = |F v_p| - W (T - 20)";
    const SHOWN_BY: &'static str =
        "The same sine at the beginning and the end of a long test, with the temperature logged.";
    const STARTS: &'static [&'static [f64]] = &[&[0.02, 50.0, 0.015], &[0.02, 750.0, 1.0]];
    const SLOW: Slow = Slow::Body;
    const STRONGEST: f64 = 0.2;
    const IN_HYDRAULIC_MODEL: bool = true;

    fn slow(&self, at: &Instant, memory: &Memory, factors: &mut Factors) {
        let [warmth_k, ..] = *memory;
        let warmth_k = at.temperature_degc.map_or(warmth_k, |measured| measured - AMBIENT_DEGC);
        let exponent = (self.fade_per_k * warmth_k).clamp(-6.9, 6.9);
        factors.velocity_gain *= libm::exp(exponent);
    }

    fn remember(&self, _nominal: &Nominal, memory: &mut Memory, done: &Done) {
        let [warmth_k, ..] = *memory;
        let mean_n = 0.5 * (done.start_force_n + done.chain_force_n);
        let power_w = (mean_n * done.piston_travel_m).abs() / done.step_s;
        memory[0] = self.warmed_k(warmth_k, power_w, done.step_s);
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let Scale { force_n, velocity_m_per_s: speed, displacement_m: stroke_m, .. } = draw.scale;
        let [a, b, _] = draw.shape;
        Self {
            fade_per_k: strength,
            heat_capacity_j_per_k: force_n * stroke_m * decades(a, 30.0, 500.0),
            cooling_w_per_k: force_n * speed * between(b, 0.0, 0.02),
        }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        let f = nominal.f_relief_n;
        Self { fade_per_k: 0.02 * size, heat_capacity_j_per_k: 5e-3 * f, cooling_w_per_k: 2e-3 * f }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion};

    const OIL: TemperatureFade =
        TemperatureFade { fade_per_k: 0.02, heat_capacity_j_per_k: 100.0, cooling_w_per_k: 20.0 };

    /// Force and state after a stroke at constant velocity.
    fn pulled(damper: &Damper, measured_degc: Option<f64>, v: f64, steps: i32) -> DamperState {
        let mut state = DamperState::starting(Motion::new(0.0, v));
        for i in 1..=steps {
            state.set_temperature_degc(measured_degc);
            damper.advance(&mut state, Motion::new(v * 1e-3 * f64::from(i), v), 1e-3);
        }
        state
    }

    #[test]
    fn measured_temperature_thins_the_oil_and_leaves_the_relief() {
        let damper = Damper::new(Nominal::NEW, &[OIL.into()]).unwrap();
        for measured in [-20.0, 20.0, 60.0] {
            let gain = libm::exp(0.02 * (measured - 20.0));
            let slow = pulled(&damper, Some(measured), 5e-3, 4000).force_n();
            assert!((slow - 1e6 / gain * 5e-3).abs() < 1e-3, "{measured}: {slow}");
            let v = 0.1 * gain;
            let fast = pulled(&damper, Some(measured), v, 4000).force_n();
            assert!((fast - (18e3 + 80e3 * (0.1 - 0.018))).abs() < 1e-3, "{measured}: {fast}");
        }
        // Where it was measured there is nothing to change, to the bit.
        let plain = Damper::new(Nominal::NEW, &[]).unwrap();
        let there = pulled(&damper, Some(20.0), 5e-3, 300).force_n();
        assert_eq!(there, pulled(&plain, None, 5e-3, 300).force_n());
    }

    #[test]
    fn dissipated_heat_warms_by_the_heat_balance() {
        // Without fade the power is constant: 10 mm/s, 10 kN, 100 W after the spring is stretched.
        let damper =
            Damper::new(Nominal::NEW, &[TemperatureFade { fade_per_k: 0.0, ..OIL }.into()])
                .unwrap();
        let (before, after) =
            (pulled(&damper, None, 0.01, 3000), pulled(&damper, None, 0.01, 8000));
        let settled = 100.0 / 20.0;
        let expected = settled + (before.memory[0][0] - settled) * libm::exp(-20.0 / 100.0 * 5.0);
        assert!((after.memory[0][0] - expected).abs() < 1e-9, "{} {expected}", after.memory[0][0]);
    }

    #[test]
    fn warm_oil_gives_less_force_and_so_less_heat() {
        // In the end W theta = C v^2 exp(-k theta).
        let damper = Damper::new(Nominal::NEW, &[OIL.into()]).unwrap();
        let state = pulled(&damper, None, 0.015, 60_000);
        let warmth = state.memory[0][0];
        let given_off = 20.0 * warmth;
        let turned_out = 1e6 * 0.015 * 0.015 * libm::exp(-0.02 * warmth);
        assert!((given_off / turned_out - 1.0).abs() < 1e-4, "{given_off} {turned_out}");
    }

    #[test]
    fn typical_values_are_those_of_a_yaw_damper() {
        use crate::damper::effects::Table;
        let scale = Nominal::NEW.scale();
        let usual: heapless::Vec<f64, 3> =
            TemperatureFade::PARAMETERS.iter().map(|row| row.usual(&scale)).collect();
        assert!((usual[1] / 21e3 - 1.0).abs() < 0.02 && (usual[2] / 5.0 - 1.0).abs() < 0.05);
    }

    #[test]
    fn oil_that_does_not_thin_is_the_nominal_damper() {
        let with = Damper::new(Nominal::NEW, &[TemperatureFade { fade_per_k: 0.0, ..OIL }.into()]);
        let (with, plain) = (with.unwrap(), Damper::new(Nominal::NEW, &[]).unwrap());
        assert_eq!(
            pulled(&with, None, 0.03, 300).force_n(),
            pulled(&plain, None, 0.03, 300).force_n()
        );
    }
}
