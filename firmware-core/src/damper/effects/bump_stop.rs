//! End stops of the stroke, parallel to the whole damper.
//!
//! ```text
//! F += max(0, k d + c v)     d = x - x_e > 0        F += min(0, k d + c v)     d = x + x_c < 0
//! ```
//!
//! A spring with damping that begins at a distance from mid-stroke on either side. It pushes back
//! and never pulls: leaving faster than the spring expands, the damper's eye parts from the stop.
//!
//! A stop lies beyond half of the travel in a record: no test compresses a stop by more than the
//! travel up to it, and what a fit places nearer to mid-stroke is another effect.
//!
//! Source: general knowledge; the one-sided spring and damper of contact models. Limits: a straight
//! spring, and the damping acts with its full force from first contact.

use super::draw::{Draw, between};
use super::parameter::{Scale, effect_parameters};
use super::{DamperEffect, Memory, Place};
use crate::damper::Done;
use crate::damper::nominal::Nominal;

effect_parameters! {
    /// One-sided springs with damping at both ends of the stroke.
    BumpStop {
        extension_stop_m: MetreOfExtension in 0.5 to 10.0, typical 0.9,
            "Distance from mid-stroke at which the stop in extension begins, m.";
        compression_stop_m: MetreOfCompression in 0.5 to 10.0, typical 0.9,
            "Distance from mid-stroke at which the stop in compression begins, m.";
        stiffness_n_per_m: NewtonPerMetre in 0.0 to 10000.0, typical 5.0,
            "Stiffness of a stop, N/m.";
        damping_n_s_per_m: NewtonSecondPerMetre in 0.0 to 100.0, typical 0.05,
            "Damping of a stop while it is touched, N s/m.";
    }
}

impl BumpStop {
    /// Force of the stops, N.
    ///
    /// ```
    /// use firmware_core::damper::effects::BumpStop;
    /// let stop = BumpStop {
    ///     extension_stop_m: 0.1,
    ///     compression_stop_m: 0.08,
    ///     stiffness_n_per_m: 2e6,
    ///     damping_n_s_per_m: 1e4,
    /// };
    /// assert_eq!(stop.force_n(0.09, 0.0), 0.0);
    /// assert!((stop.force_n(0.11, 0.1) - 21.0e3).abs() < 1e-6);
    /// assert!((stop.force_n(-0.09, 0.0) + 20.0e3).abs() < 1e-6);
    /// // Leaving so fast, it parts from the stop.
    /// assert_eq!(stop.force_n(0.101, -0.5), 0.0);
    /// ```
    pub fn force_n(&self, displacement_m: f64, velocity_m_per_s: f64) -> f64 {
        let push_n = |depth_m: f64, velocity: f64| {
            if depth_m > 0.0 {
                (self.stiffness_n_per_m * depth_m + self.damping_n_s_per_m * velocity).max(0.0)
            } else {
                0.0
            }
        };
        push_n(displacement_m - self.extension_stop_m, velocity_m_per_s)
            - push_n(-displacement_m - self.compression_stop_m, -velocity_m_per_s)
    }
}

impl DamperEffect for BumpStop {
    const NAME: &'static str = "bump_stop";
    const PLACE: Place = Place::Parallel;
    const EQUATION: &'static str = "F += max(0, k (x - x_e) + c v) + min(0, k (x + x_c) + c v)";
    const SHOWN_BY: &'static str =
        "Slow strokes up to either end of the travel, with the direction of extension declared.";
    const DIRECTIONAL: bool = true;
    // A stop at either end, barely touched or well within reach, or at one of them.
    const STARTS: &'static [&'static [f64]] = &[
        &[0.97, 0.97, 5.0, 0.0],
        &[0.7, 0.7, 5.0, 0.05],
        &[0.8, 3.0, 5.0, 0.05],
        &[3.0, 0.8, 5.0, 0.05],
    ];
    const STRONGEST: f64 = 0.95;
    const IN_HYDRAULIC_MODEL: bool = false;

    fn output(&self, _memory: &mut Memory, done: &Done, force_n: f64) -> f64 {
        force_n + self.force_n(done.motion.displacement_m, done.end_velocity_m_per_s)
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let Scale { force_n, velocity_m_per_s: speed, displacement_m: stroke_m, .. } = draw.scale;
        let Scale { extension_m, compression_m, .. } = draw.scale;
        let [a, b, c] = draw.shape;
        // Both ends come nearer; the stops are not quite alike.
        Self {
            extension_stop_m: extension_m * (1.0 - strength),
            compression_stop_m: compression_m * (1.0 - strength * between(c, 0.8, 1.0)),
            stiffness_n_per_m: force_n / stroke_m * between(a, 0.5, 5.0),
            damping_n_s_per_m: force_n / speed * between(b, 0.0, 0.05),
        }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        let f = nominal.f_relief_n;
        Self {
            extension_stop_m: 2.5e-3,
            compression_stop_m: 3.1e-3,
            stiffness_n_per_m: 100.0 * size * f,
            damping_n_s_per_m: 0.3 * size * f,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion, Nominal};

    const STOP: BumpStop = BumpStop {
        extension_stop_m: 20e-3,
        compression_stop_m: 10e-3,
        stiffness_n_per_m: 3e6,
        damping_n_s_per_m: 0.0,
    };

    fn added(damper: &Damper, motion: impl Fn(f64) -> Motion, check: impl Fn(f64, f64)) {
        let mut state = DamperState::starting(motion(0.0));
        for i in 1..=2000 {
            let t = 1e-3 * f64::from(i);
            let force = damper.advance(&mut state, motion(t), 1e-3);
            check(t, force - state.chain_force_n());
        }
    }

    #[test]
    fn each_end_has_its_own_stop() {
        let damper = Damper::new(Nominal::NEW, &[STOP.into()]).unwrap();
        let motion = |t: f64| Motion::new(30e-3 * libm::sin(6.0 * t), 0.18 * libm::cos(6.0 * t));
        added(&damper, motion, |t, force| {
            let x = motion(t).displacement_m;
            let expected = 3e6 * ((x - 20e-3).max(0.0) + (x + 10e-3).min(0.0));
            assert!((force - expected).abs() < 1e-6, "{t}: {force} {expected}");
        });
    }

    #[test]
    fn damped_stop_never_pulls() {
        let damped = BumpStop { damping_n_s_per_m: 2e5, ..STOP };
        let damper = Damper::new(Nominal::NEW, &[damped.into()]).unwrap();
        let motion = |t: f64| Motion::new(30e-3 * libm::sin(6.0 * t), 0.18 * libm::cos(6.0 * t));
        added(&damper, motion, |t, force| {
            let Motion { displacement_m: x, velocity_m_per_s: v } = motion(t);
            assert!(force * x >= 0.0, "{t}: {force}");
            let expected = if x > 20e-3 { (3e6 * (x - 20e-3) + 2e5 * v).max(0.0) } else { 0.0 };
            // Velocity of the parabola instead of the sine's.
            assert!(x < -10e-3 || (force - expected).abs() < 0.2, "{t}: {force} {expected}");
        });
    }

    #[test]
    fn stop_out_of_reach_does_nothing() {
        let damper = Damper::new(Nominal::NEW, &[STOP.into()]).unwrap();
        let motion = |t: f64| Motion::new(9.9e-3 * libm::sin(6.0 * t), 0.06 * libm::cos(6.0 * t));
        added(&damper, motion, |_, force| assert_eq!(force, 0.0));
    }
}
