//! A visit that is stopped keeps the tests that it has recorded.

use crate::support::Folder;
use std::sync::atomic::{AtomicBool, Ordering};
use virtual_bench::characterisation::Outcome;

/// The outcome of a visit that is stopped when a test begins, counted over the trial without noise
/// and the recording.
fn stopped_at(folder: &Folder, beginning: usize) -> Outcome {
    let (stop, mut begun) = (AtomicBool::new(false), 0);
    let mut begins = |_| {
        stop.store(begun == beginning, Ordering::Relaxed);
        begun += 1;
    };
    folder.visit().run(&[], &stop, &mut begins).unwrap()
}

#[test]
fn the_tests_recorded_so_far_have_their_figures() {
    let folder = Folder::new("stop");
    let whole = folder.visit().run(&[], &AtomicBool::new(false), &mut |_| {}).unwrap();
    assert!(!whole.file.is_interrupted() && whole.records.len() == 3);
    // Three tests without noise come first.
    let part = stopped_at(&folder, 5);
    assert!(part.file.is_interrupted());
    assert!(part.records == whole.records[..2]);
    assert!(part.file.to_string().ends_with("interrupted: later tests were not recorded\n"));
    let json = |outcome: &Outcome| serde_json::to_value(&outcome.file).unwrap();
    assert_eq!(json(&part)["interrupted"], true);
    assert_eq!(json(&part)["tests"][1], json(&whole)["tests"][1]);
    assert_eq!(json(&part)["sensors"], json(&whole)["sensors"]);
}

#[test]
fn nothing_is_recorded_where_the_trial_is_stopped() {
    let folder = Folder::new("trial");
    let stop = AtomicBool::new(true);
    let outcome = folder.visit().run(&[], &stop, &mut |_| {}).unwrap();
    assert!(outcome.records.is_empty() && outcome.file.is_interrupted());
}
