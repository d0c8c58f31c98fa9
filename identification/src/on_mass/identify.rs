//! The whole: records to a named model of the body.

use super::control::OnMassControl;
use super::fit::{Fit, deviations};
use super::holdout::{self, HeldOut};
use super::law::{Kind, LawInfo, SERIES_DAMPER, nominal};
use super::model::{BODY, Model};
use super::question::OnMassQuestion;
use super::record::Record;
use super::result::{
    CandidateErrors, LawFound, ModelErrors, OnMassParameter, OnMassResult, OnMassVerdict,
    RecordErrors, RoundErrors, Unexplained,
};
use super::search::{Search, noise_floor, refined, search};
use crate::error::IdentificationError;
use firmware_core::damper::{Damper, Nominal};
use measurement::body_record::Output;
use std::collections::BTreeMap;

/// A residual of this times the noise floor is above it.
const ABOVE: f64 = 1.5;

/// A body that was identified: the result and what is needed to show it.
#[derive(Debug, Clone)]
pub struct OnMass {
    /// What is written to `result.json`.
    pub result: OnMassResult,
    /// The damper of the kept model, if it has one.
    pub damper: Option<Damper>,
    pub(super) shown: Vec<Shown>,
}

/// A record with the motion of the first and of the kept model.
#[derive(Debug, Clone)]
pub(super) struct Shown {
    pub(super) record: Record,
    pub(super) held_out: bool,
    pub(super) first: Vec<f64>,
    pub(super) kept: Vec<f64>,
}

/// Identifies a body from records of the force on it and of its motion.
///
/// # Errors
/// No model follows the records, or the work is stopped before the first fit.
pub fn identify_on_mass(
    question: &OnMassQuestion,
    control: OnMassControl<'_>,
) -> Result<OnMass, IdentificationError> {
    let [mut train, mut holdout] = question.records();
    if train.is_empty() {
        return Err(IdentificationError::NothingToFit);
    }
    let given: Vec<(&'static LawInfo, Vec<f64>)> =
        question.datasheet.iter().map(|sheet| (&SERIES_DAMPER, start_of(sheet))).collect();
    let found = search(&mut train, &given, control);
    let Some(found) = found else {
        let stopped = control.is_stopped();
        return Err(if stopped {
            IdentificationError::Interrupted
        } else {
            IdentificationError::NoBody
        });
    };
    let on_holdout = on_holdout(&found, &train, &mut holdout);
    let range = train.iter().flat_map(|record| &record.motion);
    let range = range.fold(0.0, |most: f64, value| most.max(value.abs()));
    let (kept, within) = if holdout.is_empty() {
        (found.stages.len() - 1, 1.0)
    } else {
        holdout::kept(&holdout, &on_holdout, range)
    };
    (control.progress)([0, 0], "the final fit");
    let fit = refined(&found.stages[kept], &mut train, control);
    Ok(Report { question, found, kept, within, fit, on_holdout, train, holdout }.build(control))
}

/// A start for the parameters of the damper: no clearance and no relief are close to none.
fn start_of(sheet: &Nominal) -> Vec<f64> {
    let Nominal { ce_n_s_per_m, ke_n_per_m, clearance_2a_m, f_relief_n, c2_n_s_per_m } = *sheet;
    let relief = if f_relief_n.is_finite() { f_relief_n } else { 100.0 * ce_n_s_per_m };
    let clearance = clearance_2a_m.max(1e-3 * relief / ke_n_per_m);
    vec![ce_n_s_per_m, ke_n_per_m, clearance, relief, c2_n_s_per_m.max(1e-3 * ce_n_s_per_m)]
}

/// Every stage on every held-out record, on the clock of the search.
fn on_holdout(found: &Search, train: &[Record], holdout: &mut [Record]) -> Vec<Vec<HeldOut>> {
    let Some(first) = train.first() else { return Vec::new() };
    for record in holdout.iter_mut() {
        // The same length of a step, about.
        let wanted = record.step_s / first.simulation_step_s();
        record.set_substeps((libm::ceil(wanted) as usize).clamp(1, 40));
        record.set_warm_up(found.decay_per_s);
    }
    let stages = found.stages.iter().map(|stage| {
        let each = holdout.iter();
        each.map(|record| holdout::simulate(&stage.model, &stage.fit.values, record)).collect()
    });
    stages.collect()
}

/// Everything that the result is made from.
struct Report<'a> {
    question: &'a OnMassQuestion,
    found: Search,
    kept: usize,
    within: f64,
    fit: Fit,
    on_holdout: Vec<Vec<HeldOut>>,
    train: Vec<Record>,
    holdout: Vec<Record>,
}

impl Report<'_> {
    fn model(&self) -> &Model {
        &self.found.stages[self.kept].model
    }

    fn build(mut self, control: OnMassControl<'_>) -> OnMass {
        for record in &mut self.holdout {
            record.set_substeps(2 * record.substeps());
        }
        let kept_on_holdout: Vec<HeldOut> = self
            .holdout
            .iter()
            .map(|record| holdout::simulate(self.model(), &self.fit.values, record))
            .collect();
        let shown = self.shown(&kept_on_holdout);
        let floor = noise_floor(&self.train);
        let rms = rms_of(&self.fit, &self.train);
        let unexplained = floor.filter(|floor| rms > ABOVE * floor).map(|floor| {
            let rms = libm::sqrt(rms * rms - floor * floor);
            let unit = self.output().unit();
            let description = format!(
                "{rms:.2e} {unit} of the motion are above the noise, and no law of the catalogue \
                 describes them"
            );
            Unexplained { rms, description }
        });
        let std = deviations(self.model(), &self.fit, &self.train, control.stop);
        let laws = self.laws(std.as_deref());
        let named = laws.iter().any(|law| !law.given);
        let verdict = match (named, floor, &unexplained) {
            (false, None, _) => OnMassVerdict::NotJudged,
            (true, None, _) => OnMassVerdict::EffectsFoundResidualNotJudged,
            (false, Some(_), None) => OnMassVerdict::NoMissingEffect,
            (true, Some(_), None) => OnMassVerdict::EffectsFound,
            (false, Some(_), Some(_)) => OnMassVerdict::Unexplained,
            (true, Some(_), Some(_)) => OnMassVerdict::EffectsFoundAndUnexplained,
        };
        let body = BODY
            .iter()
            .enumerate()
            .map(|(n, (name, unit))| ((*name).to_owned(), self.parameter(n, unit, std.as_deref())));
        let result = OnMassResult {
            verdict,
            interrupted: self.found.interrupted,
            output: self.output().name(),
            unit: self.output().unit(),
            noise_floor: floor,
            noise_floor_method: self.noise_method(),
            unexplained,
            models: self.models(),
            kept: self.kept + 1,
            per_record: shown.iter().map(errors_of).collect(),
            body: body.collect(),
            laws,
            cut: self.cut().iter().map(|law| law.name.to_owned()).collect(),
            rounds: self.rounds(),
            notes: self.notes(),
        };
        OnMass { result, damper: self.damper(), shown }
    }

    fn output(&self) -> Output {
        self.train.first().map_or(Output::Displacement, |record| record.output)
    }

    fn shown(&self, kept_on_holdout: &[HeldOut]) -> Vec<Shown> {
        let first = self.found.stages.first();
        let train = self.train.iter().enumerate().map(|(n, record)| Shown {
            record: record.clone(),
            held_out: false,
            first: first.map_or_else(Vec::new, |stage| stage.fit.motion[n].clone()),
            kept: self.fit.motion[n].clone(),
        });
        let held = self.holdout.iter().enumerate().map(|(n, record)| Shown {
            record: record.clone(),
            held_out: true,
            first: self.on_holdout.first().map_or_else(Vec::new, |all| all[n].motion.clone()),
            kept: kept_on_holdout[n].motion.clone(),
        });
        train.chain(held).collect()
    }

    fn noise_method(&self) -> String {
        if noise_floor(&self.train).is_some() {
            "periods over each other, for the mean of the periods".to_owned()
        } else {
            "not known: not every training record has two periods".to_owned()
        }
    }

    fn models(&self) -> Vec<ModelErrors> {
        let stages = self.found.stages.iter().enumerate();
        let error = |(n, stage): (usize, &super::candidates::Judged)| ModelErrors {
            name: name_of(&stage.model, n),
            train_rms: if n == self.kept {
                rms_of(&self.fit, &self.train)
            } else {
                stage.rms(&self.train)
            },
            left_out_rms: stage.left_out_rms(&self.train),
            holdout_rms: (!self.holdout.is_empty())
                .then(|| holdout::rms_over(&self.holdout, &self.on_holdout[n]))
                .filter(|rms| rms.is_finite()),
        };
        stages.map(error).collect()
    }

    fn parameter(&self, number: usize, unit: &'static str, std: Option<&[f64]>) -> OnMassParameter {
        let std = std.and_then(|std| std.get(number).copied()).filter(|std| std.is_finite());
        OnMassParameter { value: self.fit.values[number], std, unit }
    }

    fn laws(&self, std: Option<&[f64]>) -> Vec<LawFound> {
        let given = self.found.stages.first().map_or(0, |first| first.model.laws.len());
        let mut place = BODY.len();
        let mut found = Vec::new();
        for (index, law) in self.model().laws.iter().enumerate() {
            let own = place..place + law.parameters.len();
            place = own.end;
            let parameters =
                law.parameters.iter().zip(own.clone()).map(|(row, number)| {
                    (row.name.to_owned(), self.parameter(number, row.unit, std))
                });
            let stage = (index + 1).checked_sub(given).filter(|stage| *stage > 0);
            let pair =
                stage.and_then(|n| self.found.stages.get(n).zip(self.found.stages.get(n - 1)));
            let round = stage.and_then(|n| self.found.rounds.get(n - 1));
            let other = |round: &super::search::Round| {
                round.alternatives.iter().map(|law| law.name).collect()
            };
            found.push(LawFound {
                name: law.name,
                equation: law.equation,
                given: stage.is_none(),
                gain: pair.map(|(with, without)| with.gain_on(without)),
                alternatives: round.map(other).unwrap_or_default(),
                remark: remark(law, &self.fit.values[own]),
                parameters: parameters.collect::<BTreeMap<_, _>>(),
            });
        }
        found
    }

    fn cut(&self) -> Vec<&'static LawInfo> {
        let all = self.found.stages.last().map_or(&[][..], |last| &last.model.laws);
        all[self.model().laws.len()..].to_vec()
    }

    fn rounds(&self) -> Vec<RoundErrors> {
        let rounds = self.found.rounds.iter().zip(&self.found.stages);
        let errors = rounds.map(|(round, base)| RoundErrors {
            accepted: round.accepted.map(|law| law.name),
            candidates: round
                .candidates
                .iter()
                .map(|one| {
                    let judged = one.judged.as_ref();
                    CandidateErrors {
                        name: one.law.name,
                        fitted_gain: one.fitted_gain,
                        train_rms: judged.map(|judged| judged.rms(&self.train)),
                        left_out_rms: judged.map(|judged| judged.left_out_rms(&self.train)),
                        gain: judged.map(|judged| judged.gain_on(base)),
                        better_parts: judged.map(|judged| judged.better_parts(base)),
                    }
                })
                .collect(),
        });
        errors.collect()
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = self.question.notes.clone();
        notes
            .extend(self.train.iter().chain(&self.holdout).flat_map(|record| record.notes.clone()));
        if self.holdout.is_empty() {
            notes.push("no record is held out: a law is judged on left-out parts alone".to_owned());
        } else if self.within < 0.995 {
            notes.push(format!(
                "{:.0} % of the held-out samples are within the range of the training records",
                100.0 * self.within
            ));
        }
        for law in self.cut() {
            notes.push(format!(
                "{} describes the training records alone: it makes the held-out error larger",
                law.name
            ));
        }
        notes.push(
            "the laws are those of a study of motion, without the passive bounds of a damper: \
             coefficients may have any sign"
                .to_owned(),
        );
        notes
    }

    fn damper(&self) -> Option<Damper> {
        let mut place = BODY.len();
        for law in &self.model().laws {
            let own = place..place + law.parameters.len();
            if law.kind == Kind::SeriesDamper {
                return Damper::new(nominal(&self.fit.values[own])?, &[]).ok();
            }
            place = own.end;
        }
        None
    }
}

/// Name of a stage.
fn name_of(model: &Model, stage: usize) -> String {
    let names: Vec<&str> = model.laws.iter().map(|law| law.name).collect();
    match (stage, names.as_slice()) {
        (_, []) => "linear body".to_owned(),
        (0, _) => format!("linear body with {}", names.join(", ")),
        (_, [.., last]) => format!("with {last}"),
    }
}

/// Errors of both models on a record.
fn errors_of(shown: &Shown) -> RecordErrors {
    let record = &shown.record;
    let skipped = if shown.held_out { holdout::run_in(record) } else { 0 };
    let rms = |motion: &[f64]| {
        let pairs = motion.iter().zip(&record.motion).skip(skipped);
        let rms = super::periods::rms(pairs.map(|(a, b)| a - b));
        rms.is_finite().then_some(rms)
    };
    RecordErrors {
        name: record.name.clone(),
        role: if shown.held_out { "holdout" } else { "train" },
        samples: record.len() - skipped,
        periods: record.periods,
        start: record.start.name(),
        inter_sample: record.inter_sample.name(),
        noise: record.noise,
        motion_rms: super::periods::rms(record.motion.iter().copied()),
        first_rms: rms(&shown.first),
        kept_rms: rms(&shown.kept),
    }
}

fn rms_of(fit: &Fit, records: &[Record]) -> f64 {
    libm::sqrt(fit.squares.iter().sum::<f64>() / super::fit::samples(records) as f64)
}

/// What the numbers of a law mean for a reader.
fn remark(law: &LawInfo, values: &[f64]) -> Option<String> {
    match (law.kind, values) {
        (Kind::BoucWen, [_, b1, b2]) if *b1 < b2.abs() => {
            let capacity = if b1 + b2 > 0.0 { "" } else { " and has no capacity" };
            Some(format!(
                "B1 < |B2|: this hysteresis is not passive{capacity}; it is valid within the range \
                 of the records only"
            ))
        }
        (Kind::BoucWen, [a, b1, b2]) => {
            Some(format!("passive; its force stays below {:.4e} N", a / (b1 + b2)))
        }
        (Kind::Stop, [ks, _]) => Some(if *ks > 0.0 {
            "a stop: the spring is stiffer beyond the gap".to_owned()
        } else {
            "the spring is softer beyond the gap".to_owned()
        }),
        _ => None,
    }
}
