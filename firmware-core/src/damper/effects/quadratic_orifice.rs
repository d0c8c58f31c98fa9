//! A sharp-edged orifice in the valve, inboard: below relief the force grows with the square too.
//!
//! ```text
//! F = Ce v + b v |v|        up to the relief force, which stays; C2 beyond
//! ```
//!
//! The pressure drop of turbulent flow through an orifice goes with the square of the flow, that of
//! a laminar slot with the flow; a valve has a share of both. The relief opens at the same force
//! and so at a lower velocity. Ten straight pieces up to the relief, evenly in velocity: the force
//! is off by at most 0.22 % of the quadratic part at relief, 0.035 % of the relief force at the
//! typical value. Without a relief ten pieces that widen with the velocity reach to five times the
//! velocity of [`Nominal::scale`] (0.5 m/s) and go on straight: off by at most 0.6 % of the largest
//! force of a motion up to there, and by 2.5 % of that of a motion up to 0.1 m/s.
//!
//! Limits: oil that warms keeps the shape; a relief far above all forces of a record makes the
//! pieces coarse. Source: orifice flow as in any text on oil hydraulics.

use super::draw::Draw;
use super::parameter::{Scale, effect_parameters};
use super::{DamperEffect, Place};
use crate::damper::nominal::Nominal;
use crate::damper::parts::Parts;
use crate::damper::sampling;

effect_parameters! {
    /// A part of the force below relief that grows with the square of the velocity.
    QuadraticOrifice {
        quadratic_n_s2_per_m2: NewtonSecond2PerMetre2 in 0.0 to 1e3, typical 0.3,
            "Force of the orifice per velocity squared, N s2/m2.";
    }
}

impl QuadraticOrifice {
    /// Velocity at a force, m/s, relief left out.
    ///
    /// ```
    /// use firmware_core::damper::effects::QuadraticOrifice;
    /// let orifice = QuadraticOrifice { quadratic_n_s2_per_m2: 2e7 };
    /// // 1e6 * 0.01 + 2e7 * 0.01^2 = 12 kN.
    /// assert!((orifice.velocity_m_per_s(1e6, 12e3) - 0.01).abs() < 1e-15);
    /// ```
    pub fn velocity_m_per_s(&self, ce_n_s_per_m: f64, force_n: f64) -> f64 {
        let b = self.quadratic_n_s2_per_m2;
        2.0 * force_n
            / (ce_n_s_per_m + crate::sqrt::sqrt(ce_n_s_per_m * ce_n_s_per_m + 4.0 * b * force_n))
    }
}

impl DamperEffect for QuadraticOrifice {
    const NAME: &'static str = "quadratic_orifice";
    const PLACE: Place = Place::Inboard;
    const EQUATION: &'static str = "F = Ce v + b v |v| below relief";
    const SHOWN_BY: &'static str =
        "Slow triangles over a wide stroke at five or more speeds below relief, one to five apart.";
    // Relief may come at a small part of the greatest velocity.
    const STARTS: &'static [&'static [f64]] = &[&[3.0], &[30.0]];
    const STRONGEST: f64 = 300.0;
    const IN_HYDRAULIC_MODEL: bool = true;

    fn shape(&self, parts: &mut Parts, nominal: &Nominal) {
        let (ce, b) = (nominal.ce_n_s_per_m, self.quadratic_n_s2_per_m2);
        if b == 0.0 {
            return;
        }
        let gained = |force_n: f64| self.velocity_m_per_s(ce, force_n) - force_n / ce;
        let relief_n = nominal.f_relief_n;
        let (places, slope) = if relief_n.is_finite() {
            let opens = self.velocity_m_per_s(ce, relief_n);
            let at = |u: f64| if u == 1.0 { relief_n } else { opens * u * (ce + b * opens * u) };
            (sampling::places(10, at, &[]), 0.0)
        } else {
            let last = 5.0 * nominal.scale().velocity_m_per_s;
            let at = |u: f64| last * u * u * (ce + b * last * u * u);
            (sampling::places(10, at, &[]), 1.0 / (ce + 2.0 * b * last) - 1.0 / ce)
        };
        parts.hydraulic.add_across(&sampling::odd(&places, slope, gained));
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let Scale { force_n, velocity_m_per_s: speed, .. } = draw.scale;
        Self { quadratic_n_s2_per_m2: strength * force_n / (speed * speed) }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        let (f, v) = (nominal.f_relief_n, nominal.v_relief_m_per_s());
        Self { quadratic_n_s2_per_m2: 0.3 * size * f / (v * v) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::Damper;

    fn damper(nominal: Nominal, b: f64) -> Damper {
        let effect = QuadraticOrifice { quadratic_n_s2_per_m2: b };
        Damper::new(nominal, &[effect.into()]).unwrap()
    }

    #[test]
    fn force_is_met_below_relief_and_c2_beyond() {
        let nominal = Nominal::NEW;
        let natural = 18e3 / (0.018 * 0.018);
        for share in [0.1, 1.0, 100.0] {
            let b = share * natural;
            let damper = damper(nominal, b);
            let opens = QuadraticOrifice { quadratic_n_s2_per_m2: b }.velocity_m_per_s(1e6, 18e3);
            let mut worst = 0.0_f64;
            for i in 1..=1000 {
                let v = opens * f64::from(i) / 1000.0;
                let expected = 1e6 * v + b * v * v;
                worst = worst.max((damper.steady_force_n(v) - expected).abs());
                assert_eq!(damper.steady_force_n(-v), -damper.steady_force_n(v));
            }
            let quadratic_share = b * opens * opens / 18e3;
            assert!(worst < 0.0022 * quadratic_share * 18e3, "{share}: {}", worst / 18e3);
            let beyond = damper.steady_force_n(opens + 0.1);
            assert!((beyond - 26e3).abs() < 1e-6, "{beyond}");
        }
    }

    #[test]
    fn viscous_damper_without_relief_stays_sensible() {
        // A bridge damper: 2 MN at 0.5 m/s, four fifths of it quadratic.
        let nominal = Nominal { ce_n_s_per_m: 0.8e6, f_relief_n: f64::INFINITY, ..Nominal::NEW };
        let damper = damper(nominal, 6.4e6);
        let force = |v: f64| 0.8e6 * v + 6.4e6 * v * v;
        for (reach, allowed) in [(0.5, 0.006), (0.1, 0.025)] {
            for i in 1..=1000 {
                let v = reach * f64::from(i) / 1000.0;
                let miss = (damper.steady_force_n(v) - force(v)).abs() / force(reach);
                assert!(miss < allowed, "{v}: {miss}");
            }
        }
        // Beyond, along the tangent.
        let slope = damper.steady_force_n(1.5) - damper.steady_force_n(0.5);
        assert!((slope - (0.8e6 + 2.0 * 6.4e6 * 0.5)).abs() < 1.0);
    }

    #[test]
    fn nothing_quadratic_is_the_nominal_damper() {
        let plain = Damper::new(Nominal::NEW, &[]).unwrap();
        for v in [1e-6, 0.004, 0.017, 0.018, 0.1] {
            assert_eq!(damper(Nominal::NEW, 0.0).steady_force_n(v), plain.steady_force_n(v));
            let little = damper(Nominal::NEW, 1e-3).steady_force_n(v);
            assert!((little / plain.steady_force_n(v) - 1.0).abs() < 1e-9, "{v}");
        }
    }
}
