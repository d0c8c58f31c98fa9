//! A body on a spring, a dashpot and further laws, in free-run simulation from the force on it.
//!
//! ```text
//! m y'' = u - k0 y - c0 y' - F(y, y')
//! ```
//!
//! One step is the trapezoidal rule: the mean of the forces at its two ends accelerates the body,
//! and the mean of the two velocities moves it. The velocity at the end is found by Newton's method
//! with the slopes of all forces, kept inside a bracket, so that a stop or a relief that opens
//! within the step does not make it jump. The damper of the core has no slope to ask for: it is the
//! secant through the last two tries.

use super::law::{Law, Trial};
use firmware_core::damper::{Damper, DamperState, Motion};

/// Most evaluations of a step.
const MOST_ITERATIONS: usize = 30;
/// Accuracy of the velocity at the end of a step, as a share of the usual velocity.
const ACCURACY: f64 = 1e-11;
/// A displacement of this many times the usual one counts as a model without a motion.
const RUNAWAY: f64 = 1e3;

/// A body with its numbers, for steps of one length.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Body {
    pub(super) mass_kg: f64,
    pub(super) k0_n_per_m: f64,
    pub(super) c0_n_s_per_m: f64,
    pub(super) laws: Vec<Law>,
    /// The damper of the core, prepared for the step.
    pub(super) damper: Option<Damper>,
    pub(super) step_s: f64,
    /// Usual velocity, m/s, and displacement, m.
    pub(super) velocity_m_per_s: f64,
    pub(super) displacement_m: f64,
}

/// Where a body is.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BodyState {
    pub(super) y: f64,
    pub(super) v: f64,
    /// Force of spring, dashpot and laws, N.
    pub(super) reaction_n: f64,
    /// Force of every law with a memory, N, before and after the step.
    memory: [Vec<f64>; 2],
    /// State of the damper, before and after the step, and the slope of its force, N s/m.
    damper: Option<Box<([DamperState; 2], f64)>>,
}

impl Body {
    /// The body at the beginning of a record; what has a memory has no force there.
    pub(super) fn starting(&self, y: f64, v: f64) -> BodyState {
        let memory = vec![0.0; self.laws.len()];
        let mut scratch = memory.clone();
        let trial = Trial { y, v, travel: 0.0 };
        let forces = self.laws.iter().zip(&mut scratch).map(|(law, z)| law.force(z, &trial).0);
        let reaction_n = self.k0_n_per_m * y + self.c0_n_s_per_m * v + forces.sum::<f64>();
        let rest = DamperState::starting(Motion::new(y, v));
        let damper = self.damper.as_ref().map(|_| Box::new(([rest; 2], 0.0)));
        BodyState { y, v, reaction_n, memory: [memory.clone(), memory], damper }
    }

    /// One step under a mean force; false where the motion has run away.
    #[inline]
    pub(super) fn step(&self, state: &mut BodyState, force_n: f64) -> bool {
        let h = self.step_s;
        let inertia = self.mass_kg / h;
        let (y, v) = (state.y, state.v);
        let push = force_n - 0.5 * state.reaction_n;
        let mut end = v + (force_n - state.reaction_n) / inertia;
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let enough = ACCURACY * self.velocity_m_per_s;
        let mut reaction_n = 0.0;
        let mut at_y = y;
        let mut last_try = None;
        let [before, after] = &mut state.memory;
        for _ in 0..MOST_ITERATIONS {
            let travel = 0.5 * h * (v + end);
            at_y = y + travel;
            reaction_n = self.k0_n_per_m * at_y + self.c0_n_s_per_m * end;
            let mut slope = 0.5 * h * self.k0_n_per_m + self.c0_n_s_per_m;
            let trial = Trial { y: at_y, v: end, travel };
            for ((law, before), after) in self.laws.iter().zip(&*before).zip(&mut *after) {
                *after = *before;
                let (force, over_y, over_v) = law.force(after, &trial);
                reaction_n += force;
                slope += 0.5 * h * over_y + over_v;
            }
            if let (Some(damper), Some(memory)) = (&self.damper, &mut state.damper) {
                let ([before, after], secant) = &mut **memory;
                after.clone_from(before);
                let force = damper.advance(after, Motion::new(at_y, end), h);
                if let Some((last_end, last_force)) = last_try.replace((end, force))
                    && end != last_end
                {
                    // A damper never pushes; a slope below zero is rounding.
                    *secant = ((force - last_force) / (end - last_end)).max(0.0);
                }
                reaction_n += force;
                slope += *secant;
            }
            let miss = inertia * (end - v) + 0.5 * reaction_n - push;
            let newton = miss / (inertia + 0.5 * slope);
            if newton.abs() <= enough || newton.is_nan() {
                break;
            }
            if miss > 0.0 {
                high = end;
            } else {
                low = end;
            }
            let next = end - newton;
            end = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        state.memory.swap(0, 1);
        if let Some(memory) = &mut state.damper {
            memory.0.swap(0, 1);
        }
        state.y = at_y;
        state.v = end;
        state.reaction_n = reaction_n;
        at_y.abs() < RUNAWAY * self.displacement_m && end.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::on_mass::law::{Kind, nominal};

    fn body(step_s: f64, laws: Vec<Law>) -> Body {
        Body {
            damper: None,
            mass_kg: 2.0,
            k0_n_per_m: 5e4,
            c0_n_s_per_m: 10.0,
            laws,
            step_s,
            velocity_m_per_s: 0.1,
            displacement_m: 1e-3,
        }
    }

    #[test]
    fn free_decay_follows_the_closed_form() {
        // y = exp(-d t) (y0 cos w t + (v0 + d y0)/w sin w t), d = c/2m, w^2 = k/m - d^2.
        let step_s = 1e-5;
        let body = body(step_s, Vec::new());
        let mut state = body.starting(1e-3, 0.05);
        let decay = 2.5;
        let w = libm::sqrt(25e3 - decay * decay);
        for step in 1..=50_000 {
            assert!(body.step(&mut state, 0.0));
            let t = step_s * f64::from(step);
            let (sin, cos) = libm::sincos(w * t);
            let exact = libm::exp(-decay * t) * (1e-3 * cos + (0.05 + decay * 1e-3) / w * sin);
            // (w h)^2 / 24 per radian of phase: 1e-7 after 79 rad, of an amplitude of 1 mm.
            assert!((state.y - exact).abs() < 2e-8, "{t}: {} {exact}", state.y);
        }
    }

    #[test]
    fn a_step_is_of_second_order_with_every_law() {
        let laws = |h: f64| {
            let law = |kind, values: &[f64]| Law::new(kind, values, h).unwrap();
            vec![
                vec![law(Kind::CubicStiffness, &[2e10])],
                vec![law(Kind::QuadraticDamping, &[400.0])],
                vec![law(Kind::RelaxingSpring, &[2e4, 5e-3])],
                vec![law(Kind::BoucWen, &[5e4, 800.0, -1100.0])],
                Vec::new(),
            ]
        };
        let end = |h: f64, which: usize| {
            let mut body = body(h, laws(h).swap_remove(which));
            if body.laws.is_empty() {
                let nominal = nominal(&[500.0, 2e5, 1e-4, 30.0, 50.0]).unwrap();
                body.damper = Some(Damper::new(nominal, &[]).unwrap().prepared(h));
            }
            let mut state = body.starting(0.0, 0.0);
            let steps = libm::round(0.2 / h) as usize;
            for step in 0..steps {
                let t = (step as f64 + 0.5) * h;
                assert!(body.step(&mut state, 40.0 * libm::sin(150.0 * t)));
            }
            state.y
        };
        for which in 0..laws(1e-4).len() {
            let fine = end(2.5e-6, which);
            let (coarse, half) = ((end(2e-4, which) - fine).abs(), (end(1e-4, which) - fine).abs());
            // A quarter for the second order; a kink inside a step costs some of it.
            assert!(half < 0.5 * coarse && half < 4e-6, "law {which}: {coarse:e} {half:e}");
        }
    }
}
