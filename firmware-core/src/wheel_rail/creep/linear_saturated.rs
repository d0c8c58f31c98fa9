//! Kalker's linear theory with Shen, Hedrick and Elkins's saturation: the "simplified Kalker" of
//! the SS9 study.
//!
//! `Fx = -G a b C11 xi`, `Fy = -G a b C22 eta - G (a b)^1.5 C23 phi`, `Mz = G (a b)^1.5 C23 eta`;
//! the force vector is then reduced by `1 - u/3 + u^2/27` with `u = |F| / (mu N)` (Shen, Hedrick,
//! Elkins 1983). Good for small spin, so for tread contact; flange contact with large spin is
//! better served by `polach` or `fastsim`.

use super::{CreepForce, Creepage, Patch, cubic_saturation};
use crate::number::Number;

#[inline(always)]
pub(super) fn force<N: Number>(patch: &Patch<N>, creepage: Creepage<N>) -> CreepForce<N> {
    let area = patch.along_m * patch.across_m;
    let shear_n = patch.shear_modulus_pa * area;
    let spin_n_m = shear_n * area.sqrt() * patch.c23;
    let longitudinal = -shear_n * patch.c11 * creepage.longitudinal;
    let lateral = -shear_n * patch.c22 * creepage.lateral - spin_n_m * creepage.spin_per_m;
    let moment = spin_n_m * creepage.lateral;
    let limit_n = patch.friction * patch.normal_n;
    let u = (longitudinal * longitudinal + lateral * lateral).sqrt()
        / limit_n.at_least(f64::MIN_POSITIVE);
    let left = cubic_saturation(u);
    CreepForce {
        longitudinal_n: longitudinal * left,
        lateral_n: lateral * left,
        spin_moment_n_m: moment * left,
    }
}
