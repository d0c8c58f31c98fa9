//! The search: the linear body, then one law after the other, until none removes any error on parts
//! that it was not fitted to.

use super::candidates::{Candidate, Judged, candidates};
use super::control::OnMassControl;
use super::fit::{Effort, Fit, PARTS, WHOLE, fit, samples};
use super::law::{LawInfo, Sizes};
use super::linear::{self, Linear};
use super::model::Model;
use super::periods;
use super::record::Record;
use measurement::body_record::Output;

/// Least share of the squared left-out error that a law must remove, in long records.
pub(crate) const LEAST_GAIN: f64 = 0.01;
/// Parts that it must predict better.
pub(crate) const LEAST_PARTS: usize = PARTS - 1;
/// A simpler law is preferred, and another one is an alternative, where its left-out error is at
/// most this times the best.
const ALIKE: f64 = 1.02;
/// Most laws in a model.
const MOST_LAWS: usize = 4;
/// Steps of the simulation per radian of the free vibration, in the search.
const STEPS_PER_RADIAN: f64 = 33.0;
/// Error of the steps that a search allows, as a share of the noise floor.
const STEP_ERROR: f64 = 0.3;
/// Steps per sample that are not doubled any more.
const MOST_SUBSTEPS: usize = 40;
/// Limits of the steps per sample at the beginning; the final fit has twice as many as the search.
const SUBSTEPS: [usize; 2] = [4, 20];

/// A round of the search.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Round {
    /// Every law that was tried.
    pub(crate) candidates: Vec<Candidate>,
    /// The law that was accepted.
    pub(crate) accepted: Option<&'static LawInfo>,
    /// Laws that describe the left-out parts as well.
    pub(crate) alternatives: Vec<&'static LawInfo>,
}

/// Everything that a search has found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Search {
    /// The linear body and the models with one law more each.
    pub(crate) stages: Vec<Judged>,
    /// One for each stage; the last one accepts nothing.
    pub(crate) rounds: Vec<Round>,
    /// Decay of a free vibration of the linear body, 1/s.
    pub(crate) decay_per_s: f64,
    /// The work was stopped early.
    pub(crate) interrupted: bool,
}

/// Names what the linear body lacks, or what the body with given laws lacks; none where nothing
/// follows the records at all or the work is stopped before the first fit.
pub(crate) fn search(
    records: &mut [Record],
    given: &[(&'static LawInfo, Vec<f64>)],
    control: OnMassControl<'_>,
) -> Option<Search> {
    (control.progress)([0, 0], "the linear body");
    let start = linear::start(records);
    let sizes = sizes(records, start);
    let decay_per_s = 0.5 * start.c0_n_s_per_m / start.mass_kg;
    prepare(records, start, decay_per_s);
    let (model, fitted) = first_fit(records, start, sizes, given, control)?;
    let fitted = on_fine_clock(&model, fitted, records, control);
    let mut stages = vec![Judged::new(model, fitted, records, control)?];
    let mut rounds = Vec::new();
    while let Some(base) = stages.last() {
        let candidates = candidates(base, records, rounds.len() + 1, control);
        if control.is_stopped() {
            return Some(Search { stages, rounds, decay_per_s, interrupted: true });
        }
        let (accepted, alternatives) = choose(base, &candidates, records);
        let found = accepted.and_then(|law| {
            let mut all = candidates.iter();
            all.find(|candidate| candidate.law == law).and_then(|one| one.judged.clone())
        });
        let full = base.model.laws.len() >= MOST_LAWS;
        let accepted = accepted.filter(|_| !full);
        rounds.push(Round { candidates, accepted, alternatives });
        match found {
            Some(judged) if !full => stages.push(judged),
            _ => break,
        }
    }
    Some(Search { stages, rounds, decay_per_s, interrupted: false })
}

/// Fits the first model: the linear body from several starts, then the given laws.
fn first_fit(
    records: &[Record],
    start: Linear,
    sizes: Sizes,
    given: &[(&'static LawInfo, Vec<f64>)],
    control: OnMassControl<'_>,
) -> Option<(Model, Fit)> {
    let linear = Model::linear(start, sizes);
    let none = vec![[0.0; 2]; records.len()];
    let begin: Vec<[f64; 2]> = records.iter().map(beginning).collect();
    let starts = if records.iter().any(Record::moves_at_start) { begin } else { none };
    let fits = [1.0, 0.5, 2.0].into_iter().filter_map(|factor| {
        let Linear { mass_kg, k0_n_per_m, c0_n_s_per_m } = start;
        let values = [mass_kg, factor * k0_n_per_m, c0_n_s_per_m];
        fit(&linear, (&values, &starts), records, WHOLE, Effort::FULL, control.stop)
    });
    let best = fits.min_by(|a, b| a.seen(WHOLE).total_cmp(&b.seen(WHOLE)));
    if given.is_empty() {
        return best.map(|fit| (linear, fit));
    }
    // What spring and dashpot explain may be the given law's: they start with little.
    let model = given.iter().fold(linear, |model, (law, _)| model.with(law));
    let own = given.iter().flat_map(|(_, values)| values.clone());
    let shares = [1.0, 0.1, 0.0].into_iter().flat_map(|k| [1.0, 0.1].map(|c| (k, c)));
    let base = best.as_ref().map_or_else(
        || vec![start.mass_kg, start.k0_n_per_m, start.c0_n_s_per_m],
        |fit| fit.values.clone(),
    );
    let starts_of = best.as_ref().map_or(starts, |fit| fit.starts.clone());
    let mut fits: Vec<Fit> = shares
        .filter_map(|(k, c)| {
            let body = [base[0], k * base[1], c * base[2]];
            let values: Vec<f64> = body.into_iter().chain(own.clone()).collect();
            fit(&model, (&values, &starts_of), records, WHOLE, Effort::SHORT, control.stop)
        })
        .collect();
    fits.sort_by(|a, b| a.seen(WHOLE).total_cmp(&b.seen(WHOLE)));
    let best = fits.into_iter().next()?;
    let from = (best.values.as_slice(), best.starts.as_slice());
    let full = fit(&model, from, records, WHOLE, Effort::FULL, control.stop)?;
    Some((model, full))
}

/// rms noise of all training records, periods averaged, if it is known of each of them.
pub(crate) fn noise_floor(records: &[Record]) -> Option<f64> {
    let squares = records
        .iter()
        .map(|record| record.noise_of_mean().map(|noise| noise * noise * record.len() as f64));
    Some(libm::sqrt(squares.sum::<Option<f64>>()? / samples(records) as f64))
}

/// The fit on a clock on which the error of the steps is small compared with the noise: otherwise a
/// law of the catalogue would be found that describes that error. Where the noise is not known, the
/// residual of the first model counts.
fn on_fine_clock(
    model: &Model,
    mut fitted: Fit,
    records: &mut [Record],
    control: OnMassControl<'_>,
) -> Fit {
    let residual = libm::sqrt(fitted.seen(WHOLE) / samples(records) as f64);
    let limit = STEP_ERROR * noise_floor(records).unwrap_or(residual);
    while records.iter().all(|record| record.substeps() < MOST_SUBSTEPS) {
        for record in records.iter_mut() {
            record.set_substeps(2 * record.substeps());
        }
        let finer = Fit::evaluate(model, &fitted.values, &fitted.starts, records);
        let pairs = finer.iter().flat_map(|finer| finer.motion.iter().zip(&fitted.motion));
        let changes = pairs.flat_map(|(fine, coarse)| fine.iter().zip(coarse));
        // Of second order: the change is three quarters of the error.
        let error = periods::rms(changes.map(|(fine, coarse)| (fine - coarse) / 0.75));
        if error.is_nan() || error <= limit {
            for record in records.iter_mut() {
                record.set_substeps(record.substeps() / 2);
            }
            break;
        }
        let from = (fitted.values.as_slice(), fitted.starts.as_slice());
        match fit(model, from, records, WHOLE, Effort::FULL, control.stop) {
            Some(better) => fitted = better,
            None => break,
        }
    }
    fitted
}

/// A fit of the same model on a clock that is twice as fast.
pub(crate) fn refined(judged: &Judged, records: &mut [Record], control: OnMassControl<'_>) -> Fit {
    for record in records.iter_mut() {
        record.set_substeps(2 * record.substeps());
    }
    let from = (judged.fit.values.as_slice(), judged.fit.starts.as_slice());
    let fitted = fit(&judged.model, from, records, WHOLE, Effort::FULL, control.stop);
    fitted.unwrap_or_else(|| judged.fit.clone())
}

/// Displacement and velocity at the first sample, from a parabola through the first few.
pub(crate) fn beginning(record: &Record) -> [f64; 2] {
    if !record.moves_at_start() || record.output == Output::Acceleration {
        return [0.0; 2];
    }
    let few = &record.motion[..record.len().min(9)];
    let slope = |n: usize| {
        let there = few.get(n).zip(few.first()).map_or(0.0, |(there, here)| there - here);
        there / (n as f64 * record.step_s)
    };
    let (near, far) = (slope(few.len() / 2), slope(few.len() - 1));
    [few.first().copied().unwrap_or(0.0), 2.0 * near - far]
}

/// Sizes of the records, those of velocity and displacement from the linear body.
fn sizes(records: &[Record], linear: Linear) -> Sizes {
    let Linear { mass_kg, k0_n_per_m, c0_n_s_per_m } = linear;
    let omega = libm::sqrt(k0_n_per_m.abs() / mass_kg).max(1e-3);
    let forces = || records.iter().flat_map(|record| record.force_n.iter().copied());
    let mean = forces().sum::<f64>() / forces().count() as f64;
    let varying = periods::rms(forces().map(|force| force - mean));
    // A constant force, as in a drop tower, has no other size.
    let force_n = if varying > 1e-3 * mean.abs() { varying } else { mean.abs() };
    let displacement_m = periods::rms(records.iter().flat_map(|record| {
        let factor = match record.output {
            Output::Displacement => 1.0,
            Output::Acceleration => 1.0 / (omega * omega),
        };
        record.motion.iter().map(move |motion| factor * motion)
    }));
    let pairs = records.iter().filter(|record| record.output == Output::Displacement);
    let slopes = pairs.flat_map(|record| {
        record.motion.windows(2).map(move |pair| (pair[1] - pair[0]) / record.step_s)
    });
    let slopes: Vec<f64> = slopes.collect();
    // Differences of noise are no velocity: not more than twice the free vibration.
    let free = omega * displacement_m;
    let measured = if slopes.is_empty() { free } else { periods::rms(slopes.into_iter()) };
    let least_k = 1e-3 * force_n / displacement_m;
    Sizes {
        force_n,
        displacement_m,
        velocity_m_per_s: measured.min(2.0 * free).max(1e-2 * free),
        stiffness_n_per_m: k0_n_per_m.abs().max(least_k),
        damping_n_s_per_m: c0_n_s_per_m.abs().max(1e-2 * libm::sqrt(mass_kg * k0_n_per_m.abs())),
    }
}

/// Steps and warm-up of every record.
fn prepare(records: &mut [Record], linear: Linear, decay_per_s: f64) {
    let Linear { mass_kg, k0_n_per_m, .. } = linear;
    let omega = libm::sqrt(k0_n_per_m.abs() / mass_kg);
    for record in records {
        let wanted = libm::ceil(STEPS_PER_RADIAN * omega * record.step_s);
        let [least, most] = SUBSTEPS;
        record.set_substeps(if wanted > 0.0 {
            (wanted as usize).clamp(least, most)
        } else {
            least
        });
        record.set_warm_up(decay_per_s);
    }
}

/// Share of the squared left-out error that a law with this many parameters must remove. Chance
/// removes about one part in the number of samples per parameter, and the best of many candidates
/// more.
pub(crate) fn least_gain(parameters: usize, samples: usize) -> f64 {
    let chance = (2 * parameters + 10) as f64 / samples as f64;
    LEAST_GAIN.max(chance)
}

/// The law to accept and its alternatives: the simplest of those that are as good as the best. A
/// model at the noise floor lacks none.
fn choose(
    base: &Judged,
    candidates: &[Candidate],
    records: &[Record],
) -> (Option<&'static LawInfo>, Vec<&'static LawInfo>) {
    if noise_floor(records).is_some_and(|floor| base.rms(records) <= floor) {
        return (None, Vec::new());
    }
    let samples = samples(records);
    let passed = |candidate: &&Candidate| {
        candidate.judged.as_ref().is_some_and(|judged| {
            judged.gain_on(base) >= least_gain(candidate.law.parameters.len(), samples)
                && judged.better_parts(base) >= LEAST_PARTS
        })
    };
    let error = |candidate: &Candidate| {
        candidate.judged.as_ref().map_or(f64::INFINITY, |judged| judged.left_out_rms(records))
    };
    let passed: Vec<&Candidate> = candidates.iter().filter(passed).collect();
    let Some(best) = passed.iter().map(|one| error(one)).min_by(f64::total_cmp) else {
        return (None, Vec::new());
    };
    let mut alike: Vec<&&Candidate> =
        passed.iter().filter(|one| error(one) <= ALIKE * best).collect();
    alike.sort_by(|a, b| {
        let size = |one: &Candidate| one.law.parameters.len();
        size(a).cmp(&size(b)).then(error(a).total_cmp(&error(b)))
    });
    let mut laws = alike.into_iter().map(|one| one.law);
    (laws.next(), laws.collect())
}
