//! Damping that changes along the stroke, inboard.
//!
//! ```text
//! F_h(v) -> m(x_d) F_h(v)        m = 1 + b x_d + q x_d^2
//! ```
//!
//! with the position x_d of the piston, not of the eye: the two differ by the deflection of the
//! attachment. m is frozen at mid-step. It is held at 0.05 below and at 20 above, so that the law
//! rises wherever the piston goes.

use super::parameter::effect_parameters;
use super::{DamperEffect, Memory, Place};
use crate::damper::MidStep;
use crate::damper::law::Factors;

effect_parameters! {
    /// A hydraulic force that depends on the position of the piston.
    PositionDependentDamping {
        gradient_per_m: PerMetre in -1.0 to 1.0, typical 0.05,
            "Relative change of the hydraulic force per displacement at mid-stroke, 1/m.";
        curvature_per_m2: PerMetre2 in -1.0 to 10.0, typical 0.1,
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
    const SLOW: bool = true;

    fn slow(&self, at: &MidStep, _memory: &Memory, factors: &mut Factors) {
        factors.force_gain *= self.factor(at.piston_m);
    }
}
