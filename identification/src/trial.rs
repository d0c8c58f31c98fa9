//! A candidate on trial: fitted together with the standing model, and judged on pieces that neither
//! has seen.

use super::candidate::Candidate;
use super::chance::one_sided;
use super::fit::{Effort, Fit, fit, fit_freely};
use super::folds::{LeftOut, change_shares};
use super::gram::Gram;
use super::grey_box::CLEARANCE;
use super::screening::Standing;
use super::tests_at_hand::TestsAtHand;
use rayon::prelude::*;

/// A standing model with what it says of pieces left out.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The model.
    pub standing: Standing,
    /// Its predictions of pieces left out.
    pub left_out: LeftOut,
}

impl Judged {
    /// Judges a fitted model.
    pub fn new(fit: Fit, tests: &TestsAtHand) -> Option<Self> {
        let standing = Standing::new(fit, tests);
        let left_out = LeftOut::of(&standing, tests)?;
        Some(Self { standing, left_out })
    }
}

/// The evidence for one effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// Share of the squared error on left-out pieces that the effect takes away.
    pub holdout_gain: f64,
    /// Share of pieces that it improves or leaves as they are.
    pub improved: f64,
    /// Probability of such a gain without the effect, for one candidate.
    pub p_value: f64,
}

/// A candidate fitted and judged.
#[derive(Debug, Clone)]
pub struct Trial {
    /// Index of the candidate.
    pub candidate: usize,
    /// The model with it.
    pub judged: Judged,
    /// What speaks for it.
    pub evidence: Evidence,
}

/// Smallest relevant share of squared error that an effect takes away, seen and left out.
pub const LEAST_GAIN: f64 = 0.03;
/// A piece may be worse by this share and still counts as unchanged.
const UNCHANGED: f64 = 0.01;
/// A piece that holds more than this share of all that a candidate changes cannot judge it, unless
/// the others would have found the candidate too.
const LONE_SHARE: f64 = 0.98;

/// Share of the clearance with which a candidate also starts.
const PART_OF_CLEARANCE: f64 = 0.4;

/// Start parameters of a candidate, a group for each of its own start values: with the standing
/// model's parameters, with those lifted off zero, with less clearance (which may have grown in the
/// place of the candidate), and with other minima of the nominal damper.
pub fn starts(
    base: &Judged,
    candidate: &Candidate,
    which: &[usize],
    others: &[Vec<f64>],
) -> Vec<Vec<Vec<f64>>> {
    let standing = &base.standing.fit.values;
    let lifted = base.standing.fit.model.lifted(standing);
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
/// that is nearest to begin with. (Between groups nearness says nothing: an effect that starts where
/// it does nothing is as near as the model without it.)
pub fn rehearse(
    base: &Judged,
    candidate: &Candidate,
    groups: &[Vec<Vec<f64>>],
    beginnings: &TestsAtHand,
) -> Option<Fit> {
    let model = base.standing.fit.model.with(candidate.effect, &beginnings.scale);
    let fits: Vec<Fit> = groups
        .par_iter()
        .filter_map(|group| {
            let tried = group.iter().filter_map(|start| Fit::of(&model, start, beginnings));
            let nearest = tried.min_by(|a, b| a.total_n2().total_cmp(&b.total_n2()))?;
            fit_freely(nearest, beginnings, Effort::SHORT)
        })
        .collect();
    fits.into_iter().min_by(|a, b| a.total_n2().total_cmp(&b.total_n2()))
}

/// Fits a candidate from the given parameters and judges it against the model without it.
pub fn try_candidate(
    base: &Judged,
    candidate: &Candidate,
    (index, start): (usize, &[f64]),
    tests: &TestsAtHand,
) -> Option<Trial> {
    let standing = &base.standing;
    let model = standing.fit.model.with(candidate.effect, &tests.scale);
    let mut best = fit(&model, start, tests, Effort::TRIAL)?;
    if best.total_n2() > standing.fit.total_n2() {
        // A richer model cannot be worse: what the beginnings showed has led astray.
        let usual = [standing.fit.values.as_slice(), candidate.starts.first()?].concat();
        let again = fit(&model, &usual, tests, Effort::TRIAL)?;
        if again.total_n2() < best.total_n2() {
            best = again;
        }
    }
    let mut judged = Judged::new(best, tests)?;
    let shares = change_shares(&standing.fit, &judged.standing.fit, tests);
    for (piece, share) in shares.iter().enumerate() {
        if *share > LONE_SHARE && !found_without(piece, base, &judged) {
            judged.left_out.force_n[piece].clone_from(&base.left_out.force_n[piece]);
            judged.left_out.squares_n2[piece] = base.left_out.squares_n2[piece];
        }
    }
    let evidence = evidence(base, &judged, tests);
    Some(Trial { candidate: index, judged, evidence })
}

/// True when a candidate takes away enough of the squared error of all other pieces.
fn found_without(piece: usize, poorer: &Judged, richer: &Judged) -> bool {
    let others = |judged: &Judged| judged.left_out.total_n2() - judged.left_out.squares_n2[piece];
    others(richer) < (1.0 - LEAST_GAIN) * others(poorer)
}

/// Compares a richer model with a poorer one on pieces that neither has seen.
pub fn evidence(poorer: &Judged, richer: &Judged, tests: &TestsAtHand) -> Evidence {
    let (before, after) = (&poorer.left_out, &richer.left_out);
    Evidence {
        holdout_gain: 1.0 - after.total_n2() / before.total_n2(),
        improved: improved(&before.squares_n2, &after.squares_n2),
        p_value: p_value(poorer, richer, tests),
    }
}

/// Share of pieces whose squared error falls or stays.
pub(super) fn improved(before_n2: &[f64], after_n2: &[f64]) -> f64 {
    let pairs = before_n2.iter().zip(after_n2);
    let improved = pairs.filter(|(b, a)| **a <= **b * (1.0 + UNCHANGED)).count();
    improved as f64 / before_n2.len() as f64
}

/// Probability that the change which the richer model makes goes along with the residual by chance.
///
/// The change d of a left-out piece comes from fits that have not seen it; what the poorer model's
/// own parameters could do is projected out of it. So without the effect every block's sum of d r
/// has mean zero, whatever the colour of the noise within blocks. Both are whitened first; the sum
/// over blocks is compared with its own scatter.
fn p_value(poorer: &Judged, richer: &Judged, tests: &TestsAtHand) -> f64 {
    let own = &poorer.standing.slopes;
    let whitened: Vec<(Vec<Vec<f64>>, Vec<f64>)> = tests
        .pieces
        .par_iter()
        .enumerate()
        .map(|(index, piece)| {
            let colour = &richer.standing.colours[piece.test];
            let range = piece.samples.clone();
            let before = &poorer.left_out.force_n[index];
            let after = &richer.left_out.force_n[index];
            let change: Vec<f64> = after.iter().zip(before).map(|(a, b)| a - b).collect();
            let mut columns: Vec<Vec<f64>> = own
                .iter()
                .map(|slope| colour.whitened(&slope[piece.test][range.clone()]))
                .collect();
            columns.push(colour.whitened(&change));
            let residual = &poorer.standing.residual_n[piece.test][range];
            (columns, colour.whitened(residual))
        })
        .collect();
    let grams: Vec<Gram> = whitened
        .iter()
        .map(|(columns, _)| {
            let views: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
            let (own, change) = views.split_at(own_count(columns));
            Gram::over(own, change[0])
        })
        .collect();
    let Some(whole) = Gram::sum(grams.iter()) else { return 1.0 };
    let explained = whole.solve();
    // Each block's sum, plainly and over the length of its change: the first is sharper where all
    // blocks are alike, the second where a few are much larger than the rest.
    let (mut plain, mut even) = (Vec::new(), Vec::new());
    for (piece, (columns, residual)) in tests.pieces.iter().zip(&whitened) {
        for block in tests.blocks(piece) {
            let (mut score, mut square) = (0.0, 0.0);
            for i in block.start - piece.samples.start..block.end - piece.samples.start {
                let own: f64 = columns.iter().zip(explained.iter()).map(|(c, a)| a * c[i]).sum();
                let change = columns[own_count(columns)][i] - own;
                score += change * residual[i];
                square += change * change;
            }
            plain.push(score);
            even.push(if square > 0.0 { score / square.sqrt() } else { 0.0 });
        }
    }
    (2.0 * one_sided(&plain).min(one_sided(&even))).min(1.0)
}

/// The change stands behind the columns of the poorer model.
fn own_count(columns: &[Vec<f64>]) -> usize {
    columns.len() - 1
}
