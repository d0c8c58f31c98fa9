//! Extension and compression throttled differently, inboard.
//!
//! ```text
//! Ce (1 + g sgn v)        F_r (1 + g_r sgn v)
//! ```
//!
//! With both equal the whole hydraulic force is scaled; the slope beyond relief follows Ce. Where
//! that is enough for a record, a fit has one parameter for both ([`DamperEffect::MAY_SHARE`]).
//! Even harmonics and a mean force that grow with the force are its mark; a preload stands at rest
//! too.

use super::draw::{Draw, between};
use super::parameter::effect_parameters;
use super::{DamperEffect, Place};
use crate::damper::curve::Side;
use crate::damper::nominal::Nominal;
use crate::damper::parts::Parts;

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
    const SHOWN_BY: &'static str =
        "Sines at two force levels and a static hold, with the direction of extension declared.";
    const DIRECTIONAL: bool = true;
    const MAY_SHARE: usize = 1;
    const STRONGEST: f64 = 0.6;
    const IN_HYDRAULIC_MODEL: bool = true;

    fn shape(&self, parts: &mut Parts, _nominal: &Nominal) {
        for (side, sign) in [(Side::Negative, -1.0), (Side::Positive, 1.0)] {
            let force = 1.0 + sign * self.relief_asymmetry;
            let damping = 1.0 + sign * self.damping_asymmetry;
            parts.hydraulic.stretch(side, force / damping, force);
        }
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let [a, ..] = draw.shape;
        Self {
            damping_asymmetry: draw.sign * strength,
            relief_asymmetry: draw.sign * strength * between(a, 0.5, 1.5),
        }
    }

    fn in_service(_nominal: &Nominal, size: f64) -> Self {
        Self { damping_asymmetry: 0.1 * size, relief_asymmetry: 0.06 * size }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion};

    /// Force after a long stroke at constant velocity.
    fn pulled(damper: &Damper, velocity_m_per_s: f64) -> f64 {
        let mut state = DamperState::starting(Motion::new(0.0, velocity_m_per_s));
        for i in 1..=4000 {
            let x = velocity_m_per_s * 1e-3 * f64::from(i);
            damper.advance(&mut state, Motion::new(x, velocity_m_per_s), 1e-3);
        }
        state.force_n()
    }

    #[test]
    fn force_ratio_below_and_beyond_relief() {
        let effect = AsymmetricDamping { damping_asymmetry: 0.1, relief_asymmetry: 0.05 };
        let damper = Damper::new(Nominal::NEW, &[effect.into()]).unwrap();
        for (sign, ce, relief, c2) in [(1.0, 1.1e6, 18.9e3, 88e3), (-1.0, 0.9e6, 17.1e3, 72e3)] {
            let slow = pulled(&damper, sign * 0.01);
            assert!((slow - sign * ce * 0.01).abs() < 1e-6, "{slow}");
            let fast = pulled(&damper, sign * 0.1);
            let expected = sign * (relief + c2 * (0.1 - relief / ce));
            assert!((fast - expected).abs() < 1e-6, "{fast} {expected}");
        }
    }

    #[test]
    fn equal_shares_scale_the_whole_curve() {
        let effect = AsymmetricDamping { damping_asymmetry: 0.2, relief_asymmetry: 0.2 };
        let damper = Damper::new(Nominal::NEW, &[effect.into()]).unwrap();
        let plain = Damper::new(Nominal::NEW, &[]).unwrap();
        for velocity in [1e-3, 0.01, 0.018, 0.05, 0.3] {
            let (up, down) = (damper.steady_force_n(velocity), damper.steady_force_n(-velocity));
            let force = plain.steady_force_n(velocity);
            assert!((up - 1.2 * force).abs() < 1e-9 && (down + 0.8 * force).abs() < 1e-9);
        }
    }
}
