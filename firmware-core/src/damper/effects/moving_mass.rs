//! Mass that moves between the load cell and the damper.
//!
//! ```text
//! F += m x''
//! ```
//!
//! Rod, eye and clamp follow the moving end; the load cell feels what accelerates them. The
//! acceleration at the end of a step is that of a third-order polynomial through the last four
//! velocities, so its error is (w h)^3/4 of itself at frequency w. A caller without velocities has
//! corners instead of accelerations and gets none.
//!
//! Source: Newton. Limits: in a vehicle such a force would close an algebraic loop; there the mass
//! belongs to the bodies and this effect is left out. At a single frequency it equals a negative
//! parallel spring.

use super::draw::Draw;
use super::parameter::{Scale, effect_parameters};
use super::{DamperEffect, Memory, Place};
use crate::damper::Done;
use crate::damper::nominal::Nominal;

effect_parameters! {
    /// A mass accelerated with the moving end.
    MovingMass {
        mass_kg: Kilogram in 0.0 to 100.0, typical 0.0001,
            "Mass between the load cell and the damper, kg.";
    }
}

/// Acceleration at the end of a piece, and the memory for the next step: the last two mean
/// accelerations and the lengths of their steps.
fn acceleration(memory: &mut Memory, done: &Done) -> f64 {
    let [a1, h1, a2, h2] = *memory;
    let (a0, h0) = (done.acceleration_m_per_s2, done.whole_s);
    // Time from the end of the whole step, zero or before it.
    let t = -done.ahead_s;
    let mut acceleration = a0;
    if h1 > 0.0 {
        // Divided differences of the velocity.
        let second = (a0 - a1) / (h0 + h1);
        acceleration += (2.0 * t + h0) * second;
        if h2 > 0.0 {
            let third = (second - (a1 - a2) / (h1 + h2)) / (h0 + h1 + h2);
            let (c1, c2) = (h0, h0 + h1);
            acceleration += (3.0 * t * t + 2.0 * t * (c1 + c2) + c1 * c2) * third;
        }
    }
    if done.ahead_s == 0.0 {
        *memory = [a0, h0, a1, h1];
    }
    acceleration
}

impl DamperEffect for MovingMass {
    const NAME: &'static str = "moving_mass";
    const PLACE: Place = Place::Parallel;
    const EQUATION: &'static str = "F += m x''";
    const SHOWN_BY: &'static str = "Sines over a frequency ratio of three or more; the same with the other end of the damper free.";
    const STRONGEST: f64 = 0.02;
    const IN_HYDRAULIC_MODEL: bool = true;

    fn output(&self, memory: &mut Memory, done: &Done, force_n: f64) -> f64 {
        force_n + self.mass_kg * acceleration(memory, done)
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let Scale { force_n, velocity_m_per_s: speed, displacement_m: stroke_m, .. } = draw.scale;
        Self { mass_kg: strength * force_n * stroke_m / (speed * speed) }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        Self { mass_kg: 0.003 * size * nominal.f_relief_n }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion, Nominal};

    const MASS: MovingMass = MovingMass { mass_kg: 20.0 };

    /// What the mass adds, at the end of each step.
    fn added(motion: impl Fn(f64) -> Motion, step_s: f64, steps: u32) -> impl Iterator<Item = f64> {
        let with = Damper::new(Nominal::NEW, &[MASS.into()]).unwrap();
        let mut state = DamperState::starting(motion(0.0));
        (1..=steps).map(move |i| {
            let force = with.advance(&mut state, motion(f64::from(i) * step_s), step_s);
            force - state.chain_force_n()
        })
    }

    #[test]
    fn sine_meets_the_published_inertia() {
        // 20 kg, 3.5 Hz, 3.46 mm: 33 N; against x in phase.
        let w = 2.0 * core::f64::consts::PI * 3.5;
        let motion =
            |t: f64| Motion::new(3.46e-3 * libm::sin(w * t), 3.46e-3 * w * libm::cos(w * t));
        let mut largest = 0.0_f64;
        for (i, force) in added(motion, 1e-3, 600).enumerate() {
            let expected = -20.0 * w * w * motion((i as f64 + 1.0) * 1e-3).displacement_m;
            // One and two velocities have to do at the start.
            assert!(i < 3 || (force - expected).abs() < 2e-4, "{i}: {force} {expected}");
            largest = largest.max(force);
        }
        assert!((largest - 33.46).abs() < 0.01, "{largest}");
    }

    #[test]
    fn quartic_motion_has_its_acceleration_exactly() {
        let motion = |t: f64| Motion::new(t * t * t * t, 4.0 * t * t * t);
        for (i, force) in added(motion, 5e-3, 50).enumerate() {
            let t = (i as f64 + 1.0) * 5e-3;
            assert!(i < 2 || (force - 240.0 * t * t).abs() < 1e-9, "{i}: {force}");
        }
    }

    #[test]
    fn constant_velocity_and_straight_lines_have_none() {
        let steady = |t: f64| Motion::new(0.01 * t, 0.01);
        assert!(added(steady, 1e-3, 100).all(|force| force == 0.0));
        let straight = |t: f64| Motion::new(1e-3 * libm::sin(30.0 * t), 0.0);
        assert!(added(straight, 1e-3, 100).all(|force| force == 0.0));
    }
}
