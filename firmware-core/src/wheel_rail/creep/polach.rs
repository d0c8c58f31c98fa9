//! Polach's closed-form creep force with spin (Vehicle System Dynamics Supplement 33, 1999).
//!
//! With `s` the resultant creepage (lateral creepage enlarged by `phi a` where spin does so) and
//! `e = G pi a b C s / (4 mu N)`: `F = (2 mu N / pi) (e / (1 + e^2) + atan e)`, split along the
//! creepages, plus the lateral force of spin through the moment `K_M`. The reduction factors for
//! wet rail are one. No spin moment. Written from the published formulae; the listing of the
//! original was not available, so the small-creep limits are tested against Kalker instead.

use super::{CreepForce, Creepage, Patch};
use crate::number::Number;

const PI: f64 = core::f64::consts::PI;

#[inline(always)]
pub(super) fn force<N: Number>(patch: &Patch<N>, creepage: Creepage<N>) -> CreepForce<N> {
    let of = N::splat;
    let limit_n = patch.friction * patch.normal_n;
    let (a, b) = (patch.along_m, patch.across_m);
    let Creepage { longitudinal, lateral, spin_per_m } = creepage;
    let with_spin = lateral + spin_per_m * a;
    let lateral_c = N::choose(with_spin.abs().is_above(lateral.abs()), with_spin, lateral);
    let slip = (longitudinal * longitudinal + lateral * lateral).sqrt();
    let slip_c = (longitudinal * longitudinal + lateral_c * lateral_c).sqrt();
    // Without friction, load or slip there is no force, and some quotients are not numbers.
    let none = N::or(of(1e-6).is_above(limit_n), slip_c.is_at_most(of(0.0)));
    // Stiffness in the direction of the creepage itself.
    let (x, y) = (patch.c11 * longitudinal / slip, patch.c22 * lateral / slip);
    let stiffness = N::choose(slip.is_above(of(0.0)), (x * x + y * y).sqrt(), patch.c22);
    let e = of(0.25 * PI) * patch.shear_modulus_pa * a * b * stiffness * slip_c / limit_n;
    let total = of(2.0) * limit_n / of(PI) * (e / (of(1.0) + e * e) + e.map(libm::atan));

    let shape = of(1.0) + of(6.3) * (of(1.0) - (-a / b).map(libm::exp));
    let e_m = (of(8.0 / 3.0) * patch.shear_modulus_pa * b * (a * b).sqrt() * patch.c23
        / (limit_n * shape)
        * lateral_c)
        .abs();
    let d = (e_m * e_m - of(1.0)) / (e_m * e_m + of(1.0));
    let rest = (of(1.0) - d * d).at_least(0.0);
    let k_m = e_m * (d * d * d / of(3.0) - d * d / of(2.0) + of(1.0 / 6.0))
        - rest * rest.sqrt() / of(3.0);
    let spin_force = of(9.0 / 16.0) * a * limit_n * k_m * shape * spin_per_m / slip_c;

    let longitudinal_n = -total * longitudinal / slip_c;
    let lateral_n = -total * lateral / slip_c + spin_force;
    // Creep and spin together may pass the limit by a little: hold the vector on the circle.
    let sum = (longitudinal_n * longitudinal_n + lateral_n * lateral_n).sqrt();
    let hold = N::choose(sum.is_above(limit_n), limit_n / sum, of(1.0));
    let force = CreepForce {
        longitudinal_n: longitudinal_n * hold,
        lateral_n: lateral_n * hold,
        spin_moment_n_m: of(0.0),
    };
    force.unless(none)
}
