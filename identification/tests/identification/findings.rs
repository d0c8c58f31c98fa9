//! Verdicts: nothing missing, one effect, two effects, a disturbance that no effect describes.

use crate::support::{NOMINAL, SERIES, investigate, names, sensors};
use firmware_core::damper::effects::{
    AsymmetricDamping, PreslidingFriction, SensorDelay, SoftYield,
};
use firmware_core::damper::{Damper, Effect};
use identification::result::{EffectFound, Verdict};
use virtual_bench::bench_visit::excitation::Excitation;
use virtual_bench::bench_visit::sensors::{Coloured, Sensors};
use virtual_bench::bench_visit::{Modelled, NullGenerator};
use virtual_bench::series_model::outside::Outside;

#[test]
fn nothing_is_named_where_nothing_is_missing() {
    let specimen = NullGenerator { model: SERIES, outside: Vec::new() };
    let coloured = Some(Coloured { level_n: 60.0, rho_per_ms: 0.95 });
    for sensors in [sensors(), Sensors { coloured, ..sensors() }] {
        let found = investigate(&specimen, &sensors);
        assert_eq!(found.result.verdict, Verdict::NoMissingEffect, "{:?}", found.result.effects);
        let map = found.result.empirical.as_ref().unwrap();
        assert!(!map.kept, "a map of nothing: {map:?}");
        let errors = found.result.errors.refitted.unwrap();
        let floor_n = found.result.noise_floor_n.unwrap();
        assert!((errors.holdout_rmse_n.unwrap() / floor_n - 1.0).abs() < 0.1, "{errors:?}");
        for (name, truth) in [("ce_n_s_per_m", 0.9e6), ("ke_n_per_m", 10.5e6), ("f_relief_n", 14e3)]
        {
            let value = &found.result.nominal[name];
            let miss = (value.value - truth).abs();
            assert!(miss < 4.0 * value.std.unwrap() + 1e-3 * truth, "{name} {value:?}");
        }
    }
}

#[test]
fn a_missing_effect_is_named_with_its_size() {
    let effect = AsymmetricDamping { damping_asymmetry: 0.03, relief_asymmetry: 0.02 };
    let damper = Damper::new(NOMINAL, &[effect.into()]).unwrap();
    let found = investigate(&Modelled { damper }, &sensors());
    assert_eq!(names(&found), ["asymmetric_damping"], "{:?}", found.result);
    assert_eq!(found.result.verdict, Verdict::EffectsFound);
    for (name, truth) in [("damping_asymmetry", 0.03), ("relief_asymmetry", 0.02)] {
        let value = &found.result.effects[0].parameters[name];
        assert!((value.value - truth).abs() < 4.0 * value.std.unwrap(), "{name} {value:?}");
    }
    let errors = &found.result.errors;
    let (before, after) = (errors.refitted.unwrap(), errors.with_effects.unwrap());
    assert!(after.holdout_rmse_n.unwrap() < 0.6 * before.holdout_rmse_n.unwrap());
    assert!(after.holdout_rmse_n.unwrap() < 1.1 * found.result.noise_floor_n.unwrap());
}

#[test]
fn a_soft_yield_is_named_with_its_size() {
    let effect = SoftYield { yield_n: 2e3, knee_m_per_s: 20e-3 };
    let damper = Damper::new(NOMINAL, &[effect.into()]).unwrap();
    let found = investigate(&Modelled { damper }, &sensors());
    assert_eq!(names(&found), ["soft_yield"], "{:?}", found.result);
    assert_eq!(found.result.verdict, Verdict::EffectsFound);
    println!("{:?}", found.result.effects[0].alternatives);
    for (name, truth) in [("yield_n", 2e3), ("knee_m_per_s", 20e-3)] {
        let value = &found.result.effects[0].parameters[name];
        println!("{name} {value:?}");
        assert!((value.value - truth).abs() < 4.0 * value.std.unwrap(), "{name} {value:?}");
    }
    let errors = found.result.errors.with_effects.unwrap();
    assert!(errors.holdout_rmse_n.unwrap() < 1.1 * found.result.noise_floor_n.unwrap());
}

#[test]
fn a_presliding_friction_is_named_with_its_size() {
    let effect = PreslidingFriction {
        capacity_n: 600.0,
        travel_m: 0.3e-3,
        direction_asymmetry: 0.0,
        low_speed_rise: 0.0,
        stribeck_m_per_s: 10e-3,
    };
    let damper = Damper::new(NOMINAL, &[effect.into()]).unwrap();
    let found = investigate(&Modelled { damper }, &sensors());
    assert_eq!(names(&found), ["presliding_friction"], "{:?}", found.result);
    assert_eq!(found.result.verdict, Verdict::EffectsFound);
    println!("{:?}", found.result.effects[0].alternatives);
    for (name, truth) in [("capacity_n", 600.0), ("travel_m", 0.3e-3)] {
        let value = &found.result.effects[0].parameters[name];
        println!("{name} {value:?}");
        assert!((value.value - truth).abs() < 4.0 * value.std.unwrap(), "{name} {value:?}");
    }
    let errors = found.result.errors.with_effects.unwrap();
    assert!(errors.holdout_rmse_n.unwrap() < 1.1 * found.result.noise_floor_n.unwrap());
}

#[test]
fn two_effects_are_found_one_after_the_other() {
    let effects: [Effect; 2] = [
        AsymmetricDamping { damping_asymmetry: 0.04, relief_asymmetry: 0.04 }.into(),
        SensorDelay { delay_s: 1.5e-3 }.into(),
    ];
    let damper = Damper::new(NOMINAL, &effects).unwrap();
    let found = investigate(&Modelled { damper }, &sensors());
    let mut named = names(&found);
    named.sort_unstable();
    assert_eq!(named, ["asymmetric_damping", "sensor_delay"]);
    let asymmetric = |effect: &&EffectFound| effect.name == "asymmetric_damping";
    let asymmetry = found.result.effects.iter().find(asymmetric).unwrap();
    let [damping, relief] =
        ["damping_asymmetry", "relief_asymmetry"].map(|name| asymmetry.parameters[name].value);
    assert_eq!(damping, relief, "one asymmetry is enough");
    let errors = found.result.errors.with_effects.unwrap();
    assert!(errors.holdout_rmse_n.unwrap() < 1.1 * found.result.noise_floor_n.unwrap());
}

#[test]
fn what_no_effect_describes_is_left_unexplained() {
    let reference = Excitation::sine(3.46e-3, 3.5);
    let ripple = Outside::SpeedSynchronousRipple { amplitude_n: 1.0, multiple: 3.37 };
    let (ripple, _) = ripple.sized(0.02, &SERIES, &reference);
    let specimen = NullGenerator { model: SERIES, outside: vec![ripple] };
    let found = investigate(&specimen, &sensors());
    assert_eq!(found.result.verdict, Verdict::Unexplained, "{:?}", found.result.effects);
    assert_eq!(found.result.unexplained.unwrap().coordinate, "frequency");
}
