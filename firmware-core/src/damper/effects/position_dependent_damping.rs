//! Damping that changes along the stroke, inboard.
//!
//! ```text
//! F_h(v) -> m(x_d) F_h(v)        m = 1 + b x_d + q x_d^2
//! ```
//!
//! with the position `x_d` of the piston, not of the eye: the two differ by the deflection of the
//! attachment. m is frozen in each step. It is held at 0.05 below and at 20 above, so that the law
//! rises wherever the piston goes.

use super::draw::{Draw, between};
use super::parameter::effect_parameters;
use super::{DamperEffect, Memory, Place, Slow};
use crate::damper::Instant;
use crate::damper::nominal::Nominal;
use crate::damper::parts::Factors;

effect_parameters! {
    /// A hydraulic force that depends on the position of the piston.
    PositionDependentDamping {
        gradient_per_m: PerMetre in -10.0 to 10.0, typical 0.05,
            "Relative change of the hydraulic force per displacement at mid-stroke, 1/m.";
        curvature_per_m2: PerMetre2 in -10.0 to 10.0, typical 0.1,
            "Relative change per displacement squared, 1/m2.";
    }
}

impl PositionDependentDamping {
    /// The factor at a position of the piston.
    ///
    /// ```
    /// use firmware_core::damper::effects::PositionDependentDamping;
    /// let bore = PositionDependentDamping { gradient_per_m: 2.0, curvature_per_m2: 400.0 };
    /// assert!((bore.factor(0.05) - 2.1).abs() < 1e-12);
    /// assert!((bore.factor(-0.05) - 1.9).abs() < 1e-12);
    /// ```
    pub fn factor(&self, piston_m: f64) -> f64 {
        let factor = 1.0 + piston_m * (self.gradient_per_m + self.curvature_per_m2 * piston_m);
        factor.clamp(0.05, 20.0)
    }
}

impl DamperEffect for PositionDependentDamping {
    const NAME: &'static str = "position_dependent_damping";
    const PLACE: Place = Place::Inboard;
    const EQUATION: &'static str = "F_h -> F_h (1 + b x_d + q x_d^2)";
    const SHOWN_BY: &'static str =
        "The same sine at three mean positions, mid-stroke and 40 mm to either side.";
    const SLOW: Slow = Slow::Body;
    // Far from mid-stroke a curvature of the usual size is too much to begin with.
    const STARTS: &'static [&'static [f64]] = &[&[0.05, 0.0], &[-0.05, 0.0]];
    const STRONGEST: f64 = 0.18;
    const IN_HYDRAULIC_MODEL: bool = false;

    fn slow(&self, at: &Instant, _memory: &Memory, factors: &mut Factors) {
        factors.force_gain *= self.factor(at.piston_m);
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let stroke_m = draw.scale.displacement_m;
        let [a, ..] = draw.shape;
        let curvature = strength / (stroke_m * stroke_m) * between(a, 0.0, 0.3);
        Self { gradient_per_m: draw.sign * strength / stroke_m, curvature_per_m2: curvature }
    }

    fn in_service(_nominal: &Nominal, size: f64) -> Self {
        Self { gradient_per_m: 6.0 * size, curvature_per_m2: 800.0 * size }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion, Nominal};

    #[test]
    fn force_follows_the_factor_along_the_stroke() {
        // A stiff attachment: the piston is where the eye is.
        let nominal = Nominal { ke_n_per_m: 1e9, clearance_2a_m: 0.0, ..Nominal::NEW };
        let bore = PositionDependentDamping { gradient_per_m: 4.0, curvature_per_m2: 900.0 };
        let damper = Damper::new(nominal, &[bore.into()]).unwrap();
        for velocity in [5e-3, 0.05] {
            let mut state = DamperState::starting(Motion::new(-20e-3, velocity));
            let plain = damper.steady_force_n(velocity);
            let steps = libm::round(40e-3 / (velocity * 1e-3)) as i32;
            for i in 1..=steps {
                let x = -20e-3 + velocity * 1e-3 * f64::from(i);
                let force = damper.advance(&mut state, Motion::new(x, velocity), 1e-3);
                let expected = plain * bore.factor(state.piston_m());
                // The spring follows with a lag of Ce/Ke = 1 ms.
                let lag = 2e-3 * velocity * plain * (4.0 + 1800.0 * x.abs());
                assert!(i < 50 || (force - expected).abs() < lag, "{x}: {force} {expected}");
            }
        }
    }

    #[test]
    fn elastic_part_of_the_loop_knows_no_position() {
        // Far from relief and fast: the attachment carries the motion, the bore does not matter.
        let bore = PositionDependentDamping { gradient_per_m: 4.0, curvature_per_m2: 900.0 };
        let at = |effects: &[crate::damper::Effect]| {
            let nominal = Nominal { ce_n_s_per_m: 1e9, f_relief_n: 1e9, ..Nominal::NEW };
            let damper = Damper::new(nominal, effects).unwrap();
            damper.advance(&mut DamperState::rest(), Motion::new(1e-3, 0.0), 1e-3)
        };
        assert!((at(&[bore.into()]) / at(&[]) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn factor_stays_positive() {
        let bore = PositionDependentDamping { gradient_per_m: 40.0, curvature_per_m2: 0.0 };
        assert_eq!(bore.factor(-1.0), 0.05);
        assert_eq!(bore.factor(1.0), 20.0);
    }
}
