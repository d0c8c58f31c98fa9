//! What acts on the force of the chain: blows, mass, stops, friction, the sensor. Written with the
//! exact motion, its exact derivatives, and Runge-Kutta.

use super::Instant;
use firmware_core::damper::Effect;
use firmware_core::damper::effects::{
    BumpStop, ClearanceImpact, ForceOffset, MovingMass, PreslidingFriction, SensorDelay,
};

/// The effects outside of the chain and what they remember.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outside {
    impact: Option<ClearanceImpact>,
    mass: Option<MovingMass>,
    stop: Option<BumpStop>,
    rubbing: Option<PreslidingFriction>,
    offset: Option<ForceOffset>,
    delay: Option<SensorDelay>,
    acts: bool,
    touching: bool,
    ringing: [f64; 2],
    rubbed_n: f64,
    past_n: Vec<f64>,
}

impl Outside {
    /// Takes an effect that acts outside; false for any other.
    pub(crate) fn take(&mut self, effect: Effect) -> bool {
        match effect {
            Effect::ClearanceImpact(effect) => self.impact = Some(effect),
            Effect::MovingMass(effect) => self.mass = Some(effect),
            Effect::BumpStop(effect) => self.stop = Some(effect),
            Effect::PreslidingFriction(effect) => self.rubbing = Some(effect),
            Effect::ForceOffset(effect) => self.offset = Some(effect),
            Effect::SensorDelay(effect) => self.delay = Some(effect),
            _ => return false,
        }
        self.acts = true;
        true
    }

    /// True when the velocity of the piston matters.
    pub(crate) fn strikes(&self) -> bool {
        self.impact.is_some()
    }

    /// The reading `h` later, from the force of the chain and the velocity of the piston.
    pub(crate) fn read(
        &mut self,
        h: f64,
        at: &Instant,
        chain_n: f64,
        piston_m_per_s: f64,
        tight: bool,
    ) -> f64 {
        if !self.acts {
            return chain_n;
        }
        let (x, v) = (at.displacement_m, at.velocity_m_per_s);
        let mut force = chain_n;
        if let Some(impact) = self.impact {
            let (k, m) = (impact.seat_n_per_m, impact.end_mass_kg);
            let c = 2.0 * impact.damping_ratio * libm::sqrt(k * m);
            self.ringing = runge_kutta(self.ringing, h, |[z, u]| [u, -(k * z + c * u) / m]);
            if chain_n != 0.0 && !self.touching && !tight {
                self.ringing[1] += v - piston_m_per_s;
            }
            self.touching = chain_n != 0.0;
            force += k * self.ringing[0];
        }
        if let Some(mass) = self.mass {
            force += mass.mass_kg * at.acceleration_m_per_s2;
        }
        if let Some(stop) = self.stop {
            for (sign, from) in [(1.0, stop.extension_stop_m), (-1.0, stop.compression_stop_m)] {
                let depth = sign * x - from;
                if depth > 0.0 {
                    let push = stop.stiffness_n_per_m * depth + stop.damping_n_s_per_m * sign * v;
                    force += sign * push.max(0.0);
                }
            }
        }
        if let Some(friction) = self.rubbing {
            // The equation over time, by the midpoint rule.
            let f0 = friction.capacity_n;
            let speed = v - 0.5 * h * at.acceleration_m_per_s2;
            let u = speed / friction.stribeck_m_per_s;
            let capacity = f0
                * (1.0 + speed.signum() * friction.direction_asymmetry)
                * (1.0 + friction.low_speed_rise * libm::exp(-u * u));
            let rate = |z: f64| f0 / friction.travel_m * (speed - z / capacity * speed.abs());
            let middle = self.rubbed_n + 0.5 * h * rate(self.rubbed_n);
            self.rubbed_n += h * rate(middle);
            force += self.rubbed_n;
        }
        force += self.offset.map_or(0.0, |offset| offset.offset_n);
        let Some(delay) = self.delay else { return force };
        self.past_n.push(force);
        let late = (delay.delay_s / h).round() as usize;
        self.past_n.len().checked_sub(late + 1).map_or(0.0, |i| self.past_n[i])
    }
}

fn runge_kutta(at: [f64; 2], h: f64, rate: impl Fn([f64; 2]) -> [f64; 2]) -> [f64; 2] {
    let on = |k: [f64; 2], share: f64| [at[0] + share * h * k[0], at[1] + share * h * k[1]];
    let a = rate(at);
    let b = rate(on(a, 0.5));
    let c = rate(on(b, 0.5));
    let d = rate(on(c, 1.0));
    let sum = |i: usize| at[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
    [sum(0), sum(1)]
}
