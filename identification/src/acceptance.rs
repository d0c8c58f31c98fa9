//! The tests that a candidate has to pass before it is accepted, and the choice among those that
//! do.
//!
//! A candidate must gain on left-out pieces, there also in the band of the motion, and on the
//! pieces it is fitted to; improve or leave unchanged four pieces in five; be significant with all
//! candidates counted; keep its parameters off their bounds; and be chosen again without each
//! piece. Among candidates that predict equally well one is named. The others are its alternatives,
//! including those that only a parameter on its bound speaks against.

use super::candidate::Candidate;
use super::coordinate::physical_limit;
use super::evidence::{Evidence, LEAST_GAIN};
use super::grey_box::{CE, KE, RELIEF};
use super::judged::Judged;
use super::test_set::TestSet;
use super::trial::Trial;

/// Share of pieces that must be improved or unchanged.
const LEAST_IMPROVED: f64 = 0.8;
/// Share of pieces without which the same choice must be made.
const LEAST_AGREEMENT: f64 = 0.8;
/// Largest probability of a chance finding among all candidates.
const LARGEST_P: f64 = 0.01;
/// Standard errors by which the error of an alternative on left-out blocks must be larger.
const MARGIN: f64 = 2.5;
/// A small difference of the squared error also separates, where it is far beyond its scatter.
const LEAST_DIFFERENCE: f64 = 0.01;
const MARGIN_OF_SMALL: f64 = 4.0;
/// Ratio from which a nominal parameter counts as another size.
const OTHER_SIZE: f64 = 3.0;

/// The trial to accept, with the trials that cannot be distinguished from it.
pub(crate) fn choose(
    standing: &Judged,
    trials: &[Trial],
    tried: &[Candidate],
    tests: &TestSet,
) -> Option<(usize, Vec<usize>)> {
    debug_assert!(trials.iter().all(|trial| trial.candidate < tried.len()));
    let fit_for_it: Vec<usize> = (0..trials.len())
        .filter(|index| objection(standing, &trials[*index], tried.len(), tests).is_none())
        .collect();
    let best = *fit_for_it.first()?;
    let alike: Vec<usize> = fit_for_it
        .iter()
        .copied()
        .filter(|index| !distinguishable(&trials[best].judged, &trials[*index].judged, tests))
        .collect();
    // Among equals: one that leaves the damper its size, then the one with the fewest parameters.
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
    // An effect with a parameter on a bound is not named, but it is an alternative: it predicts as
    // well.
    let rivals = (0..trials.len()).filter(|index| {
        *index != winner
            && no_gain(standing, &trials[*index], tried.len()).is_none()
            && !distinguishable(&trials[best].judged, &trials[*index].judged, tests)
    });
    Some((winner, rivals.collect()))
}

/// True when a trial needs another damper altogether: damping, stiffness or relief force of another
/// size. A valve stage on a hundredfold Ce does the same as dry friction.
pub(super) fn remakes(standing: &Judged, trial: &Trial) -> bool {
    let before = &standing.fit().values;
    let after = &trial.judged.fit().values;
    [CE, KE, RELIEF].into_iter().any(|place| {
        let ratio = after[place] / before[place];
        !(1.0 / OTHER_SIZE..=OTHER_SIZE).contains(&ratio)
    })
}

/// The reason why a trial cannot be accepted, if there is one.
pub(crate) fn objection(
    standing: &Judged,
    trial: &Trial,
    candidates: usize,
    tests: &TestSet,
) -> Option<String> {
    no_gain(standing, trial, candidates).or_else(|| {
        at_a_bound(standing, trial, tests).map(|name| format!("{name} runs to its bound"))
    })
}

/// The reason why a trial does not predict better than the standing model, if there is one.
fn no_gain(standing: &Judged, trial: &Trial, candidates: usize) -> Option<String> {
    let Evidence { holdout_gain, gain_in_band, improved, p_value } = trial.evidence;
    let before = standing.fit().total_n2();
    let seen_gain = 1.0 - trial.judged.fit().total_n2() / before;
    let p = (p_value * candidates as f64).min(1.0);
    let gains = [(seen_gain, "the tests it is fitted to"), (holdout_gain, "tests left out")];
    let unfit = gains.into_iter().find_map(|(gain, of)| too_little(gain, of));
    let above_the_motion = || (gain_in_band < LEAST_GAIN).then(|| above_the_motion(gain_in_band));
    if let Some(why) = unfit.or_else(|| too_seldom(improved)).or_else(above_the_motion) {
        return Some(why);
    }
    (p > LARGEST_P).then(|| format!("may be chance: p = {p:.3} with all candidates counted"))
}

/// The reason why a gain is too small, if it is.
pub(super) fn too_little(gain: f64, of: &str) -> Option<String> {
    (gain < LEAST_GAIN).then(|| {
        let gain = 100.0 * gain;
        format!("removes {gain:.2} % of the squared error on {of}, less than 3 %")
    })
}

/// The reason against an effect that acts above the frequencies of the motion alone.
fn above_the_motion(gain_in_band: f64) -> String {
    format!(
        "removes {:.2} % of the squared error at the frequencies of the motion, less than 3 %: it \
         filters noise of the drive",
        100.0 * gain_in_band
    )
}

/// The reason why too few pieces are improved, if there are too few.
pub(super) fn too_seldom(improved: f64) -> Option<String> {
    (improved < LEAST_IMPROVED).then(|| {
        let share = 100.0 * improved;
        format!("improves or leaves unchanged only {share:.0} % of the tests")
    })
}

/// The first parameter of a new effect that ends on a physical limit and whose value matters there.
fn at_a_bound(standing: &Judged, trial: &Trial, tests: &TestSet) -> Option<&'static str> {
    let fit = trial.judged.fit();
    let known = standing.fit().model.effects.len();
    let of_effect =
        |effect: usize| fit.model.effects[effect].parameters.iter().zip(fit.model.range_of(effect));
    let free = fit.model.free(&fit.values);
    let error_n = fit.rms_n(tests);
    (known..fit.model.effects.len()).flat_map(of_effect).find_map(|(row, index)| {
        let (lower, upper) = row.bounds(&tests.scale);
        let span = upper - lower;
        let value = fit.values[index];
        let at_limit = physical_limit(value, (lower, upper)).is_some();
        let slope = fit.model.coordinates()[index].slope(free[index]).max(1e-12 * span);
        let columns = &trial.judged.linearised.slopes[index];
        let squares: f64 = columns.iter().flatten().map(|s| s * s).sum();
        let moved_n = (squares / tests.counted_samples() as f64).sqrt() * 0.01 * span / slope;
        (at_limit && moved_n > 0.1 * error_n).then_some(row.name)
    })
}

/// True when the second model is worse on left-out blocks by more than its scatter.
pub(super) fn distinguishable(best: &Judged, rival: &Judged, tests: &TestSet) -> bool {
    let ours = best.left_out.block_squares(tests);
    let theirs = rival.left_out.block_squares(tests);
    let differences: Vec<f64> = ours.iter().zip(&theirs).map(|(a, b)| b - a).collect();
    let sum: f64 = differences.iter().sum();
    let scatter = differences.iter().map(|d| d * d).sum::<f64>().sqrt();
    let total = best.left_out.total_n2();
    let clear = sum > LEAST_GAIN * total && sum > MARGIN * scatter;
    clear || (sum > LEAST_DIFFERENCE * total && sum > MARGIN_OF_SMALL * scatter)
}
