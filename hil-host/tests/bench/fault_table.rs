//! The faults of `yawbench faults`: the table, and random ones.

use crate::support::locomotive::scenario;
use hil_host::faults::{ROWS, schedule, table};
use std::sync::atomic::AtomicBool;

#[test]
fn every_fault_of_the_table_is_found_in_time_and_ends_as_it_should() {
    let mut wrong = Vec::new();
    let all_right = table(&scenario(), |row, injected, is_right| {
        if !is_right {
            wrong.push(format!("{} {}: {injected:?}", row.number, row.what));
        }
    });
    assert_eq!(wrong, Vec::<String>::new());
    assert!(all_right.unwrap());
    assert_eq!(ROWS.len(), 90);
}

#[test]
fn random_faults_move_no_command_beyond_its_limits_and_run_on_nothing_stale() {
    const SEED: u64 = 20_261_129;
    println!("seed {SEED}");
    let survey = schedule(&scenario(), SEED, 600_000, &AtomicBool::new(false), &|_| {}).unwrap();
    assert_eq!(survey.violations, Vec::new());
    assert!(survey.cycles >= 600_000 && survey.refused == 0, "{survey:?}");
    // All three outcomes occur.
    assert!(survey.went_on.min(survey.ramped_out).min(survey.safe) > 10, "{survey:?}");
}
