//! The evidence for one effect: a richer model against a poorer one, on pieces that neither has
//! seen.

use super::band::gain_in_band;
use super::chance::one_sided;
use super::few_strokes;
use super::gram::Gram;
use super::judged::Judged;
use super::test_set::TestSet;
use nalgebra::DVector;
use rayon::prelude::*;
use std::ops::Range;

/// Smallest relevant share of squared error that an effect removes, seen and left out.
pub(crate) const LEAST_GAIN: f64 = 0.03;
/// A piece may be worse by this share and still counts as unchanged.
const UNCHANGED: f64 = 0.01;

/// A piece excites an effect that changes its force by more than this share of its residual.
const EXCITED: f64 = 0.05;

/// Share of the squared error on left-out pieces from which a change removes most of it.
const MOST: f64 = 0.5;
/// Blocks that carry a change are few below this number.
const FEW_BLOCKS: f64 = 12.0;
/// Most parts that a block is cut into.
const MOST_PARTS: usize = 8;

/// The evidence for one effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// Share of the squared error on left-out pieces that the effect removes.
    pub holdout_gain: f64,
    /// The same in the band of the motion.
    pub gain_in_band: f64,
    /// Share of the pieces that excite it that it improves or leaves unchanged.
    pub improved: f64,
    /// Probability of such a gain without the effect, for one candidate.
    pub p_value: f64,
}

impl Evidence {
    /// With the probability multiplied by the number of candidates that were looked at.
    #[must_use]
    pub fn among(&self, candidates: usize) -> Self {
        Self { p_value: (self.p_value * candidates as f64).min(1.0), ..*self }
    }
}

/// Compares a richer model with a poorer one on pieces that neither has seen.
pub(crate) fn evidence(poorer: &Judged, richer: &Judged, tests: &TestSet) -> Evidence {
    let (before, after) = (&poorer.left_out, &richer.left_out);
    Evidence {
        holdout_gain: 1.0 - after.total_n2() / before.total_n2(),
        gain_in_band: gain_in_band(poorer, richer, tests),
        improved: improved_of_excited(poorer, richer, tests),
        p_value: p_value(poorer, richer, tests),
    }
}

/// Share of the pieces in which the richer model differs that it improves or leaves unchanged: a
/// piece that does not excite an effect has no say in it.
fn improved_of_excited(poorer: &Judged, richer: &Judged, tests: &TestSet) -> f64 {
    let (before, after) = (&poorer.left_out, &richer.left_out);
    let (mut before_n2, mut after_n2) = (Vec::new(), Vec::new());
    for piece in 0..tests.pieces.len() {
        let pairs = before.force_n[piece].iter().zip(&after.force_n[piece]);
        let change_n2: f64 = pairs.map(|(a, b)| (a - b) * (a - b)).sum();
        if change_n2 > EXCITED * EXCITED * before.squares_n2[piece] {
            before_n2.push(before.squares_n2[piece]);
            after_n2.push(after.squares_n2[piece]);
        }
    }
    if before_n2.is_empty() { 1.0 } else { improved(&before_n2, &after_n2) }
}

/// Share of pieces whose squared error falls or does not change.
pub(crate) fn improved(before_n2: &[f64], after_n2: &[f64]) -> f64 {
    debug_assert_eq!(before_n2.len(), after_n2.len(), "the same pieces before and after");
    let pairs = before_n2.iter().zip(after_n2);
    let improved = pairs.filter(|(b, a)| **a <= **b * (1.0 + UNCHANGED)).count();
    improved as f64 / before_n2.len() as f64
}

/// Probability that the change made by the richer model correlates with the residual by chance.
///
/// The change d of a left-out piece comes from fits that have not seen it; the part that the poorer
/// model's own parameters can produce is projected out of it. So without the effect the sum of d r
/// in every block has mean zero, whatever the colour of the noise within blocks. Both are whitened
/// first; the sum over blocks is compared with its own scatter.
fn p_value(poorer: &Judged, richer: &Judged, tests: &TestSet) -> f64 {
    let own = &poorer.linearised.slopes;
    let whitened: Vec<(Vec<Vec<f64>>, Vec<f64>)> = tests
        .pieces
        .par_iter()
        .enumerate()
        .map(|(index, piece)| {
            let colour = &richer.linearised.colours[piece.test];
            let range = piece.samples.clone();
            let before = &poorer.left_out.force_n[index];
            let after = &richer.left_out.force_n[index];
            let change: Vec<f64> = after.iter().zip(before).map(|(a, b)| a - b).collect();
            let mut columns: Vec<Vec<f64>> = own
                .iter()
                .map(|slope| colour.whitened(&slope[piece.test][range.clone()]))
                .collect();
            columns.push(colour.whitened(&change));
            let residual = &poorer.linearised.residual_n[piece.test][range];
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
    let grain = |parts| scores(&whitened, &explained, parts, tests);
    let mut scores = grain(1);
    // Where few blocks carry the change and it removes most of the error, whole cycles are too few
    // to be counted; whitened stretches of a cycle are nearly independent, too.
    let most = richer.left_out.total_n2() < (1.0 - MOST) * poorer.left_out.total_n2();
    let mut parts = 2;
    while most && scores.carried_by() < FEW_BLOCKS && parts <= MOST_PARTS {
        scores = grain(parts);
        parts *= 2;
    }
    if most && scores.carried_by() < FEW_BLOCKS {
        let parameters = richer.fit().values.len().saturating_sub(own.len());
        let whole = whitened.iter().flat_map(|(columns, residual)| {
            residual.iter().enumerate().map(|(i, r)| (unexplained(columns, &explained, i), *r))
        });
        let (change, residual): (Vec<f64>, Vec<f64>) = whole.unzip();
        if let Some(p) = few_strokes::p_value(&change, &residual, parameters) {
            return p;
        }
    }
    (2.0 * one_sided(&scores.plain).min(one_sided(&scores.even))).min(1.0)
}

/// Products of a change with the residual, block by block.
struct Scores {
    /// The sum of each block.
    plain: Vec<f64>,
    /// The same divided by the norm of its change. The plain ones are more powerful where all
    /// blocks are alike, these where a few are much larger than the rest.
    even: Vec<f64>,
    /// Squared norm of the change in each block.
    squares: Vec<f64>,
}

impl Scores {
    /// The number of equal blocks that would carry as much of the change.
    fn carried_by(&self) -> f64 {
        let sum: f64 = self.squares.iter().sum();
        let squares: f64 = self.squares.iter().map(|square| square * square).sum();
        if squares > 0.0 { sum * sum / squares } else { f64::INFINITY }
    }
}

/// The scores of the last column, less the part that the others explain, over blocks that are cut
/// into so many parts.
fn scores(
    whitened: &[(Vec<Vec<f64>>, Vec<f64>)],
    explained: &DVector<f64>,
    parts: usize,
    tests: &TestSet,
) -> Scores {
    let mut scores = Scores { plain: Vec::new(), even: Vec::new(), squares: Vec::new() };
    for (piece, (columns, residual)) in tests.pieces.iter().zip(whitened) {
        let cut = |block: Range<usize>| {
            let length = block.len().div_ceil(parts).max(1);
            let end = block.end;
            block.step_by(length).map(move |from| from..(from + length).min(end))
        };
        for block in tests.blocks(piece).flat_map(cut) {
            let (mut score, mut square) = (0.0, 0.0);
            let inside = block.start - piece.samples.start..block.end - piece.samples.start;
            for (i, residual) in inside.clone().zip(&residual[inside]) {
                let change = unexplained(columns, explained, i);
                score += change * residual;
                square += change * change;
            }
            scores.plain.push(score);
            scores.even.push(if square > 0.0 { score / square.sqrt() } else { 0.0 });
            scores.squares.push(square);
        }
    }
    scores
}

/// The change at a sample less the part that the poorer model's own columns explain.
fn unexplained(columns: &[Vec<f64>], explained: &DVector<f64>, sample: usize) -> f64 {
    let own: f64 = columns.iter().zip(explained.iter()).map(|(c, a)| a * c[sample]).sum();
    columns[own_count(columns)][sample] - own
}

/// The change is the last column, after those of the poorer model.
fn own_count(columns: &[Vec<f64>]) -> usize {
    columns.len() - 1
}
