//! Free air in the oil makes the attachment soft around zero force.
//!
//! ```text
//! d(F) = sgn(F) d_max (1 - (1 + |F|/F_a)^(-1/n))        n = 1.4
//! ```
//!
//! Air bubbles of the volume `d_max` times the piston's area are squeezed by the pressure `F/A`
//! against the pressure `F_a/A` that they have at rest, polytropically with n = 1.4 for a quick
//! change. The deflection adds to that of Ke and saturates: the loop gets soft toes on both sides
//! of zero, the flanks stay as they are at high force. Twelve straight pieces to 1.5 times the
//! force scale of the nominal damper, short where it bends, and straight on beyond: the deflection
//! is off by at most 1 % of `d_max`. In motions that reach relief that is 0.03 % of the rms force;
//! small ones that never leave the toe see up to 0.4 %. `F_a` below 1e-4 of the scale counts as
//! 1e-4: the toe is a clearance then.
//!
//! Limits: the same air in both chambers, none redissolves (see `aeration_memory`). Source: the
//! polytropic law of gas in an oil of constant bulk modulus.

use super::draw::{Draw, decades};
use super::parameter::{Scale, effect_parameters};
use super::{DamperEffect, Place};
use crate::damper::nominal::Nominal;
use crate::damper::parts::Parts;
use crate::damper::sampling;

/// Exponent of a quick change of air, between 1 (isothermal) and 1.4 (adiabatic).
const POLYTROPIC: f64 = 1.4;

effect_parameters! {
    /// A soft toe of bubbles.
    EntrainedAir {
        toe_m: Metre in 0.0 to 10.0, typical 0.1,
            "Deflection that squeezing all bubbles takes, m.";
        air_force_n: Newton in 1e-4 to 10.0, typical 0.05,
            "Force at which the pressure in the bubbles has doubled, N.";
    }
}

impl EntrainedAir {
    /// Deflection of the bubbles at a force above zero, m.
    ///
    /// ```
    /// use firmware_core::damper::effects::EntrainedAir;
    /// let air = EntrainedAir { toe_m: 1e-3, air_force_n: 500.0 };
    /// // Pressure three times that at rest: 3^(-1/1.4) = 0.456 of the volume remains.
    /// assert!((air.squeezed_m(1000.0) - 0.5438e-3).abs() < 1e-7);
    /// ```
    pub fn squeezed_m(&self, force_n: f64) -> f64 {
        self.toe_m * -libm::expm1(-libm::log1p(force_n / self.air_force_n) / POLYTROPIC)
    }
}

impl DamperEffect for EntrainedAir {
    const NAME: &'static str = "entrained_air";
    const PLACE: Place = Place::Attachment;
    const EQUATION: &'static str = "d += sgn(F) d_max (1 - (1 + |F|/F_a)^(-1/1.4))";
    const SHOWN_BY: &'static str = "Sines of small amplitude, below and above the clearance, after rest and after many cycles.";
    const STARTS: &'static [&'static [f64]] = &[&[0.1, 0.01], &[0.3, 0.3]];
    const STRONGEST: f64 = 3.0;
    const IN_HYDRAULIC_MODEL: bool = true;

    fn shape(&self, parts: &mut Parts, nominal: &Nominal) {
        if self.toe_m == 0.0 {
            return;
        }
        let scale_n = nominal.scale().force_n;
        let air = Self { air_force_n: self.air_force_n.max(1e-4 * scale_n), ..*self };
        let (pressed_n, last_n) = (air.air_force_n, 1.5 * scale_n);
        // Evenly in (1 + F/F_a)^-0.36 the deviations are equal (the integral of the root of the
        // bend); a higher power gives more of them to large forces, where few motions are.
        let power = 0.5;
        let spread = -libm::expm1(-power * libm::log1p(last_n / pressed_n));
        let place = |u: f64| {
            let force_n = pressed_n * libm::expm1(-libm::log1p(-u * spread) / power);
            if u == 1.0 { last_n } else { force_n }
        };
        let stretched = libm::pow(1.0 + last_n / pressed_n, -1.0 - 1.0 / POLYTROPIC);
        let slope = air.toe_m / (POLYTROPIC * pressed_n) * stretched;
        let toe = sampling::odd(&sampling::places(12, place, &[]), slope, |f| air.squeezed_m(f));
        parts.attachment = parts.attachment.plus(&toe);
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let Scale { force_n, displacement_m: stroke_m, .. } = draw.scale;
        let [a, ..] = draw.shape;
        Self { toe_m: strength * stroke_m, air_force_n: force_n * decades(a, 0.02, 0.3) }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        let stretched_m = nominal.f_relief_n / nominal.ke_n_per_m;
        Self { toe_m: 0.1 * size * stretched_m, air_force_n: 0.1 * nominal.f_relief_n }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Effect, Motion};

    /// A dashpot that does not move: the attachment alone.
    fn locked(effects: &[Effect]) -> Damper {
        let nominal = Nominal { ce_n_s_per_m: 1e16, c2_n_s_per_m: 1e16, ..Nominal::NEW };
        Damper::new(nominal, effects).unwrap()
    }

    fn force_n(damper: &Damper, displacement_m: f64) -> f64 {
        damper.advance(&mut DamperState::rest(), Motion::new(displacement_m, 0.0), 1e-3)
    }

    #[test]
    fn deflection_is_that_of_spring_and_bubbles() {
        for (toe_m, air_force_n) in [(0.2e-3, 900.0), (1e-3, 100.0), (0.5e-3, 20e3)] {
            let air = EntrainedAir { toe_m, air_force_n };
            let damper = locked(&[air.into()]);
            let mut worst = 0.0_f64;
            for i in 1..2000 {
                let x = 0.1e-3 + (toe_m + 2e-3) * f64::from(i) / 2000.0;
                let force = force_n(&damper, x);
                let expected = 0.1e-3 + force / 12.5e6 + air.squeezed_m(force);
                if force < 27e3 {
                    worst = worst.max((x - expected).abs() / toe_m);
                }
                assert_eq!(force_n(&damper, -x), -force);
            }
            assert!(worst < 0.01, "{toe_m} {air_force_n}: {worst}");
        }
    }

    #[test]
    fn toe_saturates_and_flanks_keep_their_slope() {
        let air = EntrainedAir { toe_m: 0.2e-3, air_force_n: 500.0 };
        let damper = locked(&[air.into()]);
        let slope = |x: f64| (force_n(&damper, x + 1e-6) - force_n(&damper, x)) / 1e-6;
        assert!(slope(0.11e-3) < 0.3 * 12.5e6, "{}", slope(0.11e-3));
        assert!(slope(2e-3) > 0.98 * 12.5e6, "{}", slope(2e-3));
    }

    #[test]
    fn no_air_is_the_nominal_damper() {
        let (plain, none) = (locked(&[]), EntrainedAir { toe_m: 0.0, air_force_n: 900.0 });
        let little = EntrainedAir { toe_m: 1e-15, air_force_n: 900.0 };
        for i in -20..=20 {
            let x = 1e-4 * f64::from(i);
            let expected = force_n(&plain, x);
            assert_eq!(force_n(&locked(&[none.into()]), x), expected);
            let miss = (force_n(&locked(&[little.into()]), x) - expected).abs();
            assert!(miss <= 1e-7, "{x}: {miss}");
        }
    }
}
