//! The rates that have targets, and those that are reported next to them.

use super::line::CaseResult;
use super::verdict::{counts, is_as_lower_ke, is_right, is_small};
use super::wilson::Rate;
use serde::Serialize;

/// Error on the third set over that of the true damper that is good enough.
const LARGEST_OVER_TRUTH: f64 = 1.15;
/// The same over that of the refitted nominal damper.
const LARGEST_OVER_REFIT: f64 = 1.05;
/// A known noise floor may be off by this share.
const FLOOR_SHARE: f64 = 0.3;
/// A lower bound of the noise may be this much too high.
const BOUND_RATIO: f64 = 1.1;
/// Motions whose cycles or tests repeat.
const REPEATING: [&str; 2] = ["sines", "short"];

/// A rate, with its target where it has one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Aim {
    /// What is counted.
    pub what: String,
    /// The rate.
    pub rate: Rate,
    /// Cases of this kind that did not vote: their size was not reached, or they have no value.
    pub not_voting: usize,
    /// Where it should lie, both ends included; none where it is only reported.
    pub target: Option<(f64, f64)>,
    /// It does; none without cases or without a target.
    pub met: Option<bool>,
    /// Its one-sided 95 % bounds do, too.
    pub shown: bool,
}

impl Aim {
    /// The rate of votes; none is a case that does not vote.
    fn of(
        what: &str,
        votes: impl Iterator<Item = Option<bool>>,
        target: impl Into<Option<(f64, f64)>>,
    ) -> Self {
        let target = target.into();
        let votes: Vec<Option<bool>> = votes.collect();
        let rate = Rate::of(votes.iter().copied().flatten());
        let within = |value: f64| target.map(|(low, high)| (low..=high).contains(&value));
        Self {
            what: what.to_owned(),
            not_voting: votes.iter().filter(|vote| vote.is_none()).count(),
            met: rate.rate.and_then(within),
            shown: rate.of > 0
                && target.is_some_and(|(low, high)| {
                    (low == 0.0 || low <= rate.lower) && (high == 1.0 || rate.upper <= high)
                }),
            rate,
            target,
        }
    }
}

/// All of them, for some cases.
pub(super) fn aims(lines: &[CaseResult]) -> Vec<Aim> {
    [names(lines), unknown(lines), errors(lines), noise(lines), others(lines)].concat()
}

const fn at_least(rate: f64) -> (f64, f64) {
    (rate, 1.0)
}

fn of<'a>(
    lines: &'a [CaseResult],
    kinds: &'a [&'a str],
) -> impl Iterator<Item = &'a CaseResult> + Clone {
    lines.iter().filter(|line| kinds.contains(&line.kind.as_str()))
}

/// The vote of a case that counts.
fn vote(line: &CaseResult, holds: impl FnOnce(&CaseResult) -> bool) -> Option<bool> {
    counts(line).then(|| line.failure.is_none() && holds(line))
}

/// Names where nothing is missing, and where effects are.
fn names(lines: &[CaseResult]) -> Vec<Aim> {
    let nothing = || of(lines, &["nothing"]);
    let effects = |size: &'static [f64]| {
        of(lines, &["effect"])
            .filter(|line| !is_as_lower_ke(line) && size.contains(&line.size))
            .map(|line| vote(line, is_right))
    };
    let neighbours = || of(lines, &["neighbour"]);
    let first = CaseResult::first_is_right;
    vec![
        Aim::of(
            "nothing missing: no name",
            nothing().map(|line| vote(line, is_right)),
            at_least(0.99),
        ),
        Aim::of(
            "nothing missing: nothing said to be unexplained",
            nothing().map(|line| vote(line, |line| !line.says_unexplained())),
            at_least(0.95),
        ),
        Aim::of(
            "nothing missing: no name, nothing unexplained, and judged",
            nothing().map(|line| vote(line, CaseResult::is_clean)),
            None,
        ),
        Aim::of(
            "effect of 3 or 10: named first or in its group",
            effects(&[3.0, 10.0]),
            at_least(0.95),
        ),
        Aim::of("effect of 3: named first or in its group", effects(&[3.0]), at_least(0.95)),
        Aim::of("effect of 10: named first or in its group", effects(&[10.0]), at_least(0.95)),
        Aim::of("effect of 1.5: named first or in its group", effects(&[1.5]), None),
        Aim::of(
            "effect as a lower Ke: no name",
            of(lines, &["effect"])
                .filter(|line| is_as_lower_ke(line))
                .map(|line| vote(line, is_right)),
            None,
        ),
        Aim::of(
            "pair of effects: both named",
            of(lines, &["pair"]).map(|line| vote(line, is_right)),
            None,
        ),
        Aim::of("neighbour: the right name", neighbours().map(|line| vote(line, first)), None),
        Aim::of(
            "neighbour: the right name, and that something remains",
            neighbours().map(|line| vote(line, |line| first(line) && line.is_honest())),
            None,
        ),
        Aim::of(
            "neighbour: the right name, or that something remains",
            neighbours().map(|line| vote(line, is_right)),
            None,
        ),
    ]
}

/// What the catalogue cannot name.
fn unknown(lines: &[CaseResult]) -> Vec<Aim> {
    let right = |kinds: &'static [&'static str]| of(lines, kinds).map(|line| vote(line, is_right));
    vec![
        Aim::of(
            "outside and hidden: no clean verdict, no confident name",
            right(&["outside", "hidden"]),
            at_least(0.99),
        ),
        Aim::of(
            "outside: no clean verdict, no confident name",
            right(&["outside"]),
            at_least(0.99),
        ),
        Aim::of("hidden: no clean verdict, no confident name", right(&["hidden"]), at_least(0.99)),
        Aim::of(
            "outside and hidden: no clean verdict",
            of(lines, &["outside", "hidden"]).map(|line| vote(line, |line| !line.is_clean())),
            at_least(1.0),
        ),
        Aim::of(
            "outside and hidden: said to be unexplained",
            of(lines, &["outside", "hidden"]).map(|line| vote(line, CaseResult::says_unexplained)),
            None,
        ),
    ]
}

/// Errors on the third set, and intervals.
fn errors(lines: &[CaseResult]) -> Vec<Aim> {
    let has_truth = |line: &&CaseResult| line.errors.is_some_and(|errors| errors.truth_n.is_some());
    let intervals = lines.iter().flat_map(|line| &line.intervals);
    vec![
        Aim::of(
            "third set: at most 1.15 times the error of the true damper",
            lines
                .iter()
                .filter(has_truth)
                .map(|line| line.over_truth().map(|ratio| ratio <= LARGEST_OVER_TRUTH)),
            at_least(0.95),
        ),
        Aim::of(
            "third set: a named model at most 1.05 times the error of the refit",
            lines
                .iter()
                .filter(|line| !line.named.is_empty())
                .map(|line| line.over_refit().map(|ratio| ratio <= LARGEST_OVER_REFIT)),
            at_least(0.99),
        ),
        Aim::of(
            "stated 95 % intervals hold the truth",
            intervals.map(|interval| Some(interval.covers)),
            (0.90, 0.98),
        ),
    ]
}

/// The noise floor and its bound.
fn noise(lines: &[CaseResult]) -> Vec<Aim> {
    let judged = || lines.iter().filter(|line| !line.verdict.is_empty());
    let stated = |motions: &'static [&'static str]| {
        judged()
            .filter(|line| motions.contains(&line.motion.as_str()))
            .map(|line| Some(line.noise_floor_n.is_some()))
    };
    vec![
        Aim::of(
            "a known noise floor within 30 % of the noise",
            judged().map(floor_is_right),
            at_least(0.95),
        ),
        Aim::of("noise floor stated: sines and short tests", stated(&REPEATING), at_least(1.0)),
        Aim::of("noise floor stated: tapered tests", stated(&["tapered"]), None),
        Aim::of(
            "noise floor stated: random, sweep and earthquake",
            stated(&["random", "sweep", "earthquake"]),
            None,
        ),
        Aim::of(
            "a lower bound of the noise at most 1.1 times the noise",
            judged().map(|line| Some(line.noise_at_least_n? <= BOUND_RATIO * line.true_noise_n?)),
            at_least(0.95),
        ),
        Aim::of("not judged", judged().map(|line| Some(line.verdict == "not_judged")), None),
    ]
}

/// A known noise floor is near the noise.
pub(super) fn floor_is_right(line: &CaseResult) -> Option<bool> {
    Some((line.noise_floor_n? / line.true_noise_n? - 1.0).abs() <= FLOOR_SHARE)
}

fn others(lines: &[CaseResult]) -> Vec<Aim> {
    let asked = || lines.iter().filter_map(|line| line.next_test.as_ref());
    vec![
        Aim::of(
            "a wrong datasheet changes nothing",
            of(lines, &["wrong_datasheet"]).map(|line| vote(line, is_right)),
            at_least(1.0),
        ),
        Aim::of(
            "hydraulic damper: nothing named that it does not have",
            of(lines, &["hydraulic"]).map(|line| vote(line, is_right)),
            at_least(0.95),
        ),
        Aim::of(
            "rivals, one of them true: separated by the proposed test",
            asked().map(|next| next.separated),
            at_least(0.90),
        ),
        Aim::of(
            "rivals, one of them true: separated, no proposal counted as no",
            asked().map(|next| next.true_one.as_ref().map(|_| next.separated == Some(true))),
            None,
        ),
    ]
}

/// What is missing has to be found: it counts and is not small.
pub(super) fn has_to_be_right(line: &CaseResult) -> bool {
    counts(line) && !is_small(line)
}
