use super::*;
use scenario::run::Overrides;
use std::path::Path;
use std::sync::LazyLock;

fn scenario(name: &str) -> Run {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name);
    Run::load(&file, Overrides::default()).unwrap()
}

fn question() -> Question {
    Question {
        sine: Sine { stroke_m: 4e-3, frequency_hz: 3.5 },
        clearances_m: vec![0.0, 1e-3, 4e-3, 8e-3],
        stiffnesses_n_per_m: vec![3e6, 6e6, 12.5e6],
        delays_s: vec![1e-3, 5e-3, 15e-3],
        lags_s: vec![0.5e-3],
    }
}

fn map(name: &str, question: &Question) -> WearMap {
    let never = AtomicBool::new(false);
    let found = wear_map(&scenario(name), question, &never, &|_, _| ()).unwrap().unwrap();
    println!("{}", found.summary().to_text());
    found
}

/// The map of ideal rigs, for the tests that read it.
static IDEAL: LazyLock<WearMap> = LazyLock::new(|| map("ss9-one-worn-of-four.toml", &question()));

#[test]
fn what_a_run_accepts_holds_and_what_does_not_hold_is_refused() {
    let found = &*IDEAL;
    let broken: Vec<&Cell> = found.broken().collect();
    assert!(broken.is_empty(), "{broken:#?}");
    let refused = found.cells.iter().filter(|cell| !cell.is_accepted).count();
    let lacking = found.cells.iter().filter(|cell| !cell.holds).count();
    assert!(lacking > 0 && refused >= lacking, "{refused} refused, {lacking} do not hold");
    // Nine of ten are accepted, and with a model that is right all of them.
    assert!(10 * refused < found.cells.len(), "{refused} of {}", found.cells.len());
    let known = found.cells.iter().filter(|cell| cell.specimen == "as its model");
    assert!(known.into_iter().all(|cell| cell.is_accepted && cell.force_error_percent < 1.1));
}

#[test]
fn the_expected_error_is_that_of_the_force() {
    let found = &*IDEAL;
    // Where the damper is unlike its model and the joint is soft; rounding adds what it adds.
    let soft = found.cells.iter().filter(|cell| cell.ke_mn_per_m < 12.0);
    for cell in soft.filter(|cell| cell.expected_error_percent.unwrap() > 1.0) {
        let expected = cell.expected_error_percent.unwrap();
        let ratio = cell.force_error_percent / expected;
        assert!((0.4..1.3).contains(&ratio), "{cell:#?}");
    }
}

/// Its compensator is made for a pure delay, and its ram gives way to the force.
#[test]
fn wear_is_refused_on_a_servo_rig_that_strays() {
    let none = Question { delays_s: Vec::new(), ..question() };
    let found = map("ss9-160kmh-servo-rig.toml", &none);
    let broken: Vec<&Cell> = found.broken().collect();
    assert!(broken.is_empty(), "{broken:#?}");
    let refused = found.cells.iter().filter(|cell| !cell.is_accepted).count();
    assert!(2 * refused > found.cells.len(), "{refused} of {}", found.cells.len());
}

#[test]
fn a_flag_stops_a_map() {
    let stopped = AtomicBool::new(true);
    let run = scenario("ss9-one-worn-of-four.toml");
    assert_eq!(wear_map(&run, &question(), &stopped, &|_, _| ()).unwrap(), None);
}
