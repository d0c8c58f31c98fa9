//! The search: which effects are missing, one after the other.
//!
//! 1. Screen every candidate against the residual of the standing model ([`super::screening`]).
//! 2. Fit the best few together with all other parameters, free-running ([`super::trial`]).
//! 3. Accept the one with the smallest error on pieces left out if everything speaks for it:
//!    gain there and on the pieces seen, four in five pieces improved or unchanged, significance
//!    with the number of candidates counted in, parameters off their bounds, and the same choice
//!    made again without each piece.
//! 4. Name the rivals that the records cannot tell from it. Start again, up to four effects.
//!
//! What an earlier effect stood in for may have been found since: after every acceptance each
//! earlier one is dropped if the model predicts as well without it.

use super::acceptance::{choose, objection};
use super::candidate::{Candidate, candidates};
use super::canonical::canonical;
use super::fit::{Effort, fit};
use super::grey_box::GreyBox;
use super::left_over::repeat::repeat;
use super::screening::{Screened, screen};
use super::settling::settled;
use super::short_list::{hidden, rehearsals, short_list};
use super::start::{BEGINNING_S, NominalFit};
use super::tests_at_hand::TestsAtHand;
use super::trial::{
    Evidence, Judged, LEAST_GAIN, Trial, evidence, rehearse, starts, try_candidate,
};

/// Most effects that are accepted.
pub const MOST_EFFECTS: usize = 4;
/// Candidates fitted to the whole tests per round.
const TRIED: usize = 5;
/// A model is far off when its error is more than this share of the force.
const FAR_OFF: f64 = 0.03;
/// A residual is far above its noise from this multiple.
const ABOVE_NOISE: f64 = 1.5;
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
}

/// Searches from a fitted nominal model. `progress` is told what is being done.
pub fn search(nominal: NominalFit, tests: &TestsAtHand, progress: Progress<'_>) -> Option<Found> {
    let NominalFit { fit, others } = nominal;
    let mut refitted = Judged::new(fit, tests)?;
    let beginnings = tests.beginnings(BEGINNING_S);
    let mut standing = refitted.clone();
    let mut accepted: Vec<Accepted> = Vec::new();
    let mut outdone: Vec<Outdone> = Vec::new();
    loop {
        progress("screening");
        let tried = candidates(&standing.standing.fit.model, tests);
        let screened = screen(&standing.standing, &tried, tests);
        let hidden = hidden(&tried, &screened);
        // What a model that is far off cannot show may show when it is near.
        let far = far_off(&standing, tests);
        let coarse = far || above_noise(&standing, tests);
        let shown: Vec<usize> = (0..tried.len())
            .filter(|index| far || !hidden.iter().any(|(i, _)| i == index))
            .collect();
        let minima = if far { others.as_slice() } else { &[] };
        let mut rehearsed =
            rehearsals(&standing, &tried, &shown, &screened, coarse, |index, which| {
                progress(&format!("rehearsing {}", tried[index].effect.name));
                let starts = starts(&standing, &tried[index], which, minima);
                rehearse(&standing, &tried[index], &starts, &beginnings)
            });
        rehearsed.sort_by(|a, b| a.1.total_n2().total_cmp(&b.1.total_n2()).then(a.0.cmp(&b.0)));
        let tops = short_list(&screened, &shown, 0);
        let mut place = 0;
        // The best rehearsals, and the two that screening would have taken.
        rehearsed.retain(|(index, _)| {
            place += 1;
            place <= TRIED || tops.iter().take(2).any(|top| top == index)
        });
        let mut trials: Vec<Trial> = Vec::new();
        for (index, fit) in &rehearsed {
            progress(&format!("fitting {}", tried[*index].effect.name));
            trials.extend(try_candidate(&standing, &tried[*index], (*index, &fit.values), tests));
        }
        trials
            .sort_by(|a, b| a.judged.left_out.total_n2().total_cmp(&b.judged.left_out.total_n2()));
        if let Some(better) = fairer(&standing, &trials, tests) {
            if accepted.is_empty() {
                refitted = better.clone();
            }
            standing = better;
            continue;
        }
        let winner = if accepted.len() < MOST_EFFECTS {
            choose(&standing, &trials, &tried, tests)
        } else {
            None
        };
        let Some((winner, alternatives)) = winner else {
            let open: Vec<usize> = (0..tried.len())
                .filter(|index| {
                    let fitted = trials.iter().any(|trial| trial.candidate == *index);
                    fitted || !hidden.iter().any(|(i, _)| i == index)
                })
                .collect();
            let rejected =
                rejections(&standing, &trials, &tried, (&open, &outdone), &screened, tests);
            let unseen = hidden.into_iter().filter(|(index, _)| !open.contains(index));
            let accepted_count = accepted.len();
            return Some(Found {
                refitted,
                with_effects: standing,
                accepted,
                rejected,
                not_testable: unseen.map(|(_, hidden)| hidden).collect(),
                screened: tried.len() + accepted_count,
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
        let settled = settled(&trial.judged.standing.fit, &tried[trial.candidate], tests)?;
        standing = Judged::new(canonical(settled, tests), tests)?;
        standing = drop_idle(standing, &mut accepted, tests, progress);
    }
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

fn corrected(evidence: &Evidence, candidates: usize) -> Evidence {
    Evidence { p_value: (evidence.p_value * candidates as f64).min(1.0), ..*evidence }
}

/// A candidate that was fitted when another one was accepted.
struct Outdone {
    name: &'static str,
    gain: f64,
    by: &'static str,
    gain_of_other: f64,
}

/// True when the standing model is so far off that first-order screening says little.
fn far_off(standing: &Judged, tests: &TestsAtHand) -> bool {
    standing.standing.fit.rms_n(tests) > FAR_OFF * tests.rms_force_n()
}

/// True when the residual is so far above its noise that a part of it must be due to large effects:
/// what they do to first order, with all other parameters as they are, says little.
fn above_noise(standing: &Judged, tests: &TestsAtHand) -> bool {
    let floor_n = repeat(&standing.standing.residual_n, tests).noise_floor_n;
    floor_n.is_some_and(|floor_n| standing.standing.fit.rms_n(tests) > ABOVE_NOISE * floor_n)
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
