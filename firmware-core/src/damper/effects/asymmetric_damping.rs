//! Extension and compression throttled differently, inboard.
//!
//! ```text
//! Ce (1 + g sgn v)        F_r (1 + g_r sgn v)
//! ```
//!
//! With both equal the whole hydraulic force is scaled; the slope beyond relief follows Ce. Even
//! harmonics and a mean force that grow with the force are its mark; a preload stands at rest too.

use super::parameter::effect_parameters;
use super::{DamperEffect, Place};
use crate::damper::curve::Side;
use crate::damper::law::Parts;
use crate::damper::nominal::Nominal;

effect_parameters! {
    /// Different damping in extension and compression.
    AsymmetricDamping {
        damping_asymmetry: One in -0.95 to 0.95, typical 0.05,
            "Share by which damping is higher in extension and lower in compression.";
        relief_asymmetry: One in -0.95 to 0.95, typical 0.05,
            "Share by which the relief force is higher in extension and lower in compression.";
    }
}

impl DamperEffect for AsymmetricDamping {
    const NAME: &'static str = "asymmetric_damping";
    const PLACE: Place = Place::Inboard;
    const EQUATION: &'static str = "Ce (1 + g sgn v), F_r (1 + g_r sgn v)";

    fn shape(&self, parts: &mut Parts, _nominal: &Nominal) {
        for (side, sign) in [(Side::Negative, -1.0), (Side::Positive, 1.0)] {
            let force = 1.0 + sign * self.relief_asymmetry;
            let damping = 1.0 + sign * self.damping_asymmetry;
            parts.hydraulic.stretch(side, force / damping, force);
        }
    }
}
