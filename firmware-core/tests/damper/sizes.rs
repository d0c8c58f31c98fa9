//! Every effect at a size that a record of a second shows, for dampers of any size.

use firmware_core::damper::effects::{
    AerationMemory, AsymmetricDamping, BumpStop, CATALOGUE, Cavitation, ClearanceGrowth,
    ClearanceImpact, EntrainedAir, FixtureCompliance, ForceOffset, GasPreload, MovingMass,
    OrificeLeakage, PositionDependentDamping, QuadraticOrifice, RubberHysteresis, SealFriction,
    SecondValveStage, SensorDelay, StiffeningAttachment, StrokeDependentStiffness, TemperatureFade,
};
use firmware_core::damper::{Effect, Nominal};

/// The whole catalogue in its order, `size` times what is seen in service; wear, warming and foam
/// are as much quicker as the record is shorter.
pub(crate) fn catalogue_at(nominal: &Nominal, size: f64) -> Vec<Effect> {
    let mut effects = effects_at(nominal, size).to_vec();
    effects.extend(inside_effects_at(nominal, size));
    effects.push(Cavitation { refill_m_per_s: 0.4 * nominal.v_relief_m_per_s() }.into());
    effects.extend(outside_effects_at(nominal, size));
    effects.sort_by_key(Effect::index);
    let names: Vec<_> = effects.iter().map(Effect::name).collect();
    let known: Vec<_> = CATALOGUE.iter().map(|info| info.name).collect();
    assert_eq!(names, known, "every effect of the catalogue has a size here");
    effects
}

/// Friction, asymmetry, position, rubber.
pub(crate) fn effects_at(nominal: &Nominal, size: f64) -> [Effect; 4] {
    let f = nominal.f_relief_n;
    let v = nominal.v_relief_m_per_s();
    [
        SealFriction {
            coulomb_n: 0.03 * size * f,
            breakaway_ratio: 1.5,
            stribeck_m_per_s: 0.1 * v,
        }
        .into(),
        AsymmetricDamping { damping_asymmetry: 0.1 * size, relief_asymmetry: 0.06 * size }.into(),
        PositionDependentDamping { gradient_per_m: 6.0 * size, curvature_per_m2: 800.0 * size }
            .into(),
        RubberHysteresis { dynamic_stiffening: 0.15 * size, relaxation_time_s: 5e-3 }.into(),
    ]
}

/// Valves, gas, air, stiffening, fixture, stroke, foam, wear, warm oil.
pub(crate) fn inside_effects_at(nominal: &Nominal, size: f64) -> [Effect; 11] {
    let f = nominal.f_relief_n;
    let v = nominal.v_relief_m_per_s();
    let stretched = f / nominal.ke_n_per_m;
    [
        QuadraticOrifice { quadratic_n_s2_per_m2: 0.3 * size * f / (v * v) }.into(),
        OrificeLeakage { leakage_m_per_s: 0.05 * size * v }.into(),
        SecondValveStage { knee_force_n: 0.4 * f, slope_ratio: 1.0 / (1.0 + 0.7 * size) }.into(),
        TemperatureFade {
            fade_per_k: 0.02 * size,
            heat_capacity_j_per_k: 5e-3 * f,
            cooling_w_per_k: 2e-3 * f,
        }
        .into(),
        GasPreload { preload_n: 0.03 * size * f, rate_n_per_m: 3.0 * size * f }.into(),
        StiffeningAttachment { stiffening_per_m2: 0.1 * size / (stretched * stretched) }.into(),
        EntrainedAir { toe_m: 0.1 * size * stretched, air_force_n: 0.1 * f }.into(),
        FixtureCompliance { fixture_n_per_m: 6.0 / size * nominal.ke_n_per_m }.into(),
        StrokeDependentStiffness { gradient_per_m: 6.0 * size, curvature_per_m2: 800.0 * size }
            .into(),
        AerationMemory { softening: 0.2 * size, travel_m: 0.05, recovery_s: 1.0 }.into(),
        ClearanceGrowth { growth_per_travel: 2e-3 * size }.into(),
    ]
}

/// Blows, mass, stops, the sensor.
pub(crate) fn outside_effects_at(nominal: &Nominal, size: f64) -> [Effect; 5] {
    let (f, v) = (nominal.f_relief_n, nominal.v_relief_m_per_s());
    let ring_per_s = 2.0 * std::f64::consts::PI * 150.0;
    let impedance = 0.05 * size * f / v;
    [
        ClearanceImpact {
            end_mass_kg: impedance / ring_per_s,
            seat_n_per_m: impedance * ring_per_s,
            damping_ratio: 0.15,
        }
        .into(),
        MovingMass { mass_kg: 0.003 * size * f }.into(),
        BumpStop {
            extension_stop_m: 2.5e-3,
            compression_stop_m: 3.1e-3,
            stiffness_n_per_m: 100.0 * size * f,
            damping_n_s_per_m: 0.3 * size * f,
        }
        .into(),
        ForceOffset { offset_n: 0.01 * size * f }.into(),
        SensorDelay { delay_s: 0.0023 * size }.into(),
    ]
}
