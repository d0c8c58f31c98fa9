//! Dampers that may be on the rig, while the host believes in its model.

use firmware_core::damper::effects::{
    Effect, EntrainedAir, GasPreload, QuadraticOrifice, SealFriction,
};
use firmware_core::damper::{Damper, DamperError, Nominal};

/// Share by which a stiffer or softer damper differs.
const STIFFNESS_SHARE: f64 = 0.2;
/// Force that pushes the rod out (N): that of a gas charge.
const PRELOAD_N: f64 = 300.0;
/// Friction of the seals (N).
const FRICTION_N: f64 = 500.0;

/// A damper that may be mounted.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Specimen {
    pub(super) name: &'static str,
    pub(super) damper: Damper,
}

/// The dampers that a map covers, of the kind of a model; an effect that the model has already is
/// replaced.
pub(super) fn specimens(model: &Damper) -> Result<Vec<Specimen>, DamperError> {
    let nominal = *model.nominal();
    let stiff = |share: f64| Nominal { ke_n_per_m: share * nominal.ke_n_per_m, ..nominal };
    let friction =
        SealFriction { coulomb_n: FRICTION_N, breakaway_ratio: 1.2, stribeck_m_per_s: 3e-3 };
    let orifice = QuadraticOrifice {
        quadratic_n_s2_per_m2: 0.3 * nominal.ce_n_s_per_m * nominal.ce_n_s_per_m
            / nominal.f_relief_n,
    };
    let air = EntrainedAir { toe_m: 0.1e-3, air_force_n: 0.05 * nominal.f_relief_n };
    let preload = GasPreload { preload_n: PRELOAD_N, rate_n_per_m: 0.0 };
    let hydraulic = [orifice.into(), air.into()];
    let rows: [(&'static str, Nominal, &[Effect]); 6] = [
        ("as its model", nominal, &[]),
        ("20 % stiffer", stiff(1.0 + STIFFNESS_SHARE), &[]),
        ("20 % softer", stiff(1.0 - STIFFNESS_SHARE), &[]),
        ("friction 500 N", nominal, &[friction.into()]),
        ("preload 300 N", nominal, &[preload.into()]),
        ("orifice and air", nominal, &hydraulic),
    ];
    let built = rows.into_iter().map(|(name, nominal, own)| {
        let kept =
            model.effects().iter().filter(|had| own.iter().all(|new| new.name() != had.name()));
        let effects: Vec<Effect> = kept.chain(own).copied().collect();
        Ok(Specimen { name, damper: Damper::new(nominal, &effects)? })
    });
    built.collect()
}
