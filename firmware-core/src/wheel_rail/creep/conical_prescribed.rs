//! The creep force of classical bogie models: prescribed coefficients, constant wheel load.
//!
//! `xr^2 = (xi/Psi)^2 + (eta/Phi)^2`, `u = G pi a b xr / (mu N)`, `F = mu N (u - u^2/3 + u^3/27)`
//! up to `u = 3`, then `mu N`; `Fx = F xi / (Psi xr)`, `Fy = F eta / (Phi xr)` (Vermeulen and
//! Johnson, as used for the Cooperrider bogie by Kaas-Petersen 1986 and True). Spin is ignored. `mu
//! N` comes from the patch, so from the prescribed load of a conical wheel.

use super::{CreepForce, Creepage, Patch, cubic_saturation};

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
    pub(super) fn force(self, patch: &Patch, creepage: Creepage) -> CreepForce {
        let longitudinal = creepage.longitudinal / self.psi;
        let lateral = creepage.lateral / self.phi;
        let resultant = crate::sqrt::sqrt(longitudinal * longitudinal + lateral * lateral);
        let limit_n = patch.friction * patch.normal_n;
        let u = self.shear_force_n * resultant / limit_n.max(f64::MIN_POSITIVE);
        let force_per_creepage_n = -self.shear_force_n * cubic_saturation(u);
        CreepForce {
            longitudinal_n: force_per_creepage_n * longitudinal,
            lateral_n: force_per_creepage_n * lateral,
            spin_moment_n_m: 0.0,
        }
    }
}
