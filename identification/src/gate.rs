//! The hold-out gate: which of the accepted effects survive tests that the search has not seen.
//!
//! An effect may describe the training tests and mislead beyond them. After the search, the model
//! is refitted with every prefix of the accepted effects, and every prefix is simulated on the
//! tests held out. The longest prefix is kept whose error is at most 1.05 times the smallest error
//! of the shorter ones, the refitted nominal model included. Effects that were accepted as a pair
//! are kept or cut together.
//!
//! Only samples within the range of the training tests count: beyond it a true effect may look
//! worse. If fewer than a fifth of the samples, or less than two seconds, are in range, or nothing
//! is held out, the gate uses the training tests left out in turn.
//!
//! Limits: the range is that of displacement and velocity sample by sample. A small loop inside the
//! clearance is in range and yet another motion.

use super::control::Control;
use super::finding::{Accepted, Findings, Rejected};
use super::fit::{Effort, Fit, fit};
use super::judged::Judged;
use super::test_set::{Test, TestSet};
use serde::Serialize;
use signal::statistics::min_max;

/// A longer prefix may have this multiple of the smallest error of the shorter ones.
const WORSE: f64 = 1.05;
/// Share of the held-out samples that must be in range.
const LEAST_SHARE: f64 = 0.2;
/// Length of the held-out samples in range that is enough, s.
const LEAST_S: f64 = 2.0;
/// Room beyond the range of the training tests, as a share of it.
const ROOM: f64 = 0.02;

/// How the accepted effects were checked.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gate {
    /// The samples that decided.
    pub checked_on: CheckedOn,
    /// Share of the held-out samples that are within the range of the training tests.
    pub in_range: f64,
    /// The prefixes, the refitted nominal model first.
    pub prefixes: Vec<Prefix>,
    /// Effects that were cut: they describe the training tests alone.
    pub cut: Vec<&'static str>,
}

/// The samples that decide which effects are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CheckedOn {
    /// The tests held out, within the range of the training tests.
    HoldoutInRange,
    /// The training tests, each left out in turn.
    TrainingLeftOut,
    /// No effect was accepted, or the work was interrupted.
    Nothing,
}

/// A model with the first of the accepted effects.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Prefix {
    /// Its effects.
    pub effects: Vec<&'static str>,
    /// rms error on the training tests, N.
    pub train_rmse_n: Option<f64>,
    /// rms error on all samples of the tests held out, N.
    pub holdout_rmse_n: Option<f64>,
    /// rms error on those in range, N.
    pub in_range_rmse_n: Option<f64>,
    /// rms error on training pieces that were left out in turn, N.
    pub left_out_rmse_n: f64,
}

impl Gate {
    fn nothing() -> Self {
        Self { checked_on: CheckedOn::Nothing, in_range: 0.0, prefixes: vec![], cut: vec![] }
    }
}

/// Findings with the effects that survive, and how they were checked.
pub(crate) fn gate(
    findings: Findings,
    (train, holdout): (&TestSet, &TestSet),
    control: Control<'_>,
) -> (Findings, Gate) {
    if findings.accepted.is_empty() || findings.interrupted {
        return (findings, Gate::nothing());
    }
    control.report("hold-out gate");
    let Some(models) = models(&findings, train, control) else {
        return (findings, Gate::nothing());
    };
    let range = Range::of(train);
    let in_range = range.share_of(holdout);
    let on_holdout = in_range.samples_s >= LEAST_S && in_range.share >= LEAST_SHARE;
    let prefixes: Vec<Prefix> = models
        .iter()
        .map(|(count, model)| {
            let names = findings.accepted[..*count].iter().map(|effect| effect.name);
            prefix(names.collect(), model, (train, holdout), &range)
        })
        .collect();
    let error = |prefix: &Prefix| {
        let held = prefix.in_range_rmse_n.filter(|_| on_holdout);
        held.unwrap_or(prefix.left_out_rmse_n)
    };
    let errors: Vec<f64> = prefixes.iter().map(error).collect();
    let kept = longest_kept(&errors);
    let checked_on =
        if on_holdout { CheckedOn::HoldoutInRange } else { CheckedOn::TrainingLeftOut };
    let (count, model) = &models[kept];
    let cut: Vec<&Accepted> = findings.accepted[*count..].iter().collect();
    let mut gate = Gate { checked_on, in_range: in_range.share, prefixes, cut: vec![] };
    if cut.is_empty() {
        return (findings, gate);
    }
    gate.cut = cut.iter().map(|effect| effect.name).collect();
    let worse = errors.last().copied().unwrap_or(f64::NAN) / errors[kept];
    let rejected = cut.iter().map(|effect| Rejected {
        name: effect.name,
        why: format!(
            "describes the training tests alone: with it the error {} is {worse:.2} times as large",
            if on_holdout { "on the tests held out" } else { "on training tests left out" }
        ),
        holdout_gain: Some(effect.evidence.holdout_gain),
    });
    let rejected = rejected.chain(findings.rejected.iter().cloned()).collect();
    let accepted = findings.accepted[..*count].to_vec();
    let with_effects = model.clone();
    (Findings { with_effects, accepted, rejected, ..findings }, gate)
}

/// The longest prefix whose error is at most [`WORSE`] times the smallest of the shorter ones.
fn longest_kept(errors: &[f64]) -> usize {
    let mut smallest = f64::INFINITY;
    let mut kept = 0;
    for (index, error) in errors.iter().enumerate() {
        if index == 0 || *error <= WORSE * smallest {
            kept = index;
        }
        smallest = smallest.min(*error);
    }
    kept
}

/// The models with the first effects, by their number; none where one of them cannot be fitted.
fn models(
    findings: &Findings,
    train: &TestSet,
    control: Control<'_>,
) -> Option<Vec<(usize, Judged)>> {
    let accepted = &findings.accepted;
    let full = findings.with_effects.fit();
    // A pair is not cut in two.
    let splits_a_pair = |count: usize| {
        accepted[..count].iter().any(|first| {
            first
                .together_with
                .is_some_and(|second| accepted[count..].iter().any(|other| other.name == second))
        })
    };
    (0..=accepted.len())
        .filter(|count| !splits_a_pair(*count))
        .map(|count| {
            let judged = if count == 0 {
                findings.refitted.clone()
            } else if count == accepted.len() {
                findings.with_effects.clone()
            } else {
                refitted(full, count, train, control)?
            };
            Some((count, judged))
        })
        .collect()
}

/// A model with its first effects alone, fitted again.
fn refitted(full: &Fit, effects: usize, train: &TestSet, control: Control<'_>) -> Option<Judged> {
    let (model, values) = full.with_effects_kept(|index| index < effects, &train.scale);
    Judged::new(fit(&model, &values, train, Effort::FULL, control)?, train)
}

fn prefix(
    effects: Vec<&'static str>,
    model: &Judged,
    (train, holdout): (&TestSet, &TestSet),
    range: &Range,
) -> Prefix {
    let held = model.fit().on(holdout);
    let samples = train.counted_samples().max(1) as f64;
    Prefix {
        effects,
        train_rmse_n: train.rmse_n(&model.fit().force_n),
        holdout_rmse_n: held.as_ref().and_then(|fit| holdout.rmse_n(&fit.force_n)),
        in_range_rmse_n: held.as_ref().and_then(|fit| range.rmse_n(holdout, &fit.force_n)),
        left_out_rmse_n: (model.left_out.total_n2() / samples).sqrt(),
    }
}

/// The motion that the training tests have: displacement and velocity, lowest and highest.
struct Range {
    ends: [(f64, f64); 2],
}

/// Held-out samples in range.
struct InRange {
    share: f64,
    samples_s: f64,
}

impl Range {
    fn of(train: &TestSet) -> Self {
        let ends = [displacement, velocity].map(|signal| {
            let each = train.tests.iter().filter_map(|test| min_max(signal(test)));
            let ends = each.reduce(|all, own| (all.0.min(own.0), all.1.max(own.1)));
            let (low, high) = ends.unwrap_or((0.0, 0.0));
            let room = ROOM * (high - low);
            (low - room, high + room)
        });
        Self { ends }
    }

    fn contains(&self, test: &Test, sample: usize) -> bool {
        let values = [displacement(test)[sample], velocity(test)[sample]];
        values.iter().zip(&self.ends).all(|(value, (low, high))| (low..=high).contains(&value))
    }

    fn share_of(&self, tests: &TestSet) -> InRange {
        let (mut inside, mut all, mut samples_s) = (0.0, 0.0, 0.0);
        for test in &tests.tests {
            let count = test.counted().filter(|i| self.contains(test, *i)).count() as f64;
            inside += count;
            all += test.counted().len() as f64;
            samples_s += count * test.record.step_s;
        }
        InRange { share: if all > 0.0 { inside / all } else { 0.0 }, samples_s }
    }

    /// rms error over the samples in range, N.
    fn rmse_n(&self, tests: &TestSet, force_n: &[Vec<f64>]) -> Option<f64> {
        let (mut sum, mut count) = (0.0, 0.0);
        for (test, force_n) in tests.tests.iter().zip(force_n) {
            for i in test.counted().filter(|i| self.contains(test, *i)) {
                let error = test.record.force_n[i] - force_n[i];
                sum += error * error;
                count += 1.0;
            }
        }
        (count > 0.0).then(|| f64::sqrt(sum / count))
    }
}

fn displacement(test: &Test) -> &[f64] {
    &test.record.drive_m
}

fn velocity(test: &Test) -> &[f64] {
    &test.record.velocity_m_per_s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_prefix_that_is_hardly_worse_than_the_best_is_kept() {
        assert_eq!(longest_kept(&[1.0]), 0);
        assert_eq!(longest_kept(&[1.0, 0.5, 0.52]), 2);
        assert_eq!(longest_kept(&[1.0, 0.5, 0.6]), 1);
        // A bad first effect with a good second one: both are kept.
        assert_eq!(longest_kept(&[1.0, 1.5, 0.7]), 2);
        assert_eq!(longest_kept(&[1.0, 1.2, 1.06]), 0);
        // Not finite: a model that diverges survives nothing.
        assert_eq!(longest_kept(&[1.0, f64::NAN]), 0);
    }
}
