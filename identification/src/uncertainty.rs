//! Standard deviations of the parameters.
//!
//! Errors of neighbouring samples are correlated, so the squares of residuals alone underestimate
//! the deviations. Blocks of record are taken as independent instead:
//!
//! ```text
//! C = N^-1 (sum_b g_b g_b') N^-1 B / (B - p)        N = J' J,  g_b = J_b' r_b
//! ```
//!
//! which holds for noise of any colour within blocks and of any strength between them. It is
//! widened by Student's factor for few blocks, so that 1.96 standard deviations hold 95 %.
//!
//! A systematic error of the bench in every cycle of a test (its filter rounds each kink) is no
//! noise of blocks; it biases each test in its own way. So the same is computed with whole tests as
//! blocks, and each parameter gets the larger of its two deviations.

use super::fit::{Fit, slopes};
use super::gram::Gram;
use super::linearised::Linearised;
use super::test_set::TestSet;
use nalgebra::DMatrix;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::borrow::Cow;

/// Change of force with one free coordinate, by test and sample.
type Slope = Vec<Vec<f64>>;

/// A coordinate that is uncertain by more than this is not fixed by the records, unless the
/// deviation of the parameter is smaller than the parameter.
const NOT_FIXED: f64 = 3.0;
/// Fewest degrees of freedom in the computation: below, Student's factor grows without limit.
const FEWEST_FREE: f64 = 3.0;

/// Standard deviations of all parameters in their units; none where the records do not fix one.
pub(crate) fn uncertainty(standing: &Linearised, tests: &TestSet) -> Vec<Option<f64>> {
    let count = standing.slopes.len();
    let (free, slopes) = alive(standing, tests);
    let (mut blocks, mut pieces): (Vec<Gram>, Vec<Gram>) = (Vec::new(), Vec::new());
    for piece in &tests.pieces {
        let first = blocks.len();
        for block in tests.blocks(piece) {
            let columns: Vec<&[f64]> =
                slopes.iter().map(|slope| &slope[piece.test][block.clone()]).collect();
            blocks.push(Gram::over(&columns, &standing.residual_n[piece.test][block]));
        }
        pieces.extend(Gram::sum(blocks[first..].iter()));
    }
    let Some(whole) = Gram::sum(pieces.iter()) else { return vec![None; count] };
    if blocks.len() <= count + 1 {
        return vec![None; count];
    }
    let inverse = inverse(&whole.columns);
    let by_block = variances(&blocks, blocks.len() - count, &inverse);
    // The pieces of few tests share the same motion, so their scores are not independent.
    let by_piece = if tests.whole_tests {
        variances(&pieces, pieces.len() - 1, &inverse)
    } else {
        vec![0.0; count]
    };
    let coordinates = standing.fit.model.coordinates().iter().zip(&free);
    by_block
        .iter()
        .zip(&by_piece)
        .map(|(block, piece)| block.max(*piece).sqrt())
        .zip(coordinates)
        .map(|(spread, (coordinate, u))| {
            let deviation = spread * coordinate.slope(*u);
            // Far above its bend a parameter from zero may be uncertain by many bends and still
            // known.
            let fixed = spread < NOT_FIXED || deviation < coordinate.value(*u).abs();
            (fixed && spread > 0.0).then_some(deviation)
        })
        .collect()
}

/// Free coordinates and sensitivities. A parameter on its bound has no sensitivity there, but
/// others may be uncertain because of it: it is evaluated a little inside.
fn alive<'a>(standing: &'a Linearised, tests: &TestSet) -> (Vec<f64>, Cow<'a, [Slope]>) {
    let Fit { model, values, .. } = &standing.fit;
    let free = model.free(values);
    let pairs = model.coordinates().iter().zip(&free);
    let inside: Vec<f64> = pairs.map(|(coordinate, u)| coordinate.inside(*u)).collect();
    let moved =
        if inside == free { None } else { Fit::evaluate(model, &model.values(&inside), tests) };
    match moved {
        Some(fit) => {
            let slopes = slopes(model, &inside, &fit.force_n, &fit.starts_m, tests);
            (inside, Cow::Owned(slopes))
        }
        None => (free, Cow::Borrowed(&standing.slopes)),
    }
}

/// Variances of the free coordinates from independent scores, of which `freedom` are free: B - p
/// blocks, or all tests but one.
///
/// Where few blocks fix a parameter the scatter of their scores is itself uncertain. With `w_b =
/// (N^-1 J_b' J_b N^-1)_ii` its freedom is `(sum w_b)^2 / sum w_b^2` (Satterthwaite), and Student's
/// factor follows.
fn variances(scores: &[Gram], freedom: usize, inverse: &DMatrix<f64>) -> Vec<f64> {
    let count = inverse.nrows();
    let mut middle = DMatrix::zeros(count, count);
    let (mut weights, mut squares) = (vec![0.0; count], vec![0.0; count]);
    for score in scores {
        middle += &score.residual * score.residual.transpose();
        let share = inverse * &score.columns * inverse;
        for i in 0..count {
            weights[i] += share[(i, i)];
            squares[i] += share[(i, i)] * share[(i, i)];
        }
    }
    let covariance = inverse * middle * inverse * (scores.len() as f64 / freedom as f64);
    (0..count)
        .map(|i| {
            let own = if squares[i] > 0.0 { weights[i] * weights[i] / squares[i] } else { 1.0 };
            let freedom = own.min(freedom as f64).max(FEWEST_FREE);
            let student = StudentsT::new(0.0, 1.0, freedom).map_or(1.96, |t| t.inverse_cdf(0.975));
            covariance[(i, i)].max(0.0) * (student / 1.96) * (student / 1.96)
        })
        .collect()
}

/// Inverse of normal equations; directions that no record determines get a very large one.
fn inverse(columns: &DMatrix<f64>) -> DMatrix<f64> {
    let count = columns.nrows();
    let scale: Vec<f64> = (0..count).map(|i| columns[(i, i)].sqrt().max(1e-150)).collect();
    let scaled = DMatrix::from_fn(count, count, |i, j| columns[(i, j)] / (scale[i] * scale[j]));
    let eigen = scaled.symmetric_eigen();
    let largest = eigen.eigenvalues.max().max(1e-300);
    let inverted = eigen.eigenvalues.map(|value| 1.0 / value.max(1e-13 * largest));
    let inverse =
        &eigen.eigenvectors * DMatrix::from_diagonal(&inverted) * eigen.eigenvectors.transpose();
    DMatrix::from_fn(count, count, |i, j| inverse[(i, j)] / (scale[i] * scale[j]))
}
