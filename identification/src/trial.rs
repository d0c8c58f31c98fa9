//! A candidate on trial: fitted together with the standing model, and judged on pieces that neither
//! has seen.

use super::batches;
use super::candidate::Candidate;
use super::control::Control;
use super::evidence::{Evidence, LEAST_GAIN, evidence};
use super::fit::{Effort, Fit, fit, fit_freely};
use super::folds::{LeftOut, change_shares};
use super::grey_box::CLEARANCE;
use super::judged::Judged;
use super::test_set::TestSet;
use rayon::prelude::*;

/// A candidate fitted and judged.
#[derive(Debug, Clone)]
pub(crate) struct Trial {
    /// Index of the candidate.
    pub candidate: usize,
    /// The model with it.
    pub judged: Judged,
    /// The evidence for it.
    pub evidence: Evidence,
}

/// A piece with more than this share of the change that a candidate makes is judged by runs left
/// out within it, unless the others would have found the candidate too.
const LONE_SHARE: f64 = 0.98;

/// Shares of the usual value of parameters from zero; with the last one an effect hardly acts.
const WEAKER: [f64; 3] = [1.0, 0.2, 0.02];
/// Share of the clearance with which a candidate also starts.
const PART_OF_CLEARANCE: f64 = 0.4;

/// Start parameters of a candidate, a group for each of its own start values: with the standing
/// model's parameters, with those lifted off zero, with less clearance (which may have grown in the
/// place of the candidate), and with other minima of the nominal damper.
pub(crate) fn starts(
    base: &Judged,
    candidate: &Candidate,
    which: &[usize],
    others: &[Vec<f64>],
) -> Vec<Vec<Vec<f64>>> {
    let standing = &base.fit().values;
    let lifted = base.fit().model.lifted(standing);
    let group = |start: &Vec<f64>| {
        let mut group = vec![[standing.as_slice(), start].concat()];
        if lifted != *standing {
            group.push([lifted.as_slice(), start].concat());
        }
        let mut tighter = lifted.clone();
        if let Some(clearance) = tighter.get_mut(CLEARANCE) {
            *clearance *= PART_OF_CLEARANCE;
            group.push([tighter.as_slice(), start].concat());
        }
        for other in others {
            // The nominal parameters of the other minimum, the effects of the standing model.
            group.push([other.as_slice(), &standing[other.len()..], start].concat());
        }
        group
    };
    which.iter().filter_map(|index| candidate.starts.get(*index)).map(group).collect()
}

/// The best fit of a candidate to the beginnings of the tests: one from each group, from the member
/// with the smallest error before the fit. (Between groups that error says nothing: an effect that
/// starts without influence has the same error as the model without it.)
pub(crate) fn rehearse(
    base: &Judged,
    candidate: &Candidate,
    groups: &[Vec<Vec<f64>>],
    beginnings: &TestSet,
    control: Control<'_>,
) -> Option<Fit> {
    let model = base.fit().model.with(candidate.effect, &beginnings.scale);
    let starts_m = &base.fit().starts_m;
    let fits: Vec<Fit> = groups
        .par_iter()
        .filter(|_| !control.is_stopped())
        .filter_map(|group| {
            let at = |start: &Vec<f64>| Fit::starting_at(&model, start, starts_m, beginnings);
            let tried = group.iter().filter_map(at);
            let nearest = tried.min_by(|a, b| a.total_n2().total_cmp(&b.total_n2()))?;
            fit_freely(nearest, beginnings, Effort::SHORT, control)
        })
        .collect();
    fits.into_iter().min_by(|a, b| a.total_n2().total_cmp(&b.total_n2()))
}

/// Fits a candidate from the given parameters and judges it against the model without it.
pub(crate) fn try_candidate(
    base: &Judged,
    candidate: &Candidate,
    (index, start): (usize, &[f64]),
    tests: &TestSet,
    control: Control<'_>,
) -> Option<Trial> {
    let standing = base.fit();
    let model = standing.model.with(candidate.effect, &tests.scale);
    let mut best = fit(&model, start, tests, Effort::TRIAL, control)?;
    if best.total_n2() > standing.total_n2() {
        // A richer model cannot be worse: the start found on the beginnings was misleading.
        let usual = candidate.starts.first()?;
        for share in WEAKER {
            let rows = candidate.effect.parameters.iter().zip(usual);
            let weaker: Vec<f64> = rows
                .map(|(row, value)| {
                    let from_zero = row.bounds(&tests.scale).0 == 0.0;
                    if from_zero { share * value } else { *value }
                })
                .collect();
            let start = [standing.values.as_slice(), &weaker].concat();
            let again = fit(&model, &start, tests, Effort::TRIAL, control)?;
            if again.total_n2() < best.total_n2() {
                best = again;
            }
        }
    }
    let mut judged = Judged::new(best, tests)?;
    let shares = change_shares(standing, judged.fit(), tests);
    for (piece, share) in shares.iter().enumerate() {
        if *share > LONE_SHARE && !found_without(piece, base, &judged) {
            judge_within(piece, base, &mut judged, tests);
        }
    }
    let mut evidence = evidence(base, &judged, tests);
    if batches::is_constant(candidate.effect.name) {
        let by_batches = batches::constant(&base.linearised.residual_n, tests).p_value;
        evidence.p_value = (2.0 * evidence.p_value.min(by_batches)).min(1.0);
    }
    Some(Trial { candidate: index, judged, evidence })
}

/// Judges a piece that alone excites a candidate by runs left out within it: they predict it from
/// the rest of the same test. A piece that cannot be cut judges nothing.
fn judge_within(piece: usize, base: &Judged, judged: &mut Judged, tests: &TestSet) {
    let within = LeftOut::predict_within(&judged.linearised, piece, tests);
    let force_n = within.unwrap_or_else(|| base.left_out.force_n[piece].clone());
    judged.left_out.replace(piece, force_n, tests);
}

/// True when a candidate removes enough of the squared error of all other pieces.
fn found_without(piece: usize, poorer: &Judged, richer: &Judged) -> bool {
    let others = |judged: &Judged| judged.left_out.total_n2() - judged.left_out.squares_n2[piece];
    others(richer) < (1.0 - LEAST_GAIN) * others(poorer)
}
