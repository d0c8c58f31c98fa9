//! A leak past the piston, inboard: an orifice parallel to the valve, so that damping falls off at
//! low speed.
//!
//! ```text
//! v = v_nominal(F) + v_l sgn(F) sqrt(|F|/F_s)
//! ```
//!
//! A worn seal or a notch in the piston lets oil bypass the valve; both carry the same pressure, so
//! their flows add. `F_s` is the force scale of the nominal damper (its relief force; without one,
//! the force at 0.1 m/s), and `v_l` the velocity that the leak alone gives the piston there. At low
//! force the orifice takes nearly all of the flow and the force falls with the square of the
//! velocity.
//!
//! Eight straight pieces up to `F_s`, denser towards zero, two more to four times `F_s`, then
//! straight on. The force is off by at most 0.35 % of `F_s`, close to zero force, however large the
//! leak. A hard cap of the force takes the leak with it. Limits: no dependence on temperature; a
//! leak through a laminar gap is a lower Ce and cannot be seen. Source: orifice flow as in any text
//! on oil hydraulics.

use super::draw::Draw;
use super::parameter::effect_parameters;
use super::{DamperEffect, Place};
use crate::damper::nominal::Nominal;
use crate::damper::parts::Parts;
use crate::damper::sampling;

effect_parameters! {
    /// An orifice past the piston.
    OrificeLeakage {
        leakage_m_per_s: MetrePerSecond in 0.0 to 100.0, typical 0.1,
            "Velocity of the piston that the leak alone gives at the relief force, m/s.";
    }
}

impl DamperEffect for OrificeLeakage {
    const NAME: &'static str = "orifice_leakage";
    const PLACE: Place = Place::Inboard;
    const EQUATION: &'static str = "v = v_nominal(F) + v_l sgn(F) sqrt(|F|/F_s)";
    const SHOWN_BY: &'static str =
        "A ramp and hold of 30 s below relief, and slow triangles of 1 to 5 mm/s.";
    const STRONGEST: f64 = 3.0;
    const IN_HYDRAULIC_MODEL: bool = true;

    fn shape(&self, parts: &mut Parts, nominal: &Nominal) {
        let v_l = self.leakage_m_per_s;
        if v_l == 0.0 {
            return;
        }
        let scale_n = nominal.scale().force_n;
        // Beyond a hard cap there is no force at which a flow could be added.
        let capped = nominal.f_relief_n.is_finite() && nominal.c2_n_s_per_m == 0.0;
        let far = [2.0 * scale_n, 4.0 * scale_n];
        let beyond = if capped { &[][..] } else { &far };
        let places = sampling::places(8, |u| scale_n * u * u, beyond);
        let slope = if capped { 0.0 } else { v_l / (4.0 * scale_n) };
        let leak = |force_n: f64| v_l * crate::sqrt::sqrt(force_n / scale_n);
        parts.hydraulic.add_across(&sampling::odd(&places, slope, leak));
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        Self { leakage_m_per_s: strength * draw.scale.velocity_m_per_s }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        Self { leakage_m_per_s: 0.05 * size * nominal.v_relief_m_per_s() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion};

    #[test]
    fn flows_add_at_equal_force() {
        for (nominal, v_l) in [
            (Nominal::NEW, 4e-3),
            (Nominal { c2_n_s_per_m: 0.0, ..Nominal::NEW }, 4e-3),
            (Nominal { f_relief_n: f64::INFINITY, ..Nominal::NEW }, 0.03),
        ] {
            let scale_n = nominal.scale().force_n;
            let leak = OrificeLeakage { leakage_m_per_s: v_l };
            let damper = Damper::new(nominal, &[leak.into()]).unwrap();
            let plain = Damper::new(nominal, &[]).unwrap();
            for i in 1..=2000 {
                let force = 1.2 * scale_n * f64::from(i) / 2000.0;
                if nominal.c2_n_s_per_m == 0.0 && force > scale_n {
                    break;
                }
                // The velocity of the nominal damper at this force, and the leak's.
                let opened = (force - nominal.f_relief_n).max(0.0);
                let mut through = (force - opened) / nominal.ce_n_s_per_m;
                if opened > 0.0 {
                    through += opened / nominal.c2_n_s_per_m;
                }
                let leaking = through + v_l * crate::sqrt::sqrt(force / scale_n);
                let miss = (damper.steady_force_n(leaking) - force).abs() / scale_n;
                assert!(miss < 0.0035, "{force}: {miss}");
                assert!(damper.steady_force_n(through) < plain.steady_force_n(through));
                assert_eq!(damper.steady_force_n(-leaking), -damper.steady_force_n(leaking));
            }
        }
    }

    #[test]
    fn held_force_leaks_away_with_the_square_of_time() {
        // A leak alone (the valve shut): sqrt(F) falls on a straight line, F0 (1 - t/t0)^2 with
        // t0 = 2 sqrt(F0 F_s)/(Ke v_l).
        let nominal = Nominal { ce_n_s_per_m: 1e12, clearance_2a_m: 0.0, ..Nominal::NEW };
        let leak = OrificeLeakage { leakage_m_per_s: 1e-3 };
        let damper = Damper::new(nominal, &[leak.into()]).unwrap();
        let held = Motion::new(1e-3, 0.0);
        let mut state = DamperState::rest();
        damper.advance(&mut state, held, 1e-9);
        let start_n = state.force_n();
        let t0 =
            2.0 * crate::sqrt::sqrt(start_n * nominal.f_relief_n) / (nominal.ke_n_per_m * 1e-3);
        for i in 1..=200 {
            let force = damper.advance(&mut state, held, 1e-3);
            let left = 1.0 - 1e-3 * f64::from(i) / t0;
            let expected = if left > 0.0 { start_n * left * left } else { 0.0 };
            assert!((force - expected).abs() < 0.006 * start_n, "{i}: {force} {expected}");
        }
    }

    #[test]
    fn no_leak_is_the_nominal_damper() {
        let plain = Damper::new(Nominal::NEW, &[]).unwrap();
        let at = |leakage_m_per_s: f64, v: f64| {
            let leak = OrificeLeakage { leakage_m_per_s };
            Damper::new(Nominal::NEW, &[leak.into()]).unwrap().steady_force_n(v)
        };
        for v in [1e-5, 0.004, 0.018, 0.1] {
            assert_eq!(at(0.0, v), plain.steady_force_n(v));
            let little = (at(1e-15, v) - plain.steady_force_n(v)).abs();
            assert!(little < 1e-9 * 18e3, "{v}: {little}");
        }
    }
}
