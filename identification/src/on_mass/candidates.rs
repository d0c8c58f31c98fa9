//! One round of naming: every law of the catalogue is added to the model, fitted to all parts, and
//! judged on parts that it was not fitted to.

use super::control::OnMassControl;
use super::fit::{Effort, Fit, LeftOut, PARTS, WHOLE, fit, samples};
use super::law::{LAWS, LawInfo};
use super::model::{BODY, Model};
use super::record::Record;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The parts that one refit does not see; every part is left out once.
const FOLDS: [[usize; 2]; 3] = [[0, 3], [1, 4], [2, 5]];
/// Starts of a candidate whose fit is continued to the minimum.
const CONTINUED: usize = 2;
/// Share of the squared error of the fitted parts that a law must remove to be judged on left-out
/// parts, where it has to remove twice as much.
const WORTH_JUDGING: f64 = 0.005;

/// A model fitted to all parts, and its errors on parts left out.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Judged {
    pub(crate) model: Model,
    pub(crate) fit: Fit,
    /// Sum of squared errors of every part, each from a refit without it.
    pub(crate) left_out: [f64; PARTS],
}

/// A candidate of a round.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Candidate {
    pub(crate) law: &'static LawInfo,
    /// Share of the squared error of the fitted parts that it removes; none where no start led to a
    /// motion.
    pub(crate) fitted_gain: Option<f64>,
    /// None where it removes too little to be judged.
    pub(crate) judged: Option<Judged>,
}

impl Judged {
    /// Judges a model that was fitted to all parts; none where the work was stopped.
    pub(super) fn new(
        model: Model,
        fitted: Fit,
        records: &[Record],
        control: OnMassControl<'_>,
    ) -> Option<Self> {
        let folds: Vec<Option<Fit>> = FOLDS
            .par_iter()
            .map(|parts| {
                let left_out: LeftOut = std::array::from_fn(|part| parts.contains(&part));
                let from = (fitted.values.as_slice(), fitted.starts.as_slice());
                fit(&model, from, records, left_out, Effort::TRIAL, control.stop)
            })
            .collect();
        let mut left_out = [0.0; PARTS];
        for (parts, fold) in FOLDS.iter().zip(folds) {
            let fold = fold?;
            for part in parts {
                left_out[*part] = fold.squares[*part];
            }
        }
        Some(Self { model, fit: fitted, left_out })
    }

    /// rms error over the training records.
    pub(crate) fn rms(&self, records: &[Record]) -> f64 {
        (self.fit.squares.iter().sum::<f64>() / samples(records) as f64).sqrt()
    }

    /// rms error on parts left out.
    pub(crate) fn left_out_rms(&self, records: &[Record]) -> f64 {
        (self.left_out.iter().sum::<f64>() / samples(records) as f64).sqrt()
    }

    /// Share of the squared left-out error of another model that this one removes.
    pub(crate) fn gain_on(&self, other: &Self) -> f64 {
        1.0 - self.left_out.iter().sum::<f64>() / other.left_out.iter().sum::<f64>()
    }

    /// Parts that this model predicts better than another one.
    pub(crate) fn better_parts(&self, other: &Self) -> usize {
        self.left_out.iter().zip(other.left_out).filter(|(own, other)| *own < other).count()
    }
}

/// Tries every law that the model does not have. None of them has a judgement once the work is
/// stopped.
pub(super) fn candidates(
    base: &Judged,
    records: &[Record],
    round: usize,
    control: OnMassControl<'_>,
) -> Vec<Candidate> {
    let known = |law: &&LawInfo| base.model.laws.iter().all(|other| other.kind != law.kind);
    let laws: Vec<&'static LawInfo> = LAWS.iter().filter(known).collect();
    let of = laws.len();
    let done = AtomicUsize::new(0);
    let step = format!("round {round}: candidates of motion");
    (control.progress)([0, of], &step);
    laws.into_par_iter()
        .map(|law| {
            let candidate = candidate(law, base, records, control);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            (control.progress)([done, of], &format!("{step}: {}", law.name));
            candidate
        })
        .collect()
}

fn candidate(
    law: &'static LawInfo,
    base: &Judged,
    records: &[Record],
    control: OnMassControl<'_>,
) -> Candidate {
    let model = base.model.with(law);
    let attempt = |values: &[f64], starts: &[[f64; 2]], effort| {
        fit(&model, (values, starts), records, WHOLE, effort, control.stop)
    };
    let better = |a: &Fit, b: &Fit| a.seen(WHOLE).total_cmp(&b.seen(WHOLE));
    let mut short: Vec<Fit> = (0..law.starts())
        .into_par_iter()
        .filter_map(|start| {
            let values = start_values(&model, &base.fit, law, start);
            attempt(&values, &base.fit.starts, Effort::SHORT)
        })
        .collect();
    short.sort_by(better);
    let gain = |fit: &Fit| 1.0 - fit.seen(WHOLE) / base.fit.seen(WHOLE);
    let fitted_gain = short.first().map(gain);
    if !fitted_gain.is_some_and(|gain| gain >= WORTH_JUDGING) {
        return Candidate { law, fitted_gain, judged: None };
    }
    short.truncate(CONTINUED);
    let full = short
        .par_iter()
        .filter_map(|start| attempt(&start.values, &start.starts, Effort::FULL))
        .min_by(better);
    let fitted_gain = full.as_ref().map(gain);
    let judged = full.and_then(|full| Judged::new(model, full, records, control));
    Candidate { law, fitted_gain, judged }
}

/// The parameters of the base and a start of the new law. What the law adds to the stiffness at
/// small motion is taken from the spring of the body.
fn start_values(model: &Model, base: &Fit, law: &LawInfo, start: usize) -> Vec<f64> {
    let mut values = base.values.clone();
    let new = law.parameters.iter().map(|row| {
        let factor = row.starts.get(start).or(row.starts.last()).copied().unwrap_or(1.0);
        factor * (row.scale)(&model.sizes)
    });
    values.extend(new);
    if let Some(stiffness) = law.stiffness_of_start(&values[base.values.len()..]) {
        debug_assert!(values.len() > BODY.len(), "a law has parameters");
        values[1] -= stiffness;
    }
    values
}
