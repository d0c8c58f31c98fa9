//! Screening: which effects could explain the residual, to first order.
//!
//! Each candidate is added at its start values and simulated once, and once more per parameter.
//! What it changes, less the part that the parameters of the standing model can produce (projection
//! onto the complement of their sensitivities), is compared with the residual:
//!
//! ```text
//! r = S a + D b + rest        gain = fall of the sum of squares by D beyond S
//! ```
//!
//! once plainly and once whitened by the colour of the residual. The same projection shows how much
//! of an effect the nominal parameters absorb: an effect that they absorb wholly, these records
//! cannot show.

use super::candidate::Candidate;
use super::control::Control;
use super::gram::Gram;
use super::linearised::Linearised;
use super::simulation::simulate;
use super::test_set::{Piece, TestSet};
use rayon::prelude::*;

/// One candidate at one of its start values, to first order.
#[derive(Debug, Clone)]
pub(crate) struct Screened {
    /// Index of the candidate.
    pub candidate: usize,
    /// Index of its start values.
    pub start: usize,
    /// Normal equations of every piece: sensitivities of the model first, then the effect's
    /// columns.
    plain: Vec<Gram>,
    /// The same whitened.
    white: Vec<Gram>,
    /// Columns that belong to the standing model.
    own: usize,
}

impl Screened {
    /// Share of the sum of squares that the effect would remove, over all pieces but one.
    pub(crate) fn gain(&self, without: Option<usize>) -> f64 {
        share(&self.plain, self.own, without)
    }

    /// The same of the whitened residual.
    pub(crate) fn whitened_gain(&self, without: Option<usize>) -> f64 {
        share(&self.white, self.own, without)
    }

    /// Norm of the part of the effect that the model's own parameters cannot produce, as a share of
    /// its whole norm.
    pub(crate) fn unabsorbed(&self) -> f64 {
        let Some(all) = Gram::sum(self.plain.iter()) else { return 0.0 };
        let whole = all.columns[(self.own, self.own)];
        let left = all.without_first(self.own).columns[(0, 0)];
        if whole > 0.0 { (left.max(0.0) / whole).sqrt() } else { 0.0 }
    }

    /// Number of standard errors by which the effect would stand out at its start values.
    pub(crate) fn standing_out(&self) -> f64 {
        let Some(all) = Gram::sum(self.white.iter()) else { return 0.0 };
        all.without_first(self.own).columns[(0, 0)].max(0.0).sqrt()
    }
}

fn share(pieces: &[Gram], own: usize, without: Option<usize>) -> f64 {
    let kept = pieces.iter().enumerate().filter(|(index, _)| Some(*index) != without);
    let Some(sum) = Gram::sum(kept.map(|(_, piece)| piece)) else { return 0.0 };
    let rest = sum.without_first(own);
    if rest.squares > 0.0 { rest.fall(&rest.solve()) / rest.squares } else { 0.0 }
}

/// Screens every candidate at every start.
pub(crate) fn screen(
    standing: &Linearised,
    candidates: &[Candidate],
    tests: &TestSet,
    control: Control<'_>,
) -> Vec<Screened> {
    let jobs: Vec<(usize, usize)> = candidates
        .iter()
        .enumerate()
        .flat_map(|(index, candidate)| (0..candidate.starts.len()).map(move |s| (index, s)))
        .collect();
    let plain = Ground::new(standing.slopes.clone(), standing.residual_n.clone(), tests);
    let white = Ground::new(
        standing.slopes.par_iter().map(|slope| whitened(slope, standing)).collect(),
        whitened(&standing.residual_n, standing),
        tests,
    );
    jobs.par_iter()
        .filter(|_| !control.is_stopped())
        .filter_map(|&(candidate, start)| {
            let tried = &candidates[candidate];
            screen_one(standing, (&plain, &white), tried, (candidate, start), tests)
        })
        .collect()
}

fn whitened(by_test: &[Vec<f64>], standing: &Linearised) -> Vec<Vec<f64>> {
    by_test.iter().zip(&standing.colours).map(|(values, colour)| colour.whitened(values)).collect()
}

/// The reference of every candidate: the sensitivities of the standing model, its residual, and
/// their normal equations.
struct Ground {
    /// By parameter, test, sample.
    slopes: Vec<Vec<Vec<f64>>>,
    /// By test, sample.
    residual: Vec<Vec<f64>>,
    /// By piece.
    grams: Vec<Gram>,
}

impl Ground {
    fn new(slopes: Vec<Vec<Vec<f64>>>, residual: Vec<Vec<f64>>, tests: &TestSet) -> Self {
        let mut ground = Self { slopes, residual, grams: Vec::new() };
        ground.grams = tests
            .pieces
            .par_iter()
            .map(|piece| {
                Gram::over(&ground.own(piece), &ground.residual[piece.test][piece.samples.clone()])
            })
            .collect();
        ground
    }

    /// Sensitivities over a piece.
    fn own(&self, piece: &Piece) -> Vec<&[f64]> {
        self.slopes.iter().map(|slope| &slope[piece.test][piece.samples.clone()]).collect()
    }

    /// Normal equations of a piece with its own columns followed by those of an effect, which cover
    /// the whole test.
    fn with(&self, at: usize, piece: &Piece, effect: &[Vec<f64>]) -> Gram {
        let range = piece.samples.clone();
        let mut columns = self.own(piece);
        columns.extend(effect.iter().map(|column| &column[range.clone()]));
        self.grams[at].extended(&columns, &self.residual[piece.test][range])
    }
}

fn screen_one(
    standing: &Linearised,
    (plain_ground, white_ground): (&Ground, &Ground),
    candidate: &Candidate,
    (index, start): (usize, usize),
    tests: &TestSet,
) -> Option<Screened> {
    let fit = &standing.fit;
    let model = fit.model.with(candidate.effect, &tests.scale);
    let mut values = fit.values.clone();
    values.extend(&candidate.starts[start]);
    let free = model.free(&values);
    let own = fit.values.len();
    let mut dampers = vec![model.damper(&values)?];
    for parameter in own..values.len() {
        let mut shifted = free.clone();
        shifted[parameter] += 1e-3;
        dampers.push(model.damper(&model.values(&shifted))?);
    }
    let mut plain = Vec::with_capacity(tests.pieces.len());
    let mut white = Vec::with_capacity(tests.pieces.len());
    for (t, test) in tests.tests.iter().enumerate() {
        let forces: Vec<Vec<f64>> =
            dampers.iter().map(|damper| simulate(damper, test, fit.starts_m[t])).collect();
        let less = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>();
        let mut effect = vec![less(&forces[0], &fit.force_n[t])];
        effect.extend(forces[1..].iter().map(|force| less(force, &forces[0])));
        let colour = &standing.colours[t];
        let white_effect: Vec<Vec<f64>> =
            effect.iter().map(|column| colour.whitened(column)).collect();
        let of_test = tests.pieces.iter().enumerate().filter(|(_, piece)| piece.test == t);
        for (at, piece) in of_test {
            plain.push(plain_ground.with(at, piece, &effect));
            white.push(white_ground.with(at, piece, &white_effect));
        }
    }
    Some(Screened { candidate: index, start, plain, white, own })
}
