//! The search: which effects are missing, one after the other.
//!
//! 1. Screen every candidate against the residual of the standing model ([`super::screening`]).
//! 2. Fit the best few together with all other parameters, free-running ([`super::trial`]).
//! 3. Accept the one with the smallest error on pieces left out if everything speaks for it:
//!    gain there and on the pieces seen, four in five pieces improved or unchanged, significance
//!    with the number of candidates counted in, parameters off their bounds, and the same choice
//!    made again without each piece.
//! 4. Name the rivals that the records cannot tell from it. Start again, up to four effects.
//! 5. Where no candidate is accepted and more is left than noise, look for two at once
//!    ([`super::pair`]).
//!
//! Pairs cost many fits. Past a limit of work no more of them are tried, and after one has been accepted nothing
//! else is; that is told.
//!
//! What an earlier effect stood in for may have been found since: after every acceptance each
//! earlier one is dropped if the model predicts as well without it.

use super::acceptance::{choose, objection};
use super::candidate::Candidate;
use super::canonical::canonical;
use super::fit::{Effort, Fit, fit};
use super::grey_box::GreyBox;
use super::pair::pair;
use super::round::Round;
use super::screening::Screened;
use super::settling::settled;
use super::start::{BEGINNING_S, NominalFit};
use super::tests_at_hand::TestsAtHand;
use super::trial::{Evidence, Judged, LEAST_GAIN, Trial, evidence};

/// Most effects that are accepted.
pub const MOST_EFFECTS: usize = 4;
/// Most times that two are accepted at once.
const MOST_PAIRS: usize = MOST_EFFECTS / 2;
/// Work, in passes of a model over all tests, past which no pair is tried. Ten tests of ten seconds at 1 kHz take
/// two cores about half a minute.
pub const MOST_PASSES: f64 = 7000.0;
/// Share of the squared error by which another minimum of the standing model is better.
pub(super) const BETTER_MINIMUM: f64 = 0.01;

/// Is told what is being done, from any thread.
pub type Progress<'a> = &'a (dyn Fn(&str) + Sync);

/// An effect that was found missing.
#[derive(Debug, Clone)]
pub struct Accepted {
    /// Its name.
    pub name: &'static str,
    /// What spoke for it when it was accepted.
    pub evidence: Evidence,
    /// Effects that the records cannot tell from it.
    pub alternatives: Vec<&'static str>,
    /// The effect without which it was not accepted, and whose evidence this is too.
    pub together_with: Option<&'static str>,
}

/// A candidate that was not accepted.
#[derive(Debug, Clone)]
pub struct Rejected {
    /// Its name.
    pub name: &'static str,
    /// Why.
    pub why: String,
    /// Share of squared error on left-out pieces that it would take away, if it was fitted.
    pub holdout_gain: Option<f64>,
}

/// An effect that these records cannot show.
#[derive(Debug, Clone)]
pub struct NotTestable {
    /// Its name.
    pub name: &'static str,
    /// Why.
    pub why: String,
    /// The test that would show it.
    pub test_that_would: &'static str,
}

/// What the search found.
#[derive(Debug, Clone)]
pub struct Found {
    /// The nominal model, refitted.
    pub refitted: Judged,
    /// The model with everything that was accepted.
    pub with_effects: Judged,
    /// The accepted effects, in the order of the model.
    pub accepted: Vec<Accepted>,
    /// The others, by their error on left-out pieces.
    pub rejected: Vec<Rejected>,
    /// Those that cannot show here.
    pub not_testable: Vec<NotTestable>,
    /// Candidates that were screened in the first round.
    pub screened: usize,
    /// The search ended at its limit of work.
    pub cut_short: bool,
}

/// Searches from a fitted nominal model, for pairs up to `most_passes` over all tests. `progress` is told what is
/// being done.
pub fn search(
    nominal: NominalFit,
    tests: &TestsAtHand,
    most_passes: f64,
    progress: Progress<'_>,
) -> Option<Found> {
    let NominalFit { fit, others } = nominal;
    let mut refitted = Judged::new(fit, tests)?;
    let beginnings = tests.beginnings(BEGINNING_S);
    let mut standing = refitted.clone();
    let mut accepted: Vec<Accepted> = Vec::new();
    let mut outdone: Vec<Outdone> = Vec::new();
    let mut pairs = 0;
    let mut cut_short = false;
    let mut at_the_limit = || {
        cut_short |= tests.passes() > most_passes;
        cut_short
    };
    loop {
        let round = if pairs > 0 && at_the_limit() {
            Round::screened(&standing, tests)
        } else {
            Round::of(&standing, &others, &beginnings, tests, progress)
        };
        let Round { tried, screened, hidden, shown, trials, above_noise, .. } = &round;
        if let Some(better) = fairer(&standing, trials, tests) {
            if accepted.is_empty() {
                refitted = better.clone();
            }
            standing = better;
            continue;
        }
        let winner = if accepted.len() < MOST_EFFECTS {
            choose(&standing, trials, tried, tests)
        } else {
            None
        };
        let room = accepted.len() + 2 <= MOST_EFFECTS && pairs < MOST_PAIRS;
        if winner.is_none()
            && room
            && *above_noise
            && let Some(pair) =
                pair(&standing, &round, (&beginnings, tests), &mut at_the_limit, progress)
        {
            let [first, second] = pair.accepted.each_ref().map(|effect| effect.name);
            progress(&format!("settling {first} and {second}"));
            pairs += 1;
            accepted.extend(pair.accepted);
            standing = taken(&pair.fit, &pair.second, &mut accepted, tests, progress)?;
            continue;
        }
        let Some((winner, alternatives)) = winner else {
            let open: Vec<usize> = (0..tried.len())
                .filter(|index| {
                    let fitted = trials.iter().any(|trial| trial.candidate == *index);
                    fitted || !hidden.iter().any(|(i, _)| i == index)
                })
                .collect();
            let rejected = rejections(&standing, trials, tried, (&open, &outdone), screened, tests);
            let unseen = hidden.iter().filter(|(index, _)| !open.contains(index));
            let accepted_count = accepted.len();
            return Some(Found {
                refitted,
                with_effects: standing,
                accepted,
                rejected,
                not_testable: unseen.map(|(_, hidden)| hidden.clone()).collect(),
                screened: tried.len() + accepted_count,
                cut_short,
            });
        };
        let trial = &trials[winner];
        accepted.push(Accepted {
            name: tried[trial.candidate].effect.name,
            evidence: corrected(&trial.evidence, shown.len()),
            alternatives: alternatives
                .iter()
                .map(|i| tried[trials[*i].candidate].effect.name)
                .collect(),
            together_with: None,
        });
        let name = |trial: &Trial| tried[trial.candidate].effect.name;
        outdone.extend(trials.iter().filter(|other| other.candidate != trial.candidate).map(
            |other| Outdone {
                name: name(other),
                gain: other.evidence.holdout_gain,
                by: name(trial),
                gain_of_other: trial.evidence.holdout_gain,
            },
        ));
        progress(&format!("settling {}", tried[trial.candidate].effect.name));
        let (fit, candidate) = (&trial.judged.standing.fit, &tried[trial.candidate]);
        standing = taken(fit, candidate, &mut accepted, tests, progress)?;
    }
}

/// A model whose newest effects are accepted, at its bottom, without what they have made idle.
fn taken(
    fit: &Fit,
    candidate: &Candidate,
    accepted: &mut Vec<Accepted>,
    tests: &TestsAtHand,
    progress: Progress<'_>,
) -> Option<Judged> {
    let settled = settled(fit, candidate, tests)?;
    let standing = Judged::new(canonical(settled, tests), tests)?;
    Some(drop_idle(standing, accepted, tests, progress))
}

/// The standing model from where the best trial has led its parameters, if it is better there: what
/// a richer model gains by a better minimum is not the gain of its effect.
fn fairer(standing: &Judged, trials: &[Trial], tests: &TestsAtHand) -> Option<Judged> {
    let before = &standing.standing.fit;
    let seen = |trial: &&Trial| trial.judged.standing.fit.total_n2();
    let best = trials.iter().min_by(|a, b| seen(a).total_cmp(&seen(b)))?;
    let values = best.judged.standing.fit.values.get(..before.values.len())?;
    let again = fit(&before.model, values, tests, Effort::FULL)?;
    let better = again.total_n2() < (1.0 - BETTER_MINIMUM) * before.total_n2();
    if better { Judged::new(again, tests) } else { None }
}

pub(super) fn corrected(evidence: &Evidence, candidates: usize) -> Evidence {
    Evidence { p_value: (evidence.p_value * candidates as f64).min(1.0), ..*evidence }
}

/// A candidate that was fitted when another one was accepted.
struct Outdone {
    name: &'static str,
    gain: f64,
    by: &'static str,
    gain_of_other: f64,
}

/// Drops earlier effects that the newest one has made idle.
fn drop_idle(
    mut standing: Judged,
    accepted: &mut Vec<Accepted>,
    tests: &TestsAtHand,
    progress: Progress<'_>,
) -> Judged {
    let mut index = 0;
    while accepted.len() > 1 && index + 1 < accepted.len() {
        progress(&format!("without {}", accepted[index].name));
        let fitted = &standing.standing.fit;
        let mut model = GreyBox::nominal(&tests.scale);
        let mut values = fitted.values[..5].to_vec();
        for (k, effect) in fitted.model.effects.iter().enumerate() {
            if k != index {
                model = model.with(effect, &tests.scale);
                values.extend(&fitted.values[fitted.model.range_of(k)]);
            }
        }
        let without =
            fit(&model, &values, tests, Effort::FULL).and_then(|fit| Judged::new(fit, tests));
        let idle = without.as_ref().is_some_and(|without| {
            let gain = evidence(without, &standing, tests).holdout_gain;
            let seen = 1.0 - fitted.total_n2() / without.standing.fit.total_n2();
            gain < LEAST_GAIN || seen < LEAST_GAIN
        });
        if let (true, Some(without)) = (idle, without) {
            standing = without;
            accepted.remove(index);
        } else {
            index += 1;
        }
    }
    standing
}

fn rejections(
    standing: &Judged,
    trials: &[Trial],
    tried: &[Candidate],
    (shown, outdone): (&[usize], &[Outdone]),
    screened: &[Screened],
    tests: &TestsAtHand,
) -> Vec<Rejected> {
    let mut rejected: Vec<Rejected> = trials
        .iter()
        .map(|trial| {
            let why = objection(standing, trial, tried.len(), tests)
                .unwrap_or_else(|| "another choice is made when a test is left out".to_owned());
            let name = tried[trial.candidate].effect.name;
            Rejected { name, why, holdout_gain: Some(trial.evidence.holdout_gain) }
        })
        .collect();
    for index in shown.iter().filter(|i| trials.iter().all(|trial| trial.candidate != **i)) {
        let gains = screened.iter().filter(|s| s.candidate == *index).map(|s| s.gain(None));
        let gain = 100.0 * gains.fold(0.0, f64::max);
        let name = tried[*index].effect.name;
        let why = format!("screened out: to first order it explains {gain:.2} % of what is left");
        rejected.push(match outdone.iter().rfind(|other| other.name == name) {
            Some(Outdone { gain: own, by, gain_of_other, .. }) => Rejected {
                name,
                why: format!(
                    "takes away {:.1} % of the squared error on tests left out where {by} takes away \
                     {:.1} %; beside that, {why}",
                    100.0 * own,
                    100.0 * gain_of_other
                ),
                holdout_gain: Some(*own),
            },
            None => Rejected { name, why, holdout_gain: None },
        });
    }
    rejected
}
