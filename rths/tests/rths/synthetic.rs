//! A synthetic record: the same numbers on every machine.

use super::benchmark;
use rths::{Benchmark, COMPENSATORS, NOISE_SEEDS, PLANTS, Record, RthsError, run};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

static FOUND: LazyLock<Benchmark> = LazyLock::new(|| benchmark(&Record::synthetic(1, 12.0)));

/// J2, J4 and J5 of a compensator in a case.
fn of(compensator: &str, case: u8) -> [f64; 3] {
    let mut rows = FOUND.nominal.iter();
    let row = rows.find(|row| row.compensator == compensator && row.case == case).unwrap();
    [2, 4, 5].map(|number| row.criteria.j(number))
}

#[test]
fn criteria_are_the_same_on_every_machine() {
    let found = [
        of("polynomial 2, 18 ms", 2),
        of("inverse", 1),
        of("adaptive", 1),
        of("adaptive", 4),
        of("adaptive, force delay", 3),
        [1, 4, 9].map(|number| FOUND.baseline[3].mean.j(number)),
    ];
    let golden = [
        [13.174, 43.069, 38.256],
        [1.515, 2.761, 3.002],
        [1.503, 2.269, 2.617],
        [1.187, 2.991, 2.960],
        [1.004, 1.231, 1.929],
        [4.395, 63.139, 34.920],
    ];
    for (value, golden) in found.iter().flatten().zip(golden.iter().flatten()) {
        // Three digits.
        let most = 1e-3 * f64::max(*golden, 1.0);
        assert!((value - golden).abs() < most, "{value} {golden}: {found:.3?}");
    }
}

#[test]
fn every_run_has_its_row_and_another_record_has_no_published_table() {
    assert_eq!(FOUND.baseline.len(), 4);
    assert_eq!(FOUND.nominal.len(), 4 * COMPENSATORS.len());
    assert_eq!((FOUND.perturbed.len(), FOUND.extra_delay.len()), (5, 12));
    assert_eq!(FOUND.outside(), None);
}

#[test]
fn the_loop_is_unstable_without_compensation_and_stable_with_it() {
    for row in &FOUND.nominal {
        let unstable = ["none", "polynomial 2, 20 ms"].contains(&row.compensator);
        assert!(unstable || !row.is_saturated, "{row:?}");
        assert!(row.compensator != "none" || row.is_saturated, "{row:?}");
        assert!(!row.has_run_away, "{row:?}");
        // Without the noise that nobody can follow.
        assert!(row.j2_without_noise_percent < row.criteria.j(2) + 0.01, "{row:?}");
    }
}

#[test]
fn the_adaptive_compensator_removes_the_spread_of_the_plants() {
    let sigma = |name: &str| {
        let mut rows = FOUND.perturbed.iter();
        rows.find(|row| row.controller == name).unwrap().j4_percent.sigma
    };
    let [inverse, adaptive] = [sigma("inverse"), sigma("adaptive")];
    assert!(adaptive < 0.2 * inverse, "{adaptive}, of a fixed inverse {inverse}");
}

#[test]
fn a_stopped_benchmark_says_so_and_a_whole_one_counts_its_runs() {
    let record = Record::synthetic(2, 1.5);
    let stopped = run(&record, 1, &AtomicBool::new(true), &|_, _| ());
    assert_eq!(stopped, Err(RthsError::Stopped));
    assert!(!RthsError::Stopped.is_bad_input());
    let most = AtomicUsize::new(0);
    let count = |done: usize, of: usize| {
        assert!(done <= of);
        most.fetch_max(done, Ordering::Relaxed);
    };
    run(&record, 1, &AtomicBool::new(false), &count).unwrap();
    let expected = 4 * NOISE_SEEDS + 8 * COMPENSATORS.len() + 5 * PLANTS + 12;
    assert_eq!(most.into_inner(), expected);
}
