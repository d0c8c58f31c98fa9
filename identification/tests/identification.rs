//! Identification on records whose truth is known: nothing missing, a named effect, something that
//! no effect describes.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use firmware_core::damper::effects::{AsymmetricDamping, SensorDelay};
use firmware_core::damper::{Damper, Effect, Nominal};
use identification::empirical::empirical;
use identification::fit::Fit;
use identification::result::{Errors, Verdict};
use identification::search::search;
use identification::simulation::{simulate, start_deflection_m};
use identification::start::nominal_fit;
use identification::tests_at_hand::TestsAtHand;
use identification::{Identification, Question, identify};
use std::sync::Mutex;
use virtual_bench::bench_visit::excitation::Excitation;
use virtual_bench::bench_visit::protocol::Test;
use virtual_bench::bench_visit::sensors::{Coloured, Sensors};
use virtual_bench::bench_visit::{Modelled, NullGenerator, Specimen, record};
use virtual_bench::series_model::SeriesModel;
use virtual_bench::series_model::outside::Outside;

const NOMINAL: Nominal = Nominal {
    ce_n_s_per_m: 0.9e6,
    ke_n_per_m: 10.5e6,
    clearance_2a_m: 0.6e-3,
    f_relief_n: 14e3,
    c2_n_s_per_m: 55e3,
};

/// The same damper for the generator that shares nothing with the core.
const SERIES: SeriesModel = SeriesModel {
    ce_n_s_per_m: NOMINAL.ce_n_s_per_m,
    ke_n_per_m: NOMINAL.ke_n_per_m,
    clearance_2a_m: NOMINAL.clearance_2a_m,
    f_relief_n: NOMINAL.f_relief_n,
    c2_n_s_per_m: NOMINAL.c2_n_s_per_m,
};

/// Amplitude and frequency of each, mm and Hz.
const SINES: [(f64, f64); 6] =
    [(1.0, 3.5), (3.46, 3.5), (7.0, 3.5), (1.5, 1.2), (1.0, 8.0), (2.5, 2.5)];

fn sensors() -> Sensors {
    Sensors::of_range(50e3, 0.05)
}

/// Five sines to fit, one to hold out; with the wish for an empirical map, which changes no finding.
fn investigate(specimen: &dyn Specimen, sensors: &Sensors) -> Identification {
    investigate_with(&SINES, specimen, sensors)
}

fn investigate_with(
    sines: &[(f64, f64)],
    specimen: &dyn Specimen,
    sensors: &Sensors,
) -> Identification {
    let mut records: Vec<_> = sines
        .iter()
        .enumerate()
        .map(|(index, (amplitude_mm, frequency_hz))| {
            let sine = Excitation::sine(amplitude_mm * 1e-3, *frequency_hz);
            let name = format!("{amplitude_mm}mm-{frequency_hz}hz");
            let test = Test::new(name, sine, 5.0_f64.max(6.0 / frequency_hz));
            record(specimen, &test, sensors, 40 + index as u64).measurement().unwrap()
        })
        .collect();
    let holdout = vec![records.pop().unwrap()];
    let question = Question {
        train: records,
        holdout,
        datasheet: None,
        empirical: true,
        thorough: false,
        notes: Vec::new(),
    };
    identify(question, &|_| {}).unwrap()
}

fn names(found: &Identification) -> Vec<&str> {
    found.result.effects.iter().map(|effect| effect.name).collect()
}

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
        let floor_n = found.result.noise_floor_n;
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
    assert!(after.holdout_rmse_n.unwrap() < 1.1 * found.result.noise_floor_n);
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
    let errors = found.result.errors.with_effects.unwrap();
    assert!(errors.holdout_rmse_n.unwrap() < 1.1 * found.result.noise_floor_n);
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

#[test]
fn a_worn_bore_gets_a_map_over_displacement_that_is_no_physics() {
    let reference = Excitation::sine(5e-3, 2.5);
    let worn = Outside::WornBand { depth: 0.0, at_m: 0.8e-3, width_m: 3e-3 };
    let (worn, _) = worn.sized(0.05, &SERIES, &reference);
    let specimen = NullGenerator { model: SERIES, outside: vec![worn] };
    // All strokes pass the band under relief: where they do not, no one map serves them all.
    let sines = [(4.0, 3.5), (6.0, 1.5), (5.0, 2.5), (8.0, 2.0), (4.5, 3.0), (6.0, 3.0)];
    let found = investigate_with(&sines, &specimen, &sensors());
    // What it is stays unknown, however well a map describes it.
    assert_eq!(found.result.verdict, Verdict::Unexplained, "{:?}", found.result.effects);
    assert_eq!(found.result.unexplained.as_ref().unwrap().coordinate, "displacement");

    // More than noise is left, so pairs are tried; past the limit of work none is, and that is told.
    let told = Mutex::new(Vec::new());
    let progress = |what: &str| told.lock().unwrap().push(what.to_owned());
    assert!(found.train.passes() > 1000.0, "{} passes", found.train.passes());
    let nominal = nominal_fit(&found.train, None).unwrap();
    assert!(search(nominal, &found.train, 1.0, &progress).unwrap().cut_short);
    let told = told.into_inner().unwrap();
    assert!(told.contains(&"screening".to_owned()));
    assert!(!told.iter().any(|what| what.starts_with("with ")), "{told:?}");

    let part = found.result.empirical.as_ref().unwrap();
    assert!(part.kept && part.coordinate == Some("displacement"), "{part:?}");
    assert!(part.holdout_gain.unwrap() > 0.5 && part.tests_improved == Some(1.0), "{part:?}");
    let held = |errors: Option<Errors>| errors.unwrap().holdout_rmse_n.unwrap();
    let (before, after) = (held(found.result.errors.with_effects), held(part.errors));
    assert!(after < 0.75 * before, "{before} {after}");

    // The forces are those of the damper with its map, from wherever its dashpot starts best.
    let fitted = found.empirical.as_ref().unwrap().kept().unwrap();
    let test = &found.holdout.tests[0];
    let start_m = start_deflection_m(&fitted.damper, test);
    assert_eq!(simulate(&fitted.damper, test, start_m), fitted.on_holdout[0]);
    assert_eq!(fitted.damper.clone().without_empirical(), found.damper().unwrap());
    // Less force where the bore is worn, on either branch on its own side of the stroke.
    let knots = fitted.map.knots();
    let lowest = knots.iter().min_by(|a, b| a.upper_n.total_cmp(&b.upper_n)).unwrap();
    let highest = knots.iter().max_by(|a, b| a.lower_n.total_cmp(&b.lower_n)).unwrap();
    assert!(lowest.upper_n < -800.0 && (0.0..4e-3).contains(&lowest.at), "{lowest:?}");
    assert!(highest.lower_n > 800.0 && (-4e-3..2e-3).contains(&highest.at), "{highest:?}");

    // A sound damper held out: there the map is wrong, so it is not kept.
    let sound = NullGenerator { model: SERIES, outside: Vec::new() };
    let test = Test::new("sound".to_owned(), Excitation::sine(6e-3, 3.0), 5.0);
    let sound = record(&sound, &test, &sensors(), 50).measurement().unwrap();
    let sound = TestsAtHand::new(vec![sound]);
    let model = &found.found.with_effects;
    let fit = &model.standing.fit;
    let fit = Fit::of(&fit.model, &fit.values, &sound).unwrap();
    let tried = empirical(model, &found.left_after, Some(&fit), (&found.train, &sound));
    assert!(!tried.kept && tried.kept().is_none() && tried.fitted.is_some(), "{}", tried.why);
    assert!(tried.why.starts_with("worse on the tests held out: "), "{}", tried.why);
}
