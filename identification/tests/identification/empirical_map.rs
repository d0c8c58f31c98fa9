//! An empirical map of what no effect describes.

use crate::support::{SERIES, investigate_with, sensors};
use identification::result::{Errors, Verdict};
use identification::{
    Control, Step, TestSet, empirical, nominal_fit, search, simulate, start_deflection_m,
};
use std::sync::Mutex;
use virtual_bench::bench_visit::excitation::Excitation;
use virtual_bench::bench_visit::protocol::Test;
use virtual_bench::bench_visit::{NullGenerator, record};
use virtual_bench::series_model::outside::Outside;

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

    // More than noise remains, so pairs are tried; past the limit of work none is, and that is
    // reported.
    let steps = Mutex::new(Vec::new());
    let progress = |step: &Step<'_>| steps.lock().unwrap().push(step.what.to_owned());
    assert!(found.train.passes() > 1000.0, "{} passes", found.train.passes());
    let nominal = nominal_fit(&found.train, None, Control::QUIET).unwrap();
    let control = Control { progress: &progress, ..Control::QUIET };
    assert!(search(nominal, &found.train, 1.0, control).unwrap().cut_short);
    let steps = steps.into_inner().unwrap();
    assert!(steps.contains(&"screening".to_owned()));
    assert!(!steps.iter().any(|step| step.starts_with("with ")), "{steps:?}");

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
    assert_eq!(fitted.damper.clone().without_empirical(), found.damper);
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
    let sound = TestSet::new(vec![sound]);
    let model = &found.findings.with_effects;
    let fit = model.fit().on(&sound).unwrap();
    let tried = empirical(model, &found.residual_after, Some(&fit), (&found.train, &sound));
    assert!(!tried.kept && tried.kept().is_none() && tried.fitted.is_some(), "{}", tried.why);
    assert!(tried.why.starts_with("worse on the tests held out: "), "{}", tried.why);
}
