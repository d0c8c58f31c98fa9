//! The fixture of the bench gives: a linear spring in series with the damper.
//!
//! ```text
//! 1/K = 1/Ke + 1/K_fix
//! ```
//!
//! Exactly a lower Ke. No record of force and displacement of a damper can tell the two apart, so
//! a fit that names it is wrong; a rigid coupon in place of the damper measures it. It is here for
//! models whose Ke comes from elsewhere. Limits: no mass, no damping of the fixture.

use super::draw::{Draw, between};
use super::parameter::effect_parameters;
use super::{DamperEffect, Place};
use crate::damper::nominal::Nominal;
use crate::damper::parts::Parts;

effect_parameters! {
    /// A spring in series.
    FixtureCompliance {
        fixture_n_per_m: NewtonPerMetre in 0.01 to 1e9, typical 10.0,
            "Stiffness of the fixture, N/m.";
    }
}

impl DamperEffect for FixtureCompliance {
    const NAME: &'static str = "fixture_compliance";
    const PLACE: Place = Place::Attachment;
    const EQUATION: &'static str = "1/K = 1/Ke + 1/K_fix";
    const SHOWN_BY: &'static str =
        "A rigid coupon in place of the damper; no test of the damper itself.";
    const STRONGEST: f64 = 300.0;
    const IN_HYDRAULIC_MODEL: bool = false;

    fn shape(&self, parts: &mut Parts, _nominal: &Nominal) {
        parts.attachment.add_line(1.0 / self.fixture_n_per_m);
    }

    fn drawn(_strength: f64, draw: &Draw) -> Self {
        let [a, ..] = draw.shape;
        Self { fixture_n_per_m: draw.nominal.ke_n_per_m * between(a, 3.0, 10.0) }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        Self { fixture_n_per_m: 6.0 / size * nominal.ke_n_per_m }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion};

    fn forces(damper: &Damper) -> heapless::Vec<f64, 600> {
        let mut state = DamperState::rest();
        let at = |i: i32| Motion::new(4e-3 * libm::sin(0.022 * f64::from(i)), 0.0);
        (1..=600).map(|i| damper.advance(&mut state, at(i), 1e-3)).collect()
    }

    #[test]
    fn no_record_distinguishes_it_from_a_lower_ke() {
        let fixture = FixtureCompliance { fixture_n_per_m: 50e6 };
        let with = Damper::new(Nominal::NEW, &[fixture.into()]).unwrap();
        let lower = Nominal { ke_n_per_m: 10e6, ..Nominal::NEW };
        let without = Damper::new(lower, &[]).unwrap();
        for (a, b) in forces(&with).iter().zip(&forces(&without)) {
            assert!((a - b).abs() < 1e-8, "{a} {b}");
        }
    }

    #[test]
    fn rigid_fixture_is_the_nominal_damper() {
        let rigid = FixtureCompliance { fixture_n_per_m: 1e20 };
        let with = Damper::new(Nominal::NEW, &[rigid.into()]).unwrap();
        let without = Damper::new(Nominal::NEW, &[]).unwrap();
        for (a, b) in forces(&with).iter().zip(&forces(&without)) {
            assert!((a - b).abs() <= 1e-9 * b.abs().max(1.0), "{a} {b}");
        }
    }
}
