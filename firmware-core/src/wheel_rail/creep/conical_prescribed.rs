//! The creep force of classical bogie models: prescribed coefficients, constant wheel load.
//!
//! `xr^2 = (xi/Psi)^2 + (eta/Phi)^2`, `u = G pi a b xr / (mu N)`, `F = mu N (u - u^2/3 + u^3/27)`
//! up to `u = 3`, then `mu N`; `Fx = F xi / (Psi xr)`, `Fy = F eta / (Phi xr)` (Vermeulen and
//! Johnson, as used for the Cooperrider bogie by Kaas-Petersen 1986 and True). Spin is ignored. `mu
//! N` comes from the patch, so from the prescribed load of a conical wheel.

use super::{CreepForce, Creepage, Patch, cubic_saturation};
use crate::number::Number;

/// Prescribed coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConicalPrescribed {
    /// `G pi a b` (N).
    pub shear_force_n: f64,
    /// Longitudinal coefficient Psi.
    pub psi: f64,
    /// Lateral coefficient Phi.
    pub phi: f64,
}

impl ConicalPrescribed {
    #[inline(always)]
    pub(super) fn force<N: Number>(self, patch: &Patch<N>, creepage: Creepage<N>) -> CreepForce<N> {
        let shear_force_n = N::splat(self.shear_force_n);
        let longitudinal = creepage.longitudinal / N::splat(self.psi);
        let lateral = creepage.lateral / N::splat(self.phi);
        let resultant = (longitudinal * longitudinal + lateral * lateral).sqrt();
        let limit_n = patch.friction * patch.normal_n;
        let u = shear_force_n * resultant / limit_n.at_least(f64::MIN_POSITIVE);
        let force_per_creepage_n = -shear_force_n * cubic_saturation(u);
        CreepForce {
            longitudinal_n: force_per_creepage_n * longitudinal,
            lateral_n: force_per_creepage_n * lateral,
            spin_moment_n_m: N::splat(0.0),
        }
    }
}
