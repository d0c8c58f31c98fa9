//! Rubber and seats that stiffen with deflection: an attachment with a cubic term.
//!
//! ```text
//! F = Ke d (1 + k d^2)
//! ```
//!
//! Inverted in closed form, d = 2/sqrt(3 k) sinh(asinh(1.5 sqrt(3 k) F/Ke)/3), and replaced by
//! eleven straight pieces to 1.5 times the force scale of the nominal damper, evenly in deflection,
//! and two more to six times the scale; beyond, straight on, so that the attachment never becomes
//! rigid. Up to the scale the force is off by at most 0.7 % of it (0.15 % where the cubic term adds
//! 15 % there), up to four times the scale by at most 6.5 % of itself. In motions that reach relief
//! that is 0.03 % of the rms force.
//!
//! Limits: elastic, the same on both sides. Source: the usual cubic law.

use super::draw::Draw;
use super::parameter::effect_parameters;
use super::{DamperEffect, Place};
use crate::damper::nominal::Nominal;
use crate::damper::parts::Parts;
use crate::damper::sampling;

effect_parameters! {
    /// A stiffness that grows with the square of the deflection.
    StiffeningAttachment {
        stiffening_per_m2: PerMetre2 in 0.0 to 1e4, typical 0.1,
            "Relative growth of the secant stiffness per deflection squared, 1/m2.";
    }
}

impl StiffeningAttachment {
    /// Deflection at a force above zero, m, the clearance left out.
    ///
    /// ```
    /// use firmware_core::damper::effects::StiffeningAttachment;
    /// let rubber = StiffeningAttachment { stiffening_per_m2: 2.5e5 };
    /// // 12.5e6 * 1e-3 * (1 + 0.25) = 15.625 kN.
    /// assert!((rubber.deflection_m(12.5e6, 15_625.0) - 1e-3).abs() < 1e-15);
    /// ```
    pub fn deflection_m(&self, ke_n_per_m: f64, force_n: f64) -> f64 {
        let root = crate::sqrt::sqrt(3.0 * self.stiffening_per_m2);
        let linear_m = force_n / ke_n_per_m;
        2.0 / root * libm::sinh(libm::asinh(1.5 * root * linear_m) / 3.0)
    }
}

impl DamperEffect for StiffeningAttachment {
    const NAME: &'static str = "stiffening_attachment";
    const PLACE: Place = Place::Attachment;
    const EQUATION: &'static str = "F = Ke d (1 + k d^2)";
    const SHOWN_BY: &'static str =
        "Sines at several amplitudes around relief, at one frequency above the dashpot's.";
    // An attachment deflects by far less than the damper moves.
    const STARTS: &'static [&'static [f64]] = &[&[3.0], &[100.0]];
    const STRONGEST: f64 = 300.0;
    const IN_HYDRAULIC_MODEL: bool = true;

    fn shape(&self, parts: &mut Parts, nominal: &Nominal) {
        let (k, ke, scale_n) =
            (self.stiffening_per_m2, nominal.ke_n_per_m, nominal.scale().force_n);
        // Less than the resolution of the numbers.
        if k * (scale_n / ke) * (scale_n / ke) < 1e-15 {
            return;
        }
        let force = |d: f64| ke * d * (1.0 + k * d * d);
        let (dense_n, last_n) = (1.5 * scale_n, 6.0 * scale_n);
        let reach_m = self.deflection_m(ke, dense_n);
        let place = |u: f64| if u == 1.0 { dense_n } else { force(reach_m * u) };
        let places = sampling::places(11, place, &[0.5 * last_n, last_n]);
        let last_m = self.deflection_m(ke, last_n);
        let slope = 1.0 / (ke * (1.0 + 3.0 * k * last_m * last_m)) - 1.0 / ke;
        let gained = |force_n: f64| self.deflection_m(ke, force_n) - force_n / ke;
        parts.attachment = parts.attachment.plus(&sampling::odd(&places, slope, gained));
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let stroke_m = draw.scale.displacement_m;
        Self { stiffening_per_m2: strength / (stroke_m * stroke_m) }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        let stretched_m = nominal.f_relief_n / nominal.ke_n_per_m;
        Self { stiffening_per_m2: 0.1 * size / (stretched_m * stretched_m) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion};

    /// A dashpot that does not move: the attachment alone.
    fn force_n(stiffening_per_m2: f64, displacement_m: f64) -> f64 {
        let nominal = Nominal { ce_n_s_per_m: 1e16, c2_n_s_per_m: 1e16, ..Nominal::NEW };
        let effect = StiffeningAttachment { stiffening_per_m2 };
        let damper = Damper::new(nominal, &[effect.into()]).unwrap();
        damper.advance(&mut DamperState::rest(), Motion::new(displacement_m, 0.0), 1e-3)
    }

    #[test]
    fn cubic_law_is_met() {
        for (k, share) in [(1e4, 5e-4), (1e5, 1.5e-3), (1e6, 3.5e-3), (1e8, 7e-3)] {
            for i in 1..2000 {
                let force = 72e3 * f64::from(i) / 2000.0;
                // Newton, from above.
                let mut d = 6e-3_f64;
                for _ in 0..60 {
                    d -= (12.5e6 * d * (1.0 + k * d * d) - force)
                        / (12.5e6 * (1.0 + 3.0 * k * d * d));
                }
                let miss = (force_n(k, 0.1e-3 + d) - force).abs();
                let allowed = if force < 18e3 { share * 18e3 } else { 0.065 * force };
                assert!(miss < allowed, "{k} {force}: {miss}");
                assert_eq!(force_n(k, -0.1e-3 - d), -force_n(k, 0.1e-3 + d));
            }
        }
    }

    #[test]
    fn beyond_the_samples_the_stiffness_stays_finite() {
        let k = 1e6;
        let effect = StiffeningAttachment { stiffening_per_m2: k };
        let last = effect.deflection_m(12.5e6, 108e3);
        let slope = (force_n(k, 20e-3) - force_n(k, 10e-3)) / 10e-3;
        assert!((slope / (12.5e6 * (1.0 + 3.0 * k * last * last)) - 1.0).abs() < 1e-9, "{slope}");
    }

    #[test]
    fn nothing_stiffening_is_the_nominal_damper() {
        for i in -20..=20 {
            let x = 1e-4 * f64::from(i);
            let expected = 12.5e6 * (x.abs() - 0.1e-3).max(0.0) * x.signum();
            assert!((force_n(0.0, x) - expected).abs() <= 1e-9 * expected.abs());
            assert!((force_n(1e-4, x) - expected).abs() <= 1e-9 * expected.abs());
        }
    }
}
