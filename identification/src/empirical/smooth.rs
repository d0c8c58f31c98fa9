//! A smooth map by least squares with a penalty on bends.
//!
//! ```text
//! sum (r - sum_k c_k h_k(q))^2 + w n sum_k (c_(k-1) - 2 c_k + c_(k+1))^2 -> min
//! ```
//!
//! r residual, q coordinate, `h_k` hat functions at the knots of a branch, n samples per knot.
//! Knots are quantiles, and the penalty counts in knots and not in the coordinate, so the map may
//! bend where there are many samples. w is the weight with which maps predict left-out pieces best;
//! to judge a piece, it is chosen without that piece too.

use crate::gram::Gram;
use firmware_core::damper::{EmpiricalMap, MAP_KNOTS};
use nalgebra::{Cholesky, DMatrix, DVector};
use rayon::prelude::*;
use std::ops::Range;

/// Weights of the penalty that are tried, the smoothest first.
const WEIGHTS: [f64; 9] = [1e4, 1e3, 1e2, 1e1, 1.0, 1e-1, 1e-2, 1e-3, 1e-4];
/// Pull of every value towards zero, in samples per knot: for knots without samples nearby.
const PULL: f64 = 1e-6;
/// Knots closer than this share of the whole range are one.
const CLOSEST: f64 = 2e-3;
/// Fewest knots that can bend.
const FEWEST_KNOTS: usize = 3;

/// Places of knots at quantiles, the smallest and the largest value included.
pub(super) fn places(mut values: Vec<f64>) -> Option<Vec<f64>> {
    values.sort_unstable_by(f64::total_cmp);
    let (first, last) = (*values.first()?, *values.last()?);
    let least = CLOSEST * (last - first);
    let quantile = |k: usize| values.get(k * (values.len() - 1) / (MAP_KNOTS - 1)).copied();
    let mut places = vec![first];
    for place in (1..MAP_KNOTS - 1).filter_map(quantile) {
        let far = places.last().is_none_or(|before| place - before > least);
        if far && last - place > least {
            places.push(place);
        }
    }
    places.push(last);
    (last > first && places.len() >= FEWEST_KNOTS).then_some(places)
}

/// A coordinate and its branch, sample by sample.
#[derive(Debug, Clone, Default)]
pub(super) struct Along {
    /// The coordinate.
    pub(super) at: Vec<f64>,
    /// True on the upper branch.
    pub(super) extends: Vec<bool>,
}

impl Along {
    /// Normal equations of a residual over some samples, upper branch first. `map` holds the knots
    /// and finds a place between them as it does when it runs.
    pub(super) fn gram(
        &self,
        map: &EmpiricalMap,
        samples: Range<usize>,
        residual_n: &[f64],
    ) -> Gram {
        let knots = map.knots().len();
        let mut gram = Gram {
            columns: DMatrix::zeros(2 * knots, 2 * knots),
            residual: DVector::zeros(2 * knots),
            squares: 0.0,
        };
        let along = self.at[samples.clone()].iter().zip(&self.extends[samples]);
        for ((at, extends), residual) in along.zip(residual_n) {
            let (index, share) = map.place(*at);
            let here = index + if *extends { 0 } else { knots };
            gram.columns[(here, here)] += (1.0 - share) * (1.0 - share);
            gram.residual[here] += (1.0 - share) * residual;
            if share > 0.0 {
                gram.columns[(here + 1, here + 1)] += share * share;
                gram.columns[(here, here + 1)] += share * (1.0 - share);
                gram.columns[(here + 1, here)] += share * (1.0 - share);
                gram.residual[here + 1] += share * residual;
            }
            gram.squares += residual * residual;
        }
        gram
    }
}

/// A piece of record: the residual that a map is fitted to, and the residual by which it is judged,
/// of a model that has not seen the piece.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    /// Of the model fitted to all pieces.
    pub(super) seen: Gram,
    /// Of the model fitted to the others.
    pub(super) unseen: Gram,
}

/// A map fitted to all pieces, and for each piece the error with a map fitted to the others.
#[derive(Debug, Clone)]
pub(super) struct Smoothed {
    /// Values at the knots, upper branch first, N.
    pub(super) values_n: DVector<f64>,
    /// Share of the squared error that it removes on the pieces it is fitted to.
    pub(super) seen_gain: f64,
    /// Squared error of each piece before, N2.
    pub(super) before_n2: Vec<f64>,
    /// The same with a map that has not seen the piece, N2.
    pub(super) after_n2: Vec<f64>,
}

/// Fits a map and leaves every piece out in turn.
pub(super) fn smoothed(pieces: &[Piece]) -> Option<Smoothed> {
    let whole = Gram::sum(pieces.iter().map(|piece| &piece.seen))?;
    let penalty = Penalty::new(&whole);
    // By weight: the error of piece j without the pieces i and j.
    let tables: Vec<DMatrix<f64>> = WEIGHTS
        .par_iter()
        .map(|weight| left_out(&whole, pieces, &penalty, *weight))
        .collect::<Option<_>>()?;
    let best = |error: &dyn Fn(&DMatrix<f64>) -> f64| {
        let errors = tables.iter().map(error).enumerate();
        // Of equals the first, which is the smoothest.
        errors.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index)
    };
    let mut after_n2 = Vec::with_capacity(pieces.len());
    for piece in 0..pieces.len() {
        let chosen = best(&|table| table.row(piece).sum() - table[(piece, piece)])?;
        after_n2.push(tables[chosen][(piece, piece)]);
    }
    let chosen = best(&|table| table.diagonal().sum())?;
    let values_n = penalty.solve(&whole, WEIGHTS[chosen])?;
    let seen_gain = if whole.squares > 0.0 { whole.fall(&values_n) / whole.squares } else { 0.0 };
    let before_n2 = pieces.iter().map(|piece| piece.unseen.squares).collect();
    Some(Smoothed { values_n, seen_gain, before_n2, after_n2 })
}

/// Row i, column j: squared error of piece j with the map of all pieces but i and j.
fn left_out(
    whole: &Gram,
    pieces: &[Piece],
    penalty: &Penalty,
    weight: f64,
) -> Option<DMatrix<f64>> {
    let mut table = DMatrix::zeros(pieces.len(), pieces.len());
    for i in 0..pieces.len() {
        for j in 0..=i {
            let mut others = less(whole, &pieces[i].seen);
            if j < i {
                others = less(&others, &pieces[j].seen);
            }
            let values_n = penalty.solve(&others, weight)?;
            for (out, of) in [(i, j), (j, i)] {
                let unseen = &pieces[of].unseen;
                table[(out, of)] = (unseen.squares - unseen.fall(&values_n)).max(0.0);
            }
        }
    }
    Some(table)
}

fn less(whole: &Gram, piece: &Gram) -> Gram {
    Gram {
        columns: &whole.columns - &piece.columns,
        residual: &whole.residual - &piece.residual,
        squares: whole.squares - piece.squares,
    }
}

/// The penalty on bends, in samples per knot.
struct Penalty {
    bends: DMatrix<f64>,
    samples_per_knot: f64,
}

impl Penalty {
    fn new(whole: &Gram) -> Self {
        let count = whole.columns.nrows();
        let knots = count / 2;
        let mut bends = DMatrix::zeros(count, count);
        for branch in [0, knots] {
            for middle in branch + 1..branch + knots - 1 {
                let bend = [(middle - 1, 1.0), (middle, -2.0), (middle + 1, 1.0)];
                for (row, a) in bend {
                    for (column, b) in bend {
                        bends[(row, column)] += a * b;
                    }
                }
            }
        }
        // Hat functions add up to one at every sample.
        Self { bends, samples_per_knot: whole.columns.sum() / count as f64 }
    }

    fn solve(&self, gram: &Gram, weight: f64) -> Option<DVector<f64>> {
        let mut columns = &gram.columns + &self.bends * (weight * self.samples_per_knot);
        for index in 0..columns.nrows() {
            columns[(index, index)] += PULL * self.samples_per_knot;
        }
        Cholesky::new(columns).map(|root| root.solve(&gram.residual))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_core::damper::{MapCoordinate, MapKnot};
    use signal::random::Random;

    const PIECES: usize = 6;
    const SAMPLES: usize = 500;

    /// A sawtooth over -1 to 1, up and down, with a force over it and noise.
    fn found(force_n: impl Fn(f64, bool) -> f64) -> (EmpiricalMap, Smoothed) {
        let mut random = Random::new(3, 1);
        let (mut along, mut residual_n) = (Along::default(), Vec::new());
        for sample in 0..PIECES * SAMPLES {
            let turn = (sample % 97) as f64 / 48.5;
            let (at, extends) =
                if turn < 1.0 { (2.0 * turn - 1.0, true) } else { (3.0 - 2.0 * turn, false) };
            along.at.push(at);
            along.extends.push(extends);
            residual_n.push(force_n(at, extends) + 10.0 * random.gaussian());
        }
        let knots: Vec<MapKnot> = places(along.at.clone())
            .unwrap()
            .into_iter()
            .map(|at| MapKnot { at, upper_n: 0.0, lower_n: 0.0 })
            .collect();
        let map = EmpiricalMap::new(MapCoordinate::Displacement, &knots, 0.0).unwrap();
        let pieces: Vec<Piece> = (0..PIECES)
            .map(|piece| {
                let samples = piece * SAMPLES..(piece + 1) * SAMPLES;
                let gram = along.gram(&map, samples.clone(), &residual_n[samples]);
                Piece { seen: gram.clone(), unseen: gram }
            })
            .collect();
        let smoothed = smoothed(&pieces).unwrap();
        (map, smoothed)
    }

    #[test]
    fn a_curve_in_noise_is_found_on_both_branches() {
        let curve =
            |at: f64, extends: bool| if extends { 30.0 * libm::sin(3.0 * at) } else { -20.0 };
        let (map, smoothed) = found(curve);
        let knots = map.knots().len();
        assert_eq!(knots, MAP_KNOTS);
        for (index, knot) in map.knots().iter().enumerate() {
            for (branch, extends) in [(0, true), (knots, false)] {
                let (value, truth) = (smoothed.values_n[branch + index], curve(knot.at, extends));
                assert!((value - truth).abs() < 4.0, "{}: {value} {truth}", knot.at);
            }
        }
        let (before, after): (f64, f64) =
            (smoothed.before_n2.iter().sum(), smoothed.after_n2.iter().sum());
        // 10 N of noise remain of 10 N and about 20 N.
        let rms = (after / (PIECES * SAMPLES) as f64).sqrt();
        assert!((rms - 10.0).abs() < 0.4 && after < 0.3 * before, "{rms}");
        assert!((smoothed.seen_gain - (1.0 - after / before)).abs() < 0.02);
    }

    #[test]
    fn noise_alone_gains_nothing() {
        let (_, smoothed) = found(|_, _| 0.0);
        let (before, after): (f64, f64) =
            (smoothed.before_n2.iter().sum(), smoothed.after_n2.iter().sum());
        assert!(after > 0.995 * before, "{after} {before}");
        assert!(smoothed.values_n.amax() < 2.0, "{}", smoothed.values_n);
    }

    #[test]
    fn places_rise_and_hold_all_values() {
        let crowded: Vec<f64> =
            (0..1000).map(|k| if k < 900 { 1e-9 * f64::from(k) } else { f64::from(k) }).collect();
        let places = places(crowded).unwrap();
        assert!(places.windows(2).all(|pair| pair[1] - pair[0] > 1.0), "{places:?}");
        assert_eq!((places[0], places[places.len() - 1]), (0.0, 999.0));
        assert_eq!(super::places(vec![1.0; 50]), None);
        assert_eq!(super::places(Vec::new()), None);
    }

    #[test]
    fn one_piece_says_nothing() {
        let gram = Gram::over(
            &[&[1.0; 9], &[0.0; 9], &[0.0; 9], &[0.0; 9], &[0.0; 9], &[0.0; 9]],
            &[5.0; 9],
        );
        let one = smoothed(&[Piece { seen: gram.clone(), unseen: gram }]).unwrap();
        assert!((one.after_n2[0] - one.before_n2[0]).abs() < 1e-9);
    }
}
