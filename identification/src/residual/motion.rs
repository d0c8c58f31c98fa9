//! Does the residual follow the motion?
//!
//! A linear regression on signals of the displacement ([`super::features`]), without physics and
//! without a noise floor, is fitted once to the residual of the model and once to the force itself,
//! and predicts pieces that were left out of it. If either predicts the left-out force better than
//! the model does,
//!
//! ```text
//! share = 1 - sum (F - F_regression)^2 / sum (F - F_model - mean)^2        on left-out pieces
//! ```
//!
//! then more of the force follows from the motion than the model knows. A constant does not: the
//! mean of the residual is taken off. A piece with speeds or strokes that no other piece has is
//! cut into runs that are left out instead, since nothing predicts a motion that it has not seen.
//!
//! Limits: ripple over position is finer than these signals, and an input that was not recorded
//! (temperature, a current) is not among them.

use super::features::{COUNT, Sizes, features};
use super::question::Answer;
use crate::fit::Fit;
use crate::test_set::{Piece, TestSet};
use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;
use signal::statistics::percentile;
use std::ops::Range;

/// Samples of all tests that the regression uses at most.
const MOST_SAMPLES: usize = 60_000;
/// Share of the variance of a signal that is added to keep the weights small.
const RIDGE: f64 = 1e-3;
/// Signals are clipped at so many standard deviations when they predict.
const CLIP: f64 = 4.0;
/// A piece may exceed the others by this factor and still be predicted as a whole.
const BEYOND: f64 = 1.1;
/// Runs that a piece beyond the others, or a lone test, is cut into.
const RUNS: usize = 6;
/// Samples between a run and what the regression has seen, as a share of the piece.
const GUARD: f64 = 0.02;
/// Share from which the residual follows the motion.
const LEAST_SHARE: f64 = 0.1;
/// Share of the pieces that must be predicted better.
const LEAST_IMPROVED: f64 = 0.8;
/// Fewest pieces that decide.
const FEWEST_PIECES: usize = 3;

/// How much more of the force follows from the motion than the model knows.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// The answer.
    pub answer: Answer,
    /// Share of the squared residual that the regression removes on left-out pieces.
    pub share: f64,
    /// Share of the pieces that it predicts better.
    pub improved: f64,
    /// Pieces that were left out in turn.
    pub pieces: usize,
    /// rms of what it removes, N.
    pub rms_n: f64,
}

impl Motion {
    fn not_tested(why: &str) -> Self {
        let answer = Answer::NotTested(why.to_owned());
        Self { answer, share: 0.0, improved: 0.0, pieces: 0, rms_n: 0.0 }
    }
}

/// Asks whether the residual of a model follows the motion.
pub(crate) fn motion(fit: &Fit, tests: &TestSet) -> Motion {
    let stride = tests.counted_samples().div_ceil(MOST_SAMPLES).max(1);
    let sizes = Sizes::of(tests);
    let rows: Vec<Vec<[f64; COUNT]>> =
        tests.tests.par_iter().map(|test| features(test, &sizes, stride)).collect();
    let runs = runs(tests);
    if runs.len() < FEWEST_PIECES {
        return Motion::not_tested("the records are too short to leave parts out");
    }
    let samples = |run: &Range<usize>| run.start.div_ceil(stride)..run.end.div_ceil(stride);
    let scaling = Scaling::of(runs.iter().flat_map(|run| &rows[run.test][samples(&run.samples)]));
    let data: Vec<Run> = runs
        .par_iter()
        .map(|run| Run::new(run, &rows[run.test], &scaling, fit, tests, stride))
        .collect();
    if data.iter().any(|run| run.rows.len() < 2 * RUNS) {
        return Motion::not_tested("the records have too few samples");
    }
    let scores: Vec<Option<[f64; 3]>> = (0..data.len())
        .into_par_iter()
        .map(|out| {
            let seen: Vec<&Run> =
                data.iter().enumerate().filter(|(k, _)| *k != out).map(|(_, run)| run).collect();
            score(&data[out], &seen)
        })
        .collect();
    let Some(scores) = scores.into_iter().collect::<Option<Vec<_>>>() else {
        return Motion::not_tested("the motion is too uniform for a regression");
    };
    let counted = data.iter().map(|run| run.rows.len()).sum::<usize>() as f64;
    // The better of the two regressions counts: on the residual, or on the force.
    (1..3)
        .map(|by| {
            let sum = |k: usize| scores.iter().map(|score| score[k]).sum::<f64>();
            let better = scores.iter().filter(|score| score[by] < score[0]).count();
            let (before, after) = (sum(0), sum(by));
            let share = if before > 0.0 { 1.0 - after / before } else { 0.0 };
            let improved = better as f64 / scores.len() as f64;
            let follows = share > LEAST_SHARE && improved >= LEAST_IMPROVED;
            Motion {
                answer: if follows { Answer::Yes } else { Answer::No },
                share,
                improved,
                pieces: scores.len(),
                rms_n: ((before - after).max(0.0) / counted).sqrt(),
            }
        })
        .max_by(|a, b| {
            (a.answer == Answer::Yes, a.share)
                .partial_cmp(&(b.answer == Answer::Yes, b.share))
                .unwrap_or(std::cmp::Ordering::Equal)
        })
        .unwrap_or_else(|| Motion::not_tested("there is nothing to compare"))
}

/// The pieces, those beyond the others cut into runs.
fn runs(tests: &TestSet) -> Vec<Piece> {
    let size = |piece: &Piece| {
        let record = &tests.tests[piece.test].record;
        [&record.drive_m, &record.velocity_m_per_s].map(|values| {
            let inside = &values[piece.samples.clone()];
            let mean = signal::statistics::mean(inside);
            let sizes: Vec<f64> = inside.iter().map(|value| (value - mean).abs()).collect();
            percentile(&sizes, 0.95).unwrap_or(0.0)
        })
    };
    let sizes: Vec<[f64; 2]> = tests.pieces.iter().map(size).collect();
    let most_but = |piece: usize, k: usize| {
        let others = sizes.iter().enumerate().filter(|(other, _)| *other != piece);
        others.fold(0.0_f64, |most, (_, size)| most.max(size[k]))
    };
    let pieces = tests.pieces.iter().enumerate();
    pieces
        .flat_map(|(index, piece)| {
            let beyond = (0..2).any(|k| sizes[index][k] > BEYOND * most_but(index, k));
            if beyond { cut(piece) } else { vec![piece.clone()] }
        })
        .collect()
}

fn cut(piece: &Piece) -> Vec<Piece> {
    let Range { start, end } = piece.samples;
    let length = (end - start) / RUNS;
    let guard = (GUARD * (end - start) as f64) as usize;
    let each = (0..RUNS).map(|k| {
        let from = start + k * length;
        Piece { test: piece.test, samples: from..(from + length).saturating_sub(guard).max(from) }
    });
    each.filter(|run| !run.samples.is_empty()).collect()
}

/// Mean and inverse standard deviation of every signal.
struct Scaling {
    mean: [f64; COUNT],
    inverse: [f64; COUNT],
}

impl Scaling {
    fn of<'a>(rows: impl Iterator<Item = &'a [f64; COUNT]>) -> Self {
        let (mut sum, mut square, mut count) = ([0.0; COUNT], [0.0; COUNT], 0.0);
        for row in rows {
            for (k, value) in row.iter().enumerate() {
                sum[k] += value;
                square[k] += value * value;
            }
            count += 1.0;
        }
        let mean = sum.map(|sum| sum / f64::max(count, 1.0));
        let inverse = std::array::from_fn(|k| {
            let variance = square[k] / f64::max(count, 1.0) - mean[k] * mean[k];
            if variance > 1e-20 { variance.sqrt().recip() } else { 0.0 }
        });
        Self { mean, inverse }
    }

    fn scaled(&self, row: &[f64; COUNT]) -> SVector<f64, COUNT> {
        SVector::from_fn(|k, _| ((row[k] - self.mean[k]) * self.inverse[k]).clamp(-CLIP, CLIP))
    }
}

/// A run that is left out as a whole, with its normal equations.
struct Run {
    rows: Vec<SVector<f64, COUNT>>,
    /// Residual and force of every row, N.
    targets: Vec<[f64; 2]>,
    /// Sum of the rows, and of both targets.
    sum: SVector<f64, COUNT>,
    target_sum: [f64; 2],
    gram: SMatrix<f64, COUNT, COUNT>,
    right: [SVector<f64, COUNT>; 2],
}

impl Run {
    fn new(
        run: &Piece,
        rows: &[[f64; COUNT]],
        scaling: &Scaling,
        fit: &Fit,
        tests: &TestSet,
        stride: usize,
    ) -> Self {
        let record = &tests.tests[run.test].record;
        let (mut kept, mut targets) = (Vec::new(), Vec::new());
        let mut gram = Box::new(SMatrix::<f64, COUNT, COUNT>::zeros());
        let mut right = [SVector::<f64, COUNT>::zeros(); 2];
        let (mut sum, mut target_sum) = (SVector::zeros(), [0.0; 2]);
        let kept_rows = run.samples.start.div_ceil(stride)..run.samples.end.div_ceil(stride);
        for (k, row) in rows.iter().enumerate().take(kept_rows.end).skip(kept_rows.start) {
            let sample = k * stride;
            let force_n = record.force_n[sample];
            let target = [force_n - fit.force_n[run.test][sample], force_n];
            let row = scaling.scaled(row);
            gram.ger(1.0, &row, &row, 1.0);
            for which in 0..2 {
                right[which].axpy(target[which], &row, 1.0);
                target_sum[which] += target[which];
            }
            sum += row;
            kept.push(row);
            targets.push(target);
        }
        Self { rows: kept, targets, sum, target_sum, gram: *gram, right }
    }
}

/// Squared error on a run that is left out: of the model less the mean of its residual, of the
/// regression on the residual, and of the regression on the force.
fn score(out: &Run, seen: &[&Run]) -> Option<[f64; 3]> {
    let count = seen.iter().map(|run| run.rows.len()).sum::<usize>() as f64;
    let sum = seen.iter().fold(SVector::<f64, COUNT>::zeros(), |sum, run| sum + run.sum) / count;
    let mut gram = Box::new(SMatrix::<f64, COUNT, COUNT>::zeros());
    for run in seen {
        *gram += &run.gram;
    }
    *gram -= sum * sum.transpose() * count;
    for k in 0..COUNT {
        gram[(k, k)] += RIDGE * count;
    }
    let factor = gram.cholesky()?;
    let solved = [0, 1].map(|which| {
        let mean = seen.iter().map(|run| run.target_sum[which]).sum::<f64>() / count;
        let right =
            seen.iter().fold(SVector::<f64, COUNT>::zeros(), |right, run| right + run.right[which]);
        (mean, factor.solve(&(right - sum * (mean * count))))
    });
    let mut squares = [0.0; 3];
    for (row, target) in out.rows.iter().zip(&out.targets) {
        squares[0] += (target[0] - solved[0].0).powi(2);
        for which in 0..2 {
            let (mean, weights) = &solved[which];
            let error = target[which] - mean - (row - sum).dot(weights);
            squares[1 + which] += error * error;
        }
    }
    Some(squares)
}
