//! The mean of a residual over a coordinate, judged on left-out pieces.
//!
//! The coordinate is cut into bins of equal content, each with two branches. The map m of the other
//! pieces predicts a left-out one; it removes there
//!
//! ```text
//! E = sum_k (2 s_k m_k - n_k m_k^2)        s_k sum, n_k number of residuals in bin k
//! ```
//!
//! of the squared error, whose mean is below zero where the residual does not depend on the
//! coordinate.

use super::coordinates::{Coordinate, Track};
use crate::chance::one_sided;
use crate::test_set::TestSet;

/// Bins of a coordinate.
const BINS: usize = 20;

/// A residual over a coordinate.
#[derive(Debug, Clone)]
pub struct CoordinateMap {
    /// The coordinate.
    pub coordinate: Coordinate,
    /// Mean of the coordinate in each bin.
    pub centres: Vec<f64>,
    /// Mean residual of the upper branch in each bin, N, where there is one.
    pub upper_n: Vec<Option<f64>>,
    /// Mean residual of the lower branch in each bin, N, where there is one.
    pub lower_n: Vec<Option<f64>>,
    /// Share of the squared residual that the map explains on pieces left out; below zero: none.
    pub share: f64,
    /// rms of the part that it explains there, N.
    pub rms_n: f64,
    /// Probability of that much by chance.
    pub p_value: f64,
}

/// The map of a residual over a coordinate, if the coordinate was measured and varies.
pub(crate) fn map(
    coordinate: Coordinate,
    tracks: &[Track],
    residual_n: &[Vec<f64>],
    tests: &TestSet,
) -> Option<CoordinateMap> {
    debug_assert_eq!((tracks.len(), residual_n.len()), (tests.tests.len(), tests.tests.len()));
    let edges = edges(coordinate, tracks, tests)?;
    let bin_of = |value: f64| edges.partition_point(|edge| *edge <= value);
    let cells = 2 * (edges.len() + 1);
    // Sum and number of residuals by piece, block and cell.
    let mut blocks: Vec<(usize, Vec<(f64, f64)>)> = Vec::new();
    let mut centres = vec![(0.0, 0.0); edges.len() + 1];
    let mut squares = 0.0;
    for (index, piece) in tests.pieces.iter().enumerate() {
        let track = &tracks[piece.test];
        let values = track.values(coordinate);
        if values.is_empty() {
            continue;
        }
        for block in tests.blocks(piece) {
            let mut sums = vec![(0.0, 0.0); cells];
            for i in block {
                let (bin, residual) = (bin_of(values[i]), residual_n[piece.test][i]);
                let cell = &mut sums[2 * bin + usize::from(track.upper(coordinate, i))];
                *cell = (cell.0 + residual, cell.1 + 1.0);
                centres[bin] = (centres[bin].0 + values[i], centres[bin].1 + 1.0);
                squares += residual * residual;
            }
            blocks.push((index, sums));
        }
    }
    let mut whole = vec![(0.0, 0.0); cells];
    let mut by_piece = vec![vec![(0.0, 0.0); cells]; tests.pieces.len()];
    for (piece, sums) in &blocks {
        for (cell, (sum, count)) in sums.iter().enumerate() {
            whole[cell] = (whole[cell].0 + sum, whole[cell].1 + count);
            let own = &mut by_piece[*piece][cell];
            *own = (own.0 + sum, own.1 + count);
        }
    }
    let explained: Vec<f64> = blocks
        .iter()
        .map(|(piece, sums)| {
            let cells = sums.iter().zip(&whole).zip(&by_piece[*piece]);
            cells
                .map(|(((sum, count), all), own)| {
                    let others = all.1 - own.1;
                    let mean = if others > 0.0 { (all.0 - own.0) / others } else { 0.0 };
                    2.0 * sum * mean - count * mean * mean
                })
                .sum()
        })
        .collect();
    let sum: f64 = explained.iter().sum();
    let samples: f64 = centres.iter().map(|(_, count)| count).sum();
    let branch = |side: usize| {
        let cells = whole.iter().skip(side).step_by(2);
        cells.map(|(sum, count)| (*count > 0.0).then(|| sum / count)).collect()
    };
    Some(CoordinateMap {
        coordinate,
        centres: centres.iter().map(|(sum, count)| sum / count.max(1.0)).collect(),
        upper_n: branch(1),
        lower_n: branch(0),
        share: if squares > 0.0 { sum / squares } else { 0.0 },
        rms_n: (sum.max(0.0) / samples).sqrt(),
        p_value: one_sided(&explained),
    })
}

/// Inner edges of bins with equal content.
fn edges(coordinate: Coordinate, tracks: &[Track], tests: &TestSet) -> Option<Vec<f64>> {
    let mut values: Vec<f64> = tests
        .pieces
        .iter()
        .flat_map(|piece| {
            let values = tracks[piece.test].values(coordinate);
            values.get(piece.samples.clone()).unwrap_or_default().iter().copied()
        })
        .collect();
    values.sort_unstable_by(f64::total_cmp);
    let mut edges: Vec<f64> =
        (1..BINS).filter_map(|k| values.get(k * values.len() / BINS).copied()).collect();
    edges.dedup();
    (edges.len() > 2).then_some(edges)
}
