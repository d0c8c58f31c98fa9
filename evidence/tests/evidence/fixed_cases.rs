//! Twelve brief cases of one seed: every motion twice, every noise, and most kinds of truth. They
//! are no statistics; they show that the campaign and `identify` still give what they gave.

use evidence::campaign::{Campaign, CaseResult, Table, is_right, text, times};
use std::sync::atomic::AtomicBool;

const CAMPAIGN: Campaign = Campaign { cases: 1254, seed: 1, brief: true };

/// Number of the case, kind of truth, motion, noise and truth.
const CASES: [(usize, &str, &str, &str, &str); 12] = [
    (49, "nothing", "sines", "filtered", ""),
    (108, "nothing", "short", "white", ""),
    (96, "nothing", "random", "averaged", ""),
    (104, "nothing", "earthquake", "white", ""),
    (54, "outside", "sweep", "filtered", "valve_flutter"),
    (1, "hidden", "tapered", "coloured", "ripple_over_position"),
    (64, "neighbour", "sines", "drifting", "exponential_friction"),
    (52, "neighbour", "earthquake", "coloured", "exponential_friction"),
    (86, "effect", "random", "coloured", "presliding_friction"),
    (94, "effect", "tapered", "white", "moving_mass"),
    (33, "effect", "short", "filtered", "stroke_dependent_stiffness"),
    (43, "effect", "sweep", "drifting", "moving_mass"),
];

/// Those of every run of the tests: one of each kind that costs little.
const FEW: [usize; 3] = [49, 54, 94];

/// Cases of these that `identify` still gets wrong: a neighbour of seal friction that five drifting
/// tests leave unnamed, under a verdict of nothing missing at eleven times the noise.
const STILL_WRONG: [usize; 1] = [64];

fn run(index: usize) -> CaseResult {
    let stop = AtomicBool::new(false);
    CAMPAIGN.case(index, &stop).unwrap()
}

#[test]
fn three_fixed_cases_have_the_outcome_that_they_had() {
    have_the_outcome_that_they_had(&FEW);
}

#[test]
#[ignore = "minutes; `cargo xtask ci --full` runs it"]
fn twelve_fixed_cases_have_the_outcome_that_they_had() {
    have_the_outcome_that_they_had(&CASES.map(|(index, ..)| index));
}

fn have_the_outcome_that_they_had(asked: &[usize]) {
    let mut lines = Vec::new();
    for (index, kind, motion, noise, truth) in CASES {
        if !asked.contains(&index) {
            continue;
        }
        let line = run(index);
        let case = (line.kind.as_str(), line.motion.as_str(), line.noise.as_str());
        assert_eq!(case, (kind, motion, noise), "case {index}");
        assert_eq!(line.truth.join(" "), truth, "case {index}");
        println!("{index}: {line:?}");
        lines.push(line);
    }
    assert_eq!(lines.len(), asked.len(), "cases that are not in the list: {asked:?}");
    let table = Table::new(&lines);
    println!("{}\n{}", text(&table), times(&lines));
    let wrong: Vec<usize> =
        lines.iter().filter(|line| !is_as_expected(line)).map(|line| line.index).collect();
    println!("wrong: {wrong:?}");
    assert!(wrong.iter().all(|index| STILL_WRONG.contains(index)), "{wrong:?}");
}

/// Right, and in the way that fits its kind.
fn is_as_expected(line: &CaseResult) -> bool {
    let is_worse = line.over_refit().is_some_and(|ratio| ratio > 1.05);
    let said = match line.kind.as_str() {
        "nothing" => line.is_clean(),
        "outside" | "hidden" => line.says_unexplained() && line.named.is_empty(),
        _ => !line.is_clean(),
    };
    is_right(line) && said && !is_worse
}
