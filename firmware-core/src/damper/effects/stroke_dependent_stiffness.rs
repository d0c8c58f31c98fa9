//! A stiffness that changes along the stroke, as the columns of oil on both sides of the piston do.
//!
//! ```text
//! K -> K (1 + b x_p + q x_p^2)
//! ```
//!
//! A piston off mid-stroke has a shorter column of oil, stiffer, on one side and a longer one on
//! the other. The clearance stays, the whole elastic deflection of the attachment is divided by the
//! factor, which is frozen in each step and held between 0.05 and 20. `x_p` is the position of the
//! piston.
//!
//! Limits: one factor for tension and compression; the creep of rubber is not scaled. Source: the
//! bulk modulus of a column of oil, K = beta A^2/V.

use super::draw::{Draw, between};
use super::parameter::effect_parameters;
use super::{DamperEffect, Memory, Place, Slow};
use crate::damper::Instant;
use crate::damper::nominal::Nominal;
use crate::damper::parts::Factors;

effect_parameters! {
    /// An attachment whose stiffness depends on the position of the piston.
    StrokeDependentStiffness {
        gradient_per_m: PerMetre in -10.0 to 10.0, typical 0.05,
            "Relative change of stiffness per displacement at mid-stroke, 1/m.";
        curvature_per_m2: PerMetre2 in -10.0 to 10.0, typical 0.1,
            "Relative change per displacement squared, 1/m2.";
    }
}

impl StrokeDependentStiffness {
    /// The factor on the stiffness at a position of the piston.
    ///
    /// ```
    /// use firmware_core::damper::effects::StrokeDependentStiffness;
    /// let oil = StrokeDependentStiffness { gradient_per_m: 2.0, curvature_per_m2: 50.0 };
    /// assert!((oil.factor(0.04) - 1.16).abs() < 1e-12);
    /// assert!((oil.factor(-0.04) - 1.0).abs() < 1e-12);
    /// ```
    pub fn factor(&self, piston_m: f64) -> f64 {
        let factor = 1.0 + piston_m * (self.gradient_per_m + self.curvature_per_m2 * piston_m);
        factor.clamp(0.05, 20.0)
    }
}

impl DamperEffect for StrokeDependentStiffness {
    const NAME: &'static str = "stroke_dependent_stiffness";
    const PLACE: Place = Place::Attachment;
    const EQUATION: &'static str = "K -> K (1 + b x_p + q x_p^2)";
    const SHOWN_BY: &'static str =
        "The same small, quick sine at three mean positions, mid-stroke and 40 mm to either side.";
    const SLOW: Slow = Slow::Attachment;
    // Far from mid-stroke a curvature of the usual size is too much to begin with.
    const STARTS: &'static [&'static [f64]] = &[&[0.05, 0.0], &[-0.05, 0.0]];
    const STRONGEST: f64 = 0.18;
    const IN_HYDRAULIC_MODEL: bool = true;

    fn slow(&self, at: &Instant, _memory: &Memory, factors: &mut Factors) {
        factors.compliance_gain /= self.factor(at.piston_m);
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

    const OIL: StrokeDependentStiffness =
        StrokeDependentStiffness { gradient_per_m: 3.0, curvature_per_m2: 100.0 };

    #[test]
    fn quick_deflection_shows_the_stiffness_where_the_piston_is() {
        let damper = Damper::new(Nominal::NEW, &[OIL.into()]).unwrap();
        for piston_m in [-40e-3, 0.0, 25e-3, 40e-3] {
            for side in [-1.0, 1.0] {
                let mut state = DamperState::starting(Motion::new(piston_m, 0.0));
                let there = Motion::new(piston_m + side * 0.6e-3, 0.0);
                let force = damper.advance(&mut state, there, 1e-9);
                // Half a millimetre behind the clearance.
                let expected = side * 0.5e-3 * 12.5e6 * OIL.factor(piston_m);
                assert!((force / expected - 1.0).abs() < 1e-5, "{piston_m}: {force} {expected}");
            }
        }
    }

    #[test]
    fn steady_stroke_knows_no_stiffness() {
        let damper = Damper::new(Nominal::NEW, &[OIL.into()]).unwrap();
        let mut state = DamperState::starting(Motion::new(-30e-3, 8e-3));
        for i in 1..=7500 {
            let motion = Motion::new(-30e-3 + 8e-6 * f64::from(i), 8e-3);
            let force = damper.advance(&mut state, motion, 1e-3);
            // What the changing spring gives back lags by Ce/Ke = 80 ms and is small.
            assert!(i < 1000 || (force - 8e3).abs() < 0.01 * 8e3, "{i}: {force}");
        }
    }

    #[test]
    fn factor_stays_positive() {
        let steep = StrokeDependentStiffness { gradient_per_m: 40.0, curvature_per_m2: 0.0 };
        assert_eq!((steep.factor(-1.0), steep.factor(1.0)), (0.05, 20.0));
    }

    #[test]
    fn no_gradient_is_the_nominal_damper() {
        let even = StrokeDependentStiffness { gradient_per_m: 0.0, curvature_per_m2: 0.0 };
        let (with, plain) =
            (Damper::new(Nominal::NEW, &[even.into()]), Damper::new(Nominal::NEW, &[]));
        let (with, plain) = (with.unwrap(), plain.unwrap());
        let (mut a, mut b) = (DamperState::rest(), DamperState::rest());
        for i in 1..=500 {
            let motion = Motion::new(4e-3 * libm::sin(0.022 * f64::from(i)), 0.0);
            assert_eq!(with.advance(&mut a, motion, 1e-3), plain.advance(&mut b, motion, 1e-3));
        }
    }
}
