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

use super::candidate::{Candidate, candidates};
use super::canonical::canonical;
use super::fit::{Effort, Fit, fit, fit_on};
use super::grey_box::GreyBox;
use super::left_over::repeat::repeat;
use super::screening::{Screened, screen};
use super::start::{BEGINNING_S, NominalFit};
use super::tests_at_hand::TestsAtHand;
use super::trial::{
    Evidence, Judged, LEAST_GAIN, Trial, evidence, rehearse, starts, try_candidate,
};
use rayon::prelude::*;

/// Most effects that are accepted.
pub const MOST_EFFECTS: usize = 4;
/// Pieces that must be improved or unchanged.
const LEAST_IMPROVED: f64 = 0.8;
/// Pieces without which the same choice must be made.
const LEAST_AGREEMENT: f64 = 0.8;
/// Largest probability of a chance finding among all candidates.
const LARGEST_P: f64 = 0.01;
/// Standard errors by which a rival's error on left-out blocks must be larger to be told apart.
const MARGIN: f64 = 2.5;
/// A candidate that screens below this share is not fitted.
const LEAST_SCREENED: f64 = 0.005;
/// Candidates rehearsed per round, by plain and by whitened gain.
const LISTED: (usize, usize) = (6, 3);
/// Candidates fitted to the whole tests per round.
const TRIED: usize = 5;
/// A model is far off when its error is more than this share of the force.
const FAR_OFF: f64 = 0.03;
/// A residual is far above its noise from this multiple.
const ABOVE_NOISE: f64 = 1.5;
/// Ratio from which a nominal parameter is of another size.
const OTHER_SIZE: f64 = 3.0;
/// Share of the squared error by which another minimum of the standing model is better.
const BETTER_MINIMUM: f64 = 0.01;
/// Start values of a candidate that are fitted.
const STARTS: usize = 4;
/// Nominal parameters absorb an effect of which they leave less than this share.
const LEAST_UNABSORBED: f64 = 0.01;
/// An effect that stands out by fewer standard errors at its usual size does not show.
const LEAST_STANDING_OUT: f64 = 1.0;

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
            let rejected = rejections(&standing, &trials, &tried, &open, &screened, tests);
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

/// An accepted model at the bottom: trials stop near it, and may lie in another hollow of the same
/// effect than the deepest, which its other start values reach.
fn settled(trial: &Fit, candidate: &Candidate, tests: &TestsAtHand) -> Option<Fit> {
    let nominal = trial.values.len() - candidate.effect.parameters.len();
    let others: Vec<Fit> = candidate
        .starts
        .par_iter()
        .filter_map(|start| {
            let from = [&trial.values[..nominal], start].concat();
            fit(&trial.model, &from, tests, Effort::TRIAL)
        })
        .collect();
    let better = others.into_iter().min_by(|a, b| a.total_n2().total_cmp(&b.total_n2()));
    let deeper = better.filter(|other| other.total_n2() < trial.total_n2());
    fit_on(deeper.unwrap_or_else(|| trial.clone()), tests, Effort::FULL)
}

fn corrected(evidence: &Evidence, candidates: usize) -> Evidence {
    Evidence { p_value: (evidence.p_value * candidates as f64).min(1.0), ..*evidence }
}

/// Candidates that the records cannot show, with the reason.
fn hidden(tried: &[Candidate], screened: &[Screened]) -> Vec<(usize, NotTestable)> {
    let mut hidden = Vec::new();
    for (index, candidate) in tried.iter().enumerate() {
        let starts = || screened.iter().filter(|screened| screened.candidate == index);
        let unabsorbed = starts().map(Screened::unabsorbed).fold(0.0, f64::max);
        let standing_out = starts().map(Screened::standing_out).fold(0.0, f64::max);
        let gain = starts().map(|start| start.gain(None)).fold(0.0, f64::max);
        let why = if starts().next().is_none() {
            "no damper of this size has it".to_owned()
        } else if standing_out == 0.0 {
            "nothing in these records calls on it".to_owned()
        } else if unabsorbed < LEAST_UNABSORBED {
            format!(
                "the other parameters do the same: {:.2} % of it is left after their refit",
                100.0 * unabsorbed
            )
        } else if standing_out < LEAST_STANDING_OUT && gain < LEAST_GAIN {
            format!("at its usual size it stands out by {standing_out:.2} standard errors")
        } else {
            continue;
        };
        let name = candidate.effect.name;
        let test_that_would = candidate.effect.shown_by;
        hidden.push((index, NotTestable { name, why, test_that_would }));
    }
    hidden
}

/// True when the standing model is so far off that first-order screening says little.
fn far_off(standing: &Judged, tests: &TestsAtHand) -> bool {
    let squares = standing.standing.fit.total_n2() / tests.counted_samples() as f64;
    squares.sqrt() > FAR_OFF * tests.rms_force_n()
}

/// True when the residual is so far above its noise that a part of it must be due to large effects:
/// what they do to first order, with all other parameters as they are, says little.
fn above_noise(standing: &Judged, tests: &TestsAtHand) -> bool {
    let squares = standing.standing.fit.total_n2() / tests.counted_samples() as f64;
    let floor_n = repeat(&standing.standing.residual_n, tests).noise_floor_n;
    floor_n.is_some_and(|floor_n| squares.sqrt() > ABOVE_NOISE * floor_n)
}

/// Fits to the beginnings of the tests: of all candidates where first order says little, otherwise of
/// those that screening puts on top, chosen again without every piece.
fn rehearsals(
    standing: &Judged,
    tried: &[Candidate],
    shown: &[usize],
    screened: &[Screened],
    coarse: bool,
    rehearse: impl Fn(usize, &[usize]) -> Option<Fit> + Sync,
) -> Vec<(usize, Fit)> {
    let listed = if coarse {
        shown.to_vec()
    } else {
        short_list(screened, shown, standing.left_out.squares_n2.len())
    };
    listed
        .par_iter()
        .filter_map(|index| {
            let which: Vec<usize> = if coarse {
                (0..tried[*index].starts.len()).collect()
            } else {
                let mut starts: Vec<&Screened> =
                    screened.iter().filter(|s| s.candidate == *index).collect();
                starts.sort_by(|a, b| b.gain(None).total_cmp(&a.gain(None)));
                starts.iter().take(STARTS).map(|s| s.start).collect()
            };
            rehearse(*index, &which).map(|fit| (*index, fit))
        })
        .collect()
}

/// The candidates on top of the screening, also when a piece is left out.
fn short_list(screened: &[Screened], shown: &[usize], pieces: usize) -> Vec<usize> {
    let ranked = |gain: &dyn Fn(&Screened) -> f64| {
        let mut best: Vec<(f64, usize)> = shown
            .iter()
            .filter_map(|index| {
                let starts = screened.iter().filter(|s| s.candidate == *index);
                starts.map(gain).max_by(f64::total_cmp).map(|gain| (gain, *index))
            })
            .filter(|(gain, _)| *gain > LEAST_SCREENED)
            .collect();
        best.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        best
    };
    let mut listed: Vec<usize> = Vec::new();
    let mut list = |ranked: Vec<(f64, usize)>, count: usize| {
        for (_, index) in ranked.into_iter().take(count) {
            if !listed.contains(&index) {
                listed.push(index);
            }
        }
    };
    list(ranked(&|s| s.gain(None)), LISTED.0);
    list(ranked(&|s| s.whitened_gain(None)), LISTED.1);
    for piece in 0..pieces {
        list(ranked(&|s| s.gain(Some(piece))), 1);
    }
    listed
}

/// The trial to accept, with the trials that cannot be told from it.
fn choose(
    standing: &Judged,
    trials: &[Trial],
    tried: &[Candidate],
    tests: &TestsAtHand,
) -> Option<(usize, Vec<usize>)> {
    let fit_for_it: Vec<usize> = (0..trials.len())
        .filter(|index| objection(standing, &trials[*index], tried.len(), tests).is_none())
        .collect();
    let best = *fit_for_it.first()?;
    let alike: Vec<usize> = fit_for_it
        .iter()
        .copied()
        .filter(|index| !told_apart(&trials[best], &trials[*index], tests))
        .collect();
    // Among equals one that leaves the damper the size it has, then the one with fewest parameters.
    let parameters = |index: &usize| tried[trials[*index].candidate].effect.parameters.len();
    let rank = |index: &usize| (remakes(standing, &trials[*index]), parameters(index), *index);
    let winner = alike.iter().copied().min_by_key(rank)?;
    let agreeing = (0..tests.pieces.len())
        .filter(|piece| {
            let seen = |index: &usize| trials[*index].judged.left_out.seen_squares_n2[*piece];
            let first = (0..trials.len()).min_by(|a, b| seen(a).total_cmp(&seen(b)));
            let ours = alike.iter().map(seen).fold(f64::INFINITY, f64::min);
            first.is_some_and(|first| ours <= (1.0 + LEAST_GAIN) * seen(&first))
        })
        .count();
    if (agreeing as f64) < LEAST_AGREEMENT * tests.pieces.len() as f64 {
        return None;
    }
    Some((winner, alike.into_iter().filter(|index| *index != winner).collect()))
}

/// True when a trial needs another damper altogether: damping, stiffness or relief force of another
/// size. A valve stage on a hundredfold Ce does the same as dry friction.
fn remakes(standing: &Judged, trial: &Trial) -> bool {
    let before = &standing.standing.fit.values;
    let after = &trial.judged.standing.fit.values;
    [0, 1, 3].iter().any(|index| {
        let ratio = after[*index] / before[*index];
        !(1.0 / OTHER_SIZE..=OTHER_SIZE).contains(&ratio)
    })
}

/// Why a trial cannot be accepted, if anything speaks against it.
fn objection(
    standing: &Judged,
    trial: &Trial,
    candidates: usize,
    tests: &TestsAtHand,
) -> Option<String> {
    let Evidence { holdout_gain, improved, p_value } = trial.evidence;
    let before = standing.standing.fit.total_n2();
    let seen_gain = 1.0 - trial.judged.standing.fit.total_n2() / before;
    let p = (p_value * candidates as f64).min(1.0);
    let gains = [(seen_gain, "the tests it is fitted to"), (holdout_gain, "tests left out")];
    let unfit = gains.into_iter().find_map(|(gain, of)| too_little(gain, of));
    if let Some(why) = unfit.or_else(|| too_seldom(improved)) {
        return Some(why);
    }
    if p > LARGEST_P {
        return Some(format!("may be chance: p = {p:.3} with all candidates counted"));
    }
    at_a_bound(trial, tests).map(|name| format!("{name} runs to its bound"))
}

/// Why a gain is none, if it is none.
pub(super) fn too_little(gain: f64, of: &str) -> Option<String> {
    (gain < LEAST_GAIN).then(|| {
        let gain = 100.0 * gain;
        format!("takes away {gain:.2} % of the squared error on {of}, less than 3 %")
    })
}

/// Why a gain in too few pieces is none.
pub(super) fn too_seldom(improved: f64) -> Option<String> {
    (improved < LEAST_IMPROVED).then(|| {
        let share = 100.0 * improved;
        format!("improves or leaves unchanged only {share:.0} % of the tests")
    })
}

/// The first parameter of the newest effect that ends on a bound that only the impossible lies
/// beyond, and whose value matters there.
fn at_a_bound(trial: &Trial, tests: &TestsAtHand) -> Option<&'static str> {
    let fit = &trial.judged.standing.fit;
    let effect = fit.model.effects.len() - 1;
    let range = fit.model.range_of(effect);
    let rows = fit.model.effects[effect].parameters;
    let free = fit.model.free(&fit.values);
    let error_n = (fit.total_n2() / tests.counted_samples() as f64).sqrt();
    rows.iter().zip(range).find_map(|(row, index)| {
        let (lower, upper) = row.bounds(&tests.scale);
        let span = upper - lower;
        let value = fit.values[index];
        let beyond = value > upper - 1e-3 * span || (lower < 0.0 && value < lower + 1e-3 * span);
        let slope = fit.model.coordinates()[index].slope(free[index]).max(1e-12 * span);
        let columns = &trial.judged.standing.slopes[index];
        let squares: f64 = columns.iter().flatten().map(|s| s * s).sum();
        let moved_n = (squares / tests.counted_samples() as f64).sqrt() * 0.01 * span / slope;
        (beyond && moved_n > 0.1 * error_n).then_some(row.name)
    })
}

/// True when the second trial is worse on left-out blocks by more than its scatter.
fn told_apart(best: &Trial, rival: &Trial, tests: &TestsAtHand) -> bool {
    if best.candidate == rival.candidate {
        return false;
    }
    let ours = best.judged.left_out.block_squares(tests);
    let theirs = rival.judged.left_out.block_squares(tests);
    let differences: Vec<f64> = ours.iter().zip(&theirs).map(|(a, b)| b - a).collect();
    let sum: f64 = differences.iter().sum();
    let scatter = differences.iter().map(|d| d * d).sum::<f64>().sqrt();
    let relevant = sum > LEAST_GAIN * best.judged.left_out.total_n2();
    relevant && sum > MARGIN * scatter
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
    shown: &[usize],
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
        let why = format!("screened out: to first order it explains {gain:.2} % of what is left");
        rejected.push(Rejected { name: tried[*index].effect.name, why, holdout_gain: None });
    }
    rejected
}
