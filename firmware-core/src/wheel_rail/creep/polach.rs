//! Polach's closed-form creep force with spin (Vehicle System Dynamics Supplement 33, 1999).
//!
//! With `s` the resultant creepage (lateral creepage enlarged by `phi a` where spin does so) and
//! `e = G pi a b C s / (4 mu N)`: `F = (2 mu N / pi) (e / (1 + e^2) + atan e)`, split along the
//! creepages, plus the lateral force of spin through the moment `K_M`. The reduction factors for
//! wet rail are one. No spin moment. Written from the published formulae; the listing of the
//! original was not available, so the small-creep limits are tested against Kalker instead.

use super::{CreepForce, Creepage, Patch};

const PI: f64 = core::f64::consts::PI;

#[inline(always)]
pub(super) fn force(patch: &Patch, creepage: Creepage) -> CreepForce {
    let limit_n = patch.friction * patch.normal_n;
    // Without friction or load there is no force, and the quotients below would not be numbers.
    if limit_n < 1e-6 {
        return CreepForce::default();
    }
    let (a, b) = (patch.along_m, patch.across_m);
    let Creepage { longitudinal, lateral, spin_per_m } = creepage;
    let with_spin = lateral + spin_per_m * a;
    let lateral_c = if with_spin.abs() > lateral.abs() { with_spin } else { lateral };
    let slip = crate::sqrt::sqrt(longitudinal * longitudinal + lateral * lateral);
    let slip_c = crate::sqrt::sqrt(longitudinal * longitudinal + lateral_c * lateral_c);
    if slip_c <= 0.0 {
        return CreepForce::default();
    }
    // Stiffness in the direction of the creepage itself.
    let stiffness = if slip > 0.0 {
        let (x, y) = (patch.c11 * longitudinal / slip, patch.c22 * lateral / slip);
        crate::sqrt::sqrt(x * x + y * y)
    } else {
        patch.c22
    };
    let e = 0.25 * PI * patch.shear_modulus_pa * a * b * stiffness * slip_c / limit_n;
    let total = 2.0 * limit_n / PI * (e / (1.0 + e * e) + libm::atan(e));

    let shape = 1.0 + 6.3 * (1.0 - libm::exp(-a / b));
    let e_m = (8.0 / 3.0 * patch.shear_modulus_pa * b * crate::sqrt::sqrt(a * b) * patch.c23
        / (limit_n * shape)
        * lateral_c)
        .abs();
    let d = (e_m * e_m - 1.0) / (e_m * e_m + 1.0);
    let rest = (1.0 - d * d).max(0.0);
    let k_m =
        e_m * (d * d * d / 3.0 - d * d / 2.0 + 1.0 / 6.0) - rest * crate::sqrt::sqrt(rest) / 3.0;
    let spin_force = 9.0 / 16.0 * a * limit_n * k_m * shape * spin_per_m / slip_c;

    let longitudinal_n = -total * longitudinal / slip_c;
    let lateral_n = -total * lateral / slip_c + spin_force;
    // Creep and spin together may pass the limit by a little: hold the vector on the circle.
    let sum = crate::sqrt::sqrt(longitudinal_n * longitudinal_n + lateral_n * lateral_n);
    let hold = if sum > limit_n { limit_n / sum } else { 1.0 };
    CreepForce {
        longitudinal_n: longitudinal_n * hold,
        lateral_n: lateral_n * hold,
        spin_moment_n_m: 0.0,
    }
}
