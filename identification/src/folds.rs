//! Predictions of a fitted model for pieces that it has not seen.
//!
//! For every piece the model is refitted without it, starting from the fit to all pieces: damped
//! Gauss-Newton steps on the others with the sensitivities of that fit and new simulations,
//!
//! ```text
//! u <- u + (sum_(k != i) J_k' J_k + l diag)^-1 sum_(k != i) J_k' r_k(u)
//! ```
//!
//! each kept only if the squared error of the others falls. A hundredth of the left-out piece's own
//! J' J is added as a restraint: a direction that only this piece determines stays where it is. The
//! left-out piece is then simulated, in free run, with the parameters found without it.

use super::fit::Fit;
use super::gram::Gram;
use super::linearised::Linearised;
use super::simulation::simulate;
use super::test_set::{Piece, TestSet};
use nalgebra::DVector;
use rayon::prelude::*;

/// Most steps of the refit of a fold.
const STEPS: usize = 5;
/// Weight of the left-out piece as a restraint.
const RESTRAINT: f64 = 0.01;
/// Longest step in a free coordinate.
const LONGEST_STEP: f64 = 1.0;
/// A fold is done when a step gains less than this share.
const DONE: f64 = 1e-4;

/// Predictions of pieces by a model that has not seen them.
#[derive(Debug, Clone)]
pub struct LeftOut {
    /// Force over the samples of each piece, N.
    pub force_n: Vec<Vec<f64>>,
    /// Sum of squared errors of each piece, N2.
    pub squares_n2: Vec<f64>,
    /// Sum of squared errors of the others, for each piece, after the refit to them, N2.
    pub seen_squares_n2: Vec<f64>,
}

impl LeftOut {
    /// Leaves out every piece in turn.
    pub fn predict(standing: &Linearised, tests: &TestSet) -> Option<Self> {
        let grams = grams(standing, tests);
        let folds: Option<Vec<(Vec<f64>, f64, f64)>> = (0..tests.pieces.len())
            .into_par_iter()
            .map(|out| fold(standing, &grams, out, tests))
            .collect();
        let folds = folds?;
        debug_assert!(
            folds
                .iter()
                .zip(&tests.pieces)
                .all(|(fold, piece)| fold.0.len() == piece.samples.len()),
            "every prediction covers its piece"
        );
        let mut result =
            Self { force_n: Vec::new(), squares_n2: Vec::new(), seen_squares_n2: Vec::new() };
        for (force_n, squares, seen) in folds {
            result.force_n.push(force_n);
            result.squares_n2.push(squares);
            result.seen_squares_n2.push(seen);
        }
        Some(result)
    }

    /// Predicts one piece from the others and from its own rest, in runs that are left out in turn;
    /// none where it cannot be cut.
    pub(crate) fn predict_within(
        standing: &Linearised,
        piece: usize,
        tests: &TestSet,
    ) -> Option<Vec<f64>> {
        let (cut, runs) = tests.with_runs_of(piece)?;
        let grams = grams(standing, &cut);
        let whole = &tests.pieces[piece];
        let mut force_n = standing.fit.force_n[whole.test][whole.samples.clone()].to_vec();
        let folds: Option<Vec<(Vec<f64>, f64, f64)>> =
            runs.clone().into_par_iter().map(|out| fold(standing, &grams, out, &cut)).collect();
        for (run, (run_n, _, _)) in cut.pieces[runs].iter().zip(folds?) {
            let from = run.samples.start - whole.samples.start;
            force_n[from..from + run_n.len()].copy_from_slice(&run_n);
        }
        Some(force_n)
    }

    /// Replaces the prediction of a piece.
    pub(crate) fn replace(&mut self, piece: usize, force_n: Vec<f64>, tests: &TestSet) {
        let Piece { test, samples } = &tests.pieces[piece];
        let measured = &tests.tests[*test].record.force_n[samples.clone()];
        let pairs = measured.iter().zip(&force_n);
        self.squares_n2[piece] = pairs.map(|(y, f)| (y - f) * (y - f)).sum();
        self.force_n[piece] = force_n;
    }

    /// Sum over all pieces, N2.
    pub fn total_n2(&self) -> f64 {
        self.squares_n2.iter().sum()
    }

    /// Squared errors block by block, N2, in order of pieces and time.
    pub fn block_squares(&self, tests: &TestSet) -> Vec<f64> {
        let mut sums = Vec::new();
        for (piece, force_n) in tests.pieces.iter().zip(&self.force_n) {
            let test = &tests.tests[piece.test];
            for block in tests.blocks(piece) {
                let model = block.start - piece.samples.start..block.end - piece.samples.start;
                let pairs = test.record.force_n[block].iter().zip(&force_n[model]);
                sums.push(pairs.map(|(y, f)| (y - f) * (y - f)).sum());
            }
        }
        sums
    }
}

/// Normal equations of a fitted model, one for each piece.
pub(crate) fn grams(standing: &Linearised, tests: &TestSet) -> Vec<Gram> {
    let each = tests.pieces.par_iter().map(|piece| {
        let residual = residual(&standing.fit.force_n, piece, tests);
        Gram::over(&columns(standing, piece), &residual)
    });
    each.collect()
}

/// Force on the left-out piece, its squared error, and that of the others. `grams` are those of the
/// fit, one a piece.
fn fold(
    standing: &Linearised,
    grams: &[Gram],
    out: usize,
    tests: &TestSet,
) -> Option<(Vec<f64>, f64, f64)> {
    let fit = &standing.fit;
    let seen: Vec<&Piece> =
        tests.pieces.iter().enumerate().filter(|(k, _)| *k != out).map(|(_, p)| p).collect();
    let mut force_n = fit.force_n.clone();
    let mut squares: f64 = seen.iter().map(|piece| squares_on(&force_n, piece, tests)).sum();
    let mut free = DVector::from_vec(fit.model.free(&fit.values));
    let others = grams.iter().enumerate().filter(|(k, _)| *k != out).map(|(_, gram)| gram);
    let mut gram_now = Gram::sum(others)?;
    gram_now.columns += &grams[out].columns * RESTRAINT;
    let mut damping = 1e-6;
    for _ in 0..STEPS {
        let step = gram_now.step_within(damping, DONE * squares, LONGEST_STEP);
        let tried = &free + &step;
        let Some(damper) = fit.model.damper(&fit.model.values(tried.as_slice())) else {
            damping *= 100.0;
            continue;
        };
        let forecast = gram_now.fall(&step);
        if forecast < DONE * squares {
            // So small a step needs no simulation of the others.
            (free, squares) = (tried, squares - forecast.max(0.0));
            break;
        }
        let mut tried_n = force_n.clone();
        for (index, test) in tests.tests.iter().enumerate() {
            if seen.iter().any(|piece| piece.test == index) {
                tried_n[index] = simulate(&damper, test, fit.starts_m[index]);
            }
        }
        let tried_squares: f64 = seen.iter().map(|piece| squares_on(&tried_n, piece, tests)).sum();
        if tried_squares >= squares {
            damping *= 100.0;
            continue;
        }
        let gained = 1.0 - tried_squares / squares;
        (free, force_n, squares) = (tried, tried_n, tried_squares);
        if gained < DONE {
            break;
        }
        for (index, piece) in seen.iter().enumerate() {
            // The columns are kept: only the residual is new.
            let toward = Gram::toward(&columns(standing, piece), &residual(&force_n, piece, tests));
            gram_now.residual = if index == 0 { toward } else { gram_now.residual + toward };
        }
    }
    let piece = &tests.pieces[out];
    let damper = fit.model.damper(&fit.model.values(free.as_slice()))?;
    let whole = simulate(&damper, &tests.tests[piece.test], fit.starts_m[piece.test]);
    force_n[piece.test] = whole;
    let error = squares_on(&force_n, piece, tests);
    Some((force_n[piece.test][piece.samples.clone()].to_vec(), error, squares))
}

fn squares_on(force_n: &[Vec<f64>], piece: &Piece, tests: &TestSet) -> f64 {
    tests.tests[piece.test].squares_n2(&force_n[piece.test], piece.samples.clone())
}

/// Sensitivities of the fit over a piece.
fn columns<'a>(standing: &'a Linearised, piece: &Piece) -> Vec<&'a [f64]> {
    let by_parameter = standing.slopes.iter();
    by_parameter.map(|slope| &slope[piece.test][piece.samples.clone()]).collect()
}

/// Measured less given force over a piece.
fn residual(force_n: &[Vec<f64>], piece: &Piece, tests: &TestSet) -> Vec<f64> {
    let range = piece.samples.clone();
    let measured = &tests.tests[piece.test].record.force_n[range.clone()];
    measured.iter().zip(&force_n[piece.test][range]).map(|(y, f)| y - f).collect()
}

/// Share of each piece in the change that a richer model makes.
pub(crate) fn change_shares(from: &Fit, to: &Fit, tests: &TestSet) -> Vec<f64> {
    let changes: Vec<f64> = tests
        .pieces
        .iter()
        .map(|piece| {
            let range = piece.samples.clone();
            let pairs =
                from.force_n[piece.test][range.clone()].iter().zip(&to.force_n[piece.test][range]);
            pairs.map(|(a, b)| (a - b) * (a - b)).sum()
        })
        .collect();
    let sum: f64 = changes.iter().sum();
    changes.iter().map(|change| if sum > 0.0 { change / sum } else { 0.0 }).collect()
}
