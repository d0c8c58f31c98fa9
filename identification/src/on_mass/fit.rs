//! Least squares on the free-run motion: Levenberg-Marquardt over the parameters of the body and
//! the starts of the records that move at their first sample.
//!
//! Derivatives are differences of simulations, in parallel over parameters and records; every sum
//! is formed in the order of the records, so the result does not depend on the number of cores.

use super::model::Model;
use super::record::Record;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Parts of every record, in time, that can be left out.
pub(crate) const PARTS: usize = 6;
/// Step of a derivative, in a free number.
const DERIVATIVE_STEP: f64 = 1e-5;
/// Residual of a model without a motion, as a multiple of the largest measured value.
const NO_MOTION: f64 = 1e3;

/// Which parts a fit does not see.
pub(crate) type LeftOut = [bool; PARTS];
/// None of them.
pub(crate) const WHOLE: LeftOut = [false; PARTS];

/// How long a fit may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Effort {
    /// Most evaluations, in multiples of the number of parameters plus one.
    pub(super) patience: usize,
    /// Relative gain below which it ends.
    pub(super) gain: f64,
}

impl Effort {
    /// To the minimum.
    pub(super) const FULL: Self = Self { patience: 20, gain: 1e-10 };
    /// Near enough to the minimum to compare left-out parts.
    pub(super) const TRIAL: Self = Self { patience: 10, gain: 1e-6 };
    /// Enough to compare starts.
    pub(super) const SHORT: Self = Self { patience: 5, gain: 1e-4 };
}

/// A model fitted to records.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fit {
    /// Parameters of the model.
    pub(crate) values: Vec<f64>,
    /// Displacement and velocity at the first sample of every record.
    pub(crate) starts: Vec<[f64; 2]>,
    /// Simulated motion of every record.
    pub(crate) motion: Vec<Vec<f64>>,
    /// Sum of squared errors of every part, over all records.
    pub(crate) squares: [f64; PARTS],
}

impl Fit {
    /// A model with given parameters and starts; none where its motion runs away.
    pub(super) fn evaluate(
        model: &Model,
        values: &[f64],
        starts: &[[f64; 2]],
        records: &[Record],
    ) -> Option<Self> {
        debug_assert_eq!(starts.len(), records.len(), "one start per record");
        let pairs = records.par_iter().zip(starts);
        let runs = pairs.map(|(record, start)| model.simulate(values, record, *start));
        let motion = runs.collect::<Option<Vec<_>>>()?;
        let mut squares = [0.0; PARTS];
        for (record, motion) in records.iter().zip(&motion) {
            for (sample, (model, measured)) in motion.iter().zip(&record.motion).enumerate() {
                squares[part(sample, record.len())] += (model - measured) * (model - measured);
            }
        }
        Some(Self { values: values.to_vec(), starts: starts.to_vec(), motion, squares })
    }

    /// Sum of squared errors over the parts that a fit sees.
    pub(super) fn seen(&self, left_out: LeftOut) -> f64 {
        let parts = self.squares.iter().zip(left_out);
        parts.filter(|(_, left_out)| !left_out).map(|(squares, _)| squares).sum()
    }
}

/// The part that a sample belongs to.
fn part(sample: usize, count: usize) -> usize {
    (sample * PARTS / count).min(PARTS - 1)
}

/// Number of samples of all records.
pub(crate) fn samples(records: &[Record]) -> usize {
    records.iter().map(Record::len).sum()
}

/// Fits a model from given parameters and starts; none where they make no motion or the work is
/// stopped.
pub(super) fn fit(
    model: &Model,
    from: (&[f64], &[[f64; 2]]),
    records: &[Record],
    left_out: LeftOut,
    effort: Effort,
    stop: &AtomicBool,
) -> Option<Fit> {
    let (values, starts) = from;
    let begin = Fit::evaluate(model, values, starts, records)?;
    let mut free = model.free(values);
    free.extend(starts_to_free(model, starts, records));
    let problem =
        Problem { model, records, left_out, stop, free, motion: Some(begin.motion.clone()) };
    let solver = LevenbergMarquardt::new()
        .with_ftol(effort.gain)
        .with_xtol(effort.gain)
        .with_gtol(1e-12)
        .with_stepbound(1.0)
        .with_patience(effort.patience);
    let (problem, _) = solver.minimize(problem);
    if stop.load(Ordering::Relaxed) {
        return None;
    }
    let (values, starts) = problem.split();
    let end = Fit::evaluate(model, &values, &starts, records)?;
    Some(if end.seen(left_out) < begin.seen(left_out) { end } else { begin })
}

/// Standard deviations of the parameters of a fitted model, if its residual is white; none where
/// the records do not fix them all. A single parameter that they do not fix is infinite.
pub(super) fn deviations(
    model: &Model,
    fit: &Fit,
    records: &[Record],
    stop: &AtomicBool,
) -> Option<Vec<f64>> {
    let mut free = model.free(&fit.values);
    free.extend(starts_to_free(model, &fit.starts, records));
    let motion = Some(fit.motion.clone());
    let problem = Problem { model, records, left_out: WHOLE, stop, free, motion };
    let all = problem.jacobian()?;
    // A parameter that moves nothing, such as a slope beyond a relief that never opens.
    let acts: Vec<usize> = (0..all.ncols()).filter(|n| all.column(*n).norm() > 0.0).collect();
    let slopes = all.select_columns(&acts);
    let count = acts.len();
    let sizes: Vec<f64> =
        slopes.column_iter().map(|column| column.norm().max(f64::MIN_POSITIVE)).collect();
    let normal = slopes.tr_mul(&slopes);
    let scaled = DMatrix::from_fn(count, count, |i, j| normal[(i, j)] / (sizes[i] * sizes[j]));
    let inverse = scaled.try_inverse()?;
    let rows = samples(records) as f64;
    let variance = fit.seen(WHOLE) / (rows - count as f64).max(1.0);
    let mut std = vec![f64::INFINITY; all.ncols()];
    for (number, place) in acts.into_iter().enumerate() {
        std[place] = libm::sqrt(variance * inverse[(number, number)]) / sizes[number];
    }
    Some(model.deviations(&fit.values, &std))
}

fn starts_to_free(model: &Model, starts: &[[f64; 2]], records: &[Record]) -> Vec<f64> {
    let sizes = &model.sizes;
    let moving = starts.iter().zip(records).filter(|(_, record)| record.moves_at_start());
    let pairs =
        moving.flat_map(|([y, v], _)| [y / sizes.displacement_m, v / sizes.velocity_m_per_s]);
    pairs.collect()
}

struct Problem<'a> {
    model: &'a Model,
    records: &'a [Record],
    left_out: LeftOut,
    stop: &'a AtomicBool,
    free: Vec<f64>,
    motion: Option<Vec<Vec<f64>>>,
}

impl Problem<'_> {
    /// Parameters and starts.
    fn split(&self) -> (Vec<f64>, Vec<[f64; 2]>) {
        self.split_of(&self.free)
    }

    fn split_of(&self, free: &[f64]) -> (Vec<f64>, Vec<[f64; 2]>) {
        let (own, starts) = free.split_at(self.model.parameters());
        let sizes = &self.model.sizes;
        let mut starts = starts.chunks_exact(2);
        let start = |record: &Record| {
            let given = if record.moves_at_start() { starts.next() } else { None };
            given.map_or([0.0; 2], |pair| {
                [pair[0] * sizes.displacement_m, pair[1] * sizes.velocity_m_per_s]
            })
        };
        (self.model.values(own), self.records.iter().map(start).collect())
    }

    fn is_seen(&self, sample: usize, record: &Record) -> bool {
        !self.left_out[part(sample, record.len())]
    }

    fn rows(&self) -> usize {
        let seen = self
            .records
            .iter()
            .map(|record| (0..record.len()).filter(|sample| self.is_seen(*sample, record)).count());
        seen.sum()
    }

    /// The values of every record at the samples that the fit sees, one after the other.
    fn seen<'b>(&'b self, values: &'b [Vec<f64>]) -> impl Iterator<Item = f64> + 'b {
        self.records.iter().zip(values).flat_map(move |(record, values)| {
            let kept = values.iter().enumerate().filter(|(n, _)| self.is_seen(*n, record));
            kept.map(|(_, value)| *value)
        })
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, params: &DVector<f64>) {
        self.free = params.as_slice().to_vec();
        let (values, starts) = self.split();
        let pairs = self.records.par_iter().zip(&starts);
        let runs = pairs.map(|(record, start)| self.model.simulate(&values, record, *start));
        self.motion = runs.collect();
    }

    fn params(&self) -> DVector<f64> {
        DVector::from_column_slice(&self.free)
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        if self.stop.load(Ordering::Relaxed) {
            return None;
        }
        let rows = self.rows();
        let Some(motion) = &self.motion else {
            // No motion: a very large error, so that the solver turns back.
            let all = self.records.iter().flat_map(|record| &record.motion);
            let largest = all.fold(0.0, |most: f64, value| most.max(value.abs()));
            return Some(DVector::from_element(rows, NO_MOTION * largest));
        };
        let measured: Vec<Vec<f64>> =
            self.records.iter().map(|record| record.motion.clone()).collect();
        let misses =
            self.seen(motion).zip(self.seen(&measured)).map(|(model, there)| model - there);
        Some(DVector::from_iterator(rows, misses))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        if self.stop.load(Ordering::Relaxed) {
            return None;
        }
        let motion = self.motion.as_ref()?;
        let (count, records) = (self.free.len(), self.records.len());
        let flat: Vec<Vec<f64>> = (0..count * records)
            .into_par_iter()
            .map(|job| self.slope(job / records, job % records, &motion[job % records]))
            .collect();
        let mut matrix = DMatrix::zeros(self.rows(), count);
        for (mut column, slopes) in matrix.column_iter_mut().zip(flat.chunks(records.max(1))) {
            for (entry, slope) in column.iter_mut().zip(self.seen(slopes)) {
                *entry = slope;
            }
        }
        Some(matrix)
    }
}

impl Problem<'_> {
    /// Change of the motion of a record per change of a free number.
    fn slope(&self, number: usize, record: usize, base: &[f64]) -> Vec<f64> {
        // The other side, if there is no motion on the first.
        let shifted = [DERIVATIVE_STEP, -DERIVATIVE_STEP].into_iter().find_map(|step| {
            let mut free = self.free.clone();
            free[number] += step;
            let (values, starts) = self.split_of(&free);
            let there = self.model.simulate(&values, &self.records[record], starts[record])?;
            Some((there, step))
        });
        let Some((there, step)) = shifted else { return vec![0.0; base.len()] };
        there.iter().zip(base).map(|(there, here)| (there - here) / step).collect()
    }
}
