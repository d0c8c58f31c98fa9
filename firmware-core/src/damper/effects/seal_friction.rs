//! Dry friction of the rod seal, inboard, with breakaway.
//!
//! ```text
//! |F_s| <= r Fc                          at rest
//! F_s = sgn(v) (Fc + (r - 1) Fc <1 - |v|/v_s>)     sliding, <> zero below zero
//! ```
//!
//! a straight-line Stribeck curve from the breakaway force r Fc down to the Coulomb force Fc. The
//! piston sticks: at rest its velocity is exactly zero. Where friction falls faster than the
//! hydraulic force rises, the sum falls after breakaway; the piston then jumps to the velocity at
//! which the sum carries the force again, and comes to rest at the lowest sum. Sitting inside the
//! attachment, the friction is filtered by it.
//!
//! Limits: no dependence on pressure, and no inertia during the jump.

use super::parameter::effect_parameters;
use super::{DamperEffect, Place};
use crate::damper::curve::{Curve, Knot};
use crate::damper::law::Parts;
use crate::damper::nominal::Nominal;

effect_parameters! {
    /// Coulomb friction with breakaway.
    SealFriction {
        coulomb_n: Newton in 0.0 to 1.0, typical 0.02, "Friction force while sliding, N.";
        breakaway_ratio: One in 1.0 to 10.0, typical 1.3, "Breakaway force over sliding force.";
        stribeck_m_per_s: MetrePerSecond in 0.0 to 1.0, typical 0.05,
            "Velocity at which friction has fallen to the sliding force, m/s.";
    }
}

impl DamperEffect for SealFriction {
    const NAME: &'static str = "seal_friction";
    const PLACE: Place = Place::Inboard;
    const EQUATION: &'static str = "F += sgn(v) Fc (1 + (r - 1) max(0, 1 - |v|/v_s)), sticking";

    fn shape(&self, parts: &mut Parts, nominal: &Nominal) {
        let breakaway_n = self.coulomb_n * self.breakaway_ratio;
        // A step down needs some width; a millionth of the relief velocity is none.
        let least = 1e-6 * nominal.scale().velocity_m_per_s;
        let v = self.stribeck_m_per_s.max(least);
        let knots = [
            Knot { x: -v, y: -self.coulomb_n },
            Knot { x: 0.0, y: -breakaway_n },
            Knot { x: 0.0, y: breakaway_n },
            Knot { x: v, y: self.coulomb_n },
        ];
        parts.dry = parts.dry.plus(&Curve::through(&knots, 0.0, 0.0));
    }
}
