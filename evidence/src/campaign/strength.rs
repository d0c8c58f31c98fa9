//! One number for every effect of the catalogue, from vanishing (0) to strong.
//!
//! Which parameter grows with it, and how, is in [`Strength::values`]; the parameters that give the
//! effect its shape are drawn once per case. Sizes are in those of the damper and its tests
//! ([`Scale`]: relief force, greatest velocity and greatest stroke around the middle of a test).

use firmware_core::damper::effects::{CATALOGUE, EffectInfo, Scale};
use firmware_core::damper::{Effect, Nominal};
use virtual_bench::bench_visit::random::Random;

/// An effect of a drawn shape, whose strength is still open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Strength {
    /// The effect.
    pub info: &'static EffectInfo,
    scale: Scale,
    nominal: Nominal,
    /// Farthest positions, m: extension, compression.
    reach_m: [f64; 2],
    /// Numbers between 0 and 1 that make the shape.
    shape: [f64; 3],
    sign: f64,
}

/// Greatest speed and stroke of sines, m/s and m, at a scale of one.
const FASTEST_M_PER_S: f64 = 0.176;
const STROKE_M: f64 = 8e-3;
/// Farthest positions of the tests, m.
const FARTHEST_M: [f64; 2] = [43.46e-3, 20e-3];

impl Strength {
    /// Draws the shape of an effect for a damper in tests of a scale.
    pub(super) fn draw(effect: usize, nominal: Nominal, scale: f64, random: &mut Random) -> Self {
        let shape = [random.uniform(), random.uniform(), random.uniform()];
        let sign = if random.uniform() < 0.5 { -1.0 } else { 1.0 };
        Self {
            info: &CATALOGUE[effect % CATALOGUE.len()],
            scale: Scale {
                force_n: nominal.f_relief_n,
                velocity_m_per_s: scale * FASTEST_M_PER_S,
                displacement_m: scale * STROKE_M,
                extension_m: scale * FARTHEST_M[0],
                compression_m: scale * FARTHEST_M[1],
            },
            nominal,
            reach_m: FARTHEST_M.map(|m| scale * m),
            shape,
            sign,
        }
    }

    /// The largest strength that is still a damper.
    pub(super) fn strongest(&self) -> f64 {
        match self.info.name {
            "seal_friction" | "asymmetric_damping" | "gas_preload" => 0.6,
            "orifice_leakage" | "entrained_air" => 3.0,
            "second_valve_stage" => 30.0,
            "position_dependent_damping" | "stroke_dependent_stiffness" => 0.18,
            "temperature_fade" => 0.2,
            "rubber_hysteresis" | "aeration_memory" => 5.0,
            "cavitation" => 6.0,
            "clearance_impact" => 0.05,
            "bump_stop" => 0.95,
            "force_offset" => 0.5,
            "clearance_growth" | "moving_mass" | "sensor_delay" => 0.02,
            // quadratic_orifice, stiffening_attachment
            _ => 300.0,
        }
    }

    /// The effect at a strength, if there is such a one.
    pub(super) fn at(&self, k: f64) -> Option<Effect> {
        Effect::from_values(self.info.name, &self.values(k)).ok()
    }

    /// The parameters at a strength, in the order of the effect's table.
    pub(super) fn values(&self, k: f64) -> Vec<f64> {
        let Scale { force_n: force, velocity_m_per_s: speed, displacement_m: stroke, .. } =
            self.scale;
        let [a, b, c] = self.shape;
        let between = |share: f64, from: f64, to: f64| from + share * (to - from);
        // Evenly over decades.
        let decades = |share: f64, from: f64, to: f64| from * libm::pow(to / from, share);
        match self.info.name {
            "seal_friction" => vec![k * force, between(a, 1.0, 1.6), speed * between(b, 0.02, 0.1)],
            "quadratic_orifice" => vec![k * force / (speed * speed)],
            "orifice_leakage" => vec![k * speed],
            "second_valve_stage" => {
                // Another slope than the one before: steeper or flatter.
                let ratio = if self.sign > 0.0 { 1.0 + k } else { 1.0 / (1.0 + k) };
                vec![force * between(a, 0.25, 0.8), ratio]
            }
            "asymmetric_damping" => {
                vec![self.sign * k, self.sign * k * between(a, 0.5, 1.5)]
            }
            "position_dependent_damping" | "stroke_dependent_stiffness" => {
                let curvature = k / (stroke * stroke) * between(a, 0.0, 0.3);
                vec![self.sign * k / stroke, curvature]
            }
            "temperature_fade" => {
                let capacity = force * stroke * decades(a, 30.0, 500.0);
                vec![k, capacity, force * speed * between(b, 0.0, 0.02)]
            }
            "gas_preload" => vec![k * force, k * force / stroke * between(a, 0.0, 0.2)],
            "stiffening_attachment" => vec![k / (stroke * stroke)],
            "rubber_hysteresis" => vec![k, decades(a, 2e-3, 0.3)],
            "entrained_air" => vec![k * stroke, force * decades(a, 0.02, 0.3)],
            "fixture_compliance" => vec![self.nominal.ke_n_per_m * between(a, 3.0, 10.0)],
            "aeration_memory" => {
                vec![k, stroke * decades(a, 20.0, 300.0), decades(b, 3.0, 100.0)]
            }
            "cavitation" => vec![self.sign * speed * libm::exp(-k)],
            "clearance_impact" => {
                let kilogram = force * stroke / (speed * speed);
                vec![k * kilogram, force / stroke * decades(a, 5.0, 60.0), between(b, 0.05, 0.2)]
            }
            "moving_mass" => vec![k * force * stroke / (speed * speed)],
            "bump_stop" => {
                let [out, back] = self.reach_m;
                let stiffness = force / stroke * between(a, 0.5, 5.0);
                let damping = force / speed * between(b, 0.0, 0.05);
                // Both ends come nearer; the stops are not quite alike.
                vec![out * (1.0 - k), back * (1.0 - k * between(c, 0.8, 1.0)), stiffness, damping]
            }
            "force_offset" => vec![self.sign * k * force],
            // clearance_growth, sensor_delay
            _ => vec![k],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_core::damper::Damper;

    #[test]
    fn every_effect_can_be_weak_and_strong() {
        for effect in 0..CATALOGUE.len() {
            for seed in 0..8 {
                let mut random = Random::new(seed, 0);
                let strength = Strength::draw(effect, Nominal::NEW, 1.0, &mut random);
                for share in [1e-6, 1e-3, 0.1, 1.0] {
                    let k = share * strength.strongest();
                    let effect = strength.at(k);
                    assert!(effect.is_some(), "{} {k}", strength.info.name);
                    let damper = Damper::new(Nominal::NEW, effect.as_slice());
                    assert!(damper.is_ok(), "{} {k} {damper:?}", strength.info.name);
                }
            }
        }
    }
}
