//! Work that is stopped ends with the effects that were accepted until then.

use crate::support::{NOMINAL, SINES, names, question, sensors};
use firmware_core::damper::effects::{AsymmetricDamping, SensorDelay};
use firmware_core::damper::{Damper, Effect};
use identification::{Control, Identification, IdentificationError, Step, identify};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use virtual_bench::bench_visit::Modelled;

/// Two effects are missing; the work is stopped when the given step is reported for the nth time.
fn stopped_at(step: &str, nth: usize) -> Result<Identification, IdentificationError> {
    let effects: [Effect; 2] = [
        AsymmetricDamping { damping_asymmetry: 0.04, relief_asymmetry: 0.04 }.into(),
        SensorDelay { delay_s: 1.5e-3 }.into(),
    ];
    let damper = Damper::new(NOMINAL, &effects).unwrap();
    let question = question(&SINES, &Modelled { damper }, &sensors());
    let (stop, seen) = (AtomicBool::new(false), AtomicUsize::new(0));
    let progress = |now: &Step<'_>| {
        if now.what.starts_with(step) && seen.fetch_add(1, Ordering::Relaxed) + 1 == nth {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let found = identify(question, Control { progress: &progress, stop: &stop });
    assert!(stop.into_inner(), "no step {step} number {nth}");
    found
}

#[test]
fn before_the_nominal_fit_there_is_no_result() {
    let why = stopped_at("nominal damper", 1).unwrap_err();
    assert!(matches!(why, IdentificationError::Interrupted) && !why.is_bad_input(), "{why}");
}

#[test]
fn in_the_first_round_nothing_is_accepted_and_every_candidate_is_open() {
    for step in ["rehearsing", "fitting", "settling"] {
        let found = stopped_at(step, 1).unwrap();
        assert!(found.result.interrupted, "{step}");
        assert_eq!(names(&found), [""; 0], "{step}");
        let open = &found.result.rejected;
        assert!(open.len() > 5 && open.iter().all(|one| one.why.contains("interrupted")));
        let map = found.result.empirical.as_ref().unwrap();
        assert!(!map.kept && map.why.starts_with("interrupted"), "{map:?}");
        assert!(found.summary().starts_with("interrupted: "), "{}", found.summary());
    }
}

#[test]
fn in_a_later_round_the_effects_accepted_before_stay() {
    let found = stopped_at("screening", 2).unwrap();
    assert!(found.result.interrupted);
    assert_eq!(names(&found).len(), 1, "{:?}", names(&found));
    assert!(!found.result.rejected.iter().any(|one| names(&found).contains(&one.name)));
    assert_eq!(found.damper.effects().len(), 1);
}
