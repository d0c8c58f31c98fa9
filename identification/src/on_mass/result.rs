//! The content of `result.json` of a body on a damper.

use serde::Serialize;
use std::collections::BTreeMap;

/// What the records show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OnMassVerdict {
    /// The linear body, with the damper of the datasheet, is at the noise floor.
    NoMissingEffect,
    /// With the named laws the body is at the noise floor.
    EffectsFound,
    /// No law of the catalogue explains the residual, which is above the noise floor.
    Unexplained,
    /// The named laws explain a part of it.
    EffectsFoundAndUnexplained,
    /// No law was found, and without a noise floor nothing says whether one is missing.
    NotJudged,
    /// Laws were found, and without a noise floor nothing says whether others are missing.
    EffectsFoundResidualNotJudged,
}

/// The whole result; errors and noise are rms values in `unit`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OnMassResult {
    /// The verdict.
    pub verdict: OnMassVerdict,
    /// The search was stopped early.
    pub interrupted: bool,
    /// What is predicted: displacement or acceleration.
    pub output: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Noise of the training records, periods averaged; null where it is not known.
    pub noise_floor: Option<f64>,
    /// Where it comes from, or why it is not known.
    pub noise_floor_method: String,
    /// Residual above the noise floor.
    pub unexplained: Option<Unexplained>,
    /// The first model, and with one law more each, as fitted.
    pub models: Vec<ModelErrors>,
    /// Number of them, from the beginning, up to the one that is kept.
    pub kept: usize,
    /// Errors record by record.
    pub per_record: Vec<RecordErrors>,
    /// Mass, spring and dashpot of the kept model.
    pub body: BTreeMap<String, OnMassParameter>,
    /// Laws of the kept model.
    pub laws: Vec<LawFound>,
    /// Laws that describe the training records and not those held out.
    pub cut: Vec<String>,
    /// All candidates, round by round.
    pub rounds: Vec<RoundErrors>,
    /// What the reader should know.
    pub notes: Vec<String>,
}

/// Residual that no law explains.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unexplained {
    /// Its size without the noise.
    pub rms: f64,
    /// In words.
    pub description: String,
}

/// Errors of one model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelErrors {
    /// Name of the model.
    pub name: String,
    /// On the training records.
    pub train_rms: f64,
    /// On parts of them that it was not fitted to.
    pub left_out_rms: f64,
    /// On the records held out.
    pub holdout_rms: Option<f64>,
}

/// Errors on one record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordErrors {
    /// Name of the test.
    pub name: String,
    /// `train` or `holdout`.
    pub role: &'static str,
    /// Samples that are compared.
    pub samples: usize,
    /// Periods in the mean.
    pub periods: usize,
    /// Motion before the first sample.
    pub start: &'static str,
    /// Force between the samples.
    pub inter_sample: &'static str,
    /// Noise of a single period.
    pub noise: Option<f64>,
    /// rms of the measured motion.
    pub motion_rms: f64,
    /// Error of the first model.
    pub first_rms: Option<f64>,
    /// Error of the kept model.
    pub kept_rms: Option<f64>,
}

/// A parameter with its uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OnMassParameter {
    /// Value.
    pub value: f64,
    /// One standard deviation, if the residual is white; null where the records do not fix it.
    pub std: Option<f64>,
    /// Unit.
    pub unit: &'static str,
}

/// A law of the kept model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LawFound {
    /// Its name.
    pub name: &'static str,
    /// Its force.
    pub equation: &'static str,
    /// It was part of the model from the beginning.
    pub given: bool,
    /// Share of the squared error on left-out parts that it removes.
    pub gain: Option<f64>,
    /// Laws that describe the left-out parts as well.
    pub alternatives: Vec<&'static str>,
    /// What its numbers mean.
    pub remark: Option<String>,
    /// Its numbers.
    pub parameters: BTreeMap<String, OnMassParameter>,
}

/// A round of the search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RoundErrors {
    /// The law that was accepted.
    pub accepted: Option<&'static str>,
    /// Every law that was tried.
    pub candidates: Vec<CandidateErrors>,
}

/// A candidate of a round.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CandidateErrors {
    /// Its name.
    pub name: &'static str,
    /// Share of the squared training error that it removes; null where no start led to a motion.
    pub fitted_gain: Option<f64>,
    /// rms error on the training records; null where the gain was too small to go on.
    pub train_rms: Option<f64>,
    /// rms error on left-out parts.
    pub left_out_rms: Option<f64>,
    /// Share of the squared error on left-out parts that it removes.
    pub gain: Option<f64>,
    /// Parts of six that it predicts better.
    pub better_parts: Option<usize>,
}

impl OnMassResult {
    /// The verdict in one line.
    pub fn sentence(&self) -> String {
        let found = self.laws.iter().filter(|law| !law.given);
        let names = found.map(|law| law.name).collect::<Vec<_>>().join(", ");
        match self.verdict {
            OnMassVerdict::NoMissingEffect => "no effect is missing".to_owned(),
            OnMassVerdict::EffectsFound => format!("missing: {names}"),
            OnMassVerdict::Unexplained => {
                "unexplained: no law of the catalogue describes the residual".to_owned()
            }
            OnMassVerdict::EffectsFoundAndUnexplained => {
                format!("missing: {names}; a part of the residual is unexplained")
            }
            OnMassVerdict::NotJudged => {
                "not judged: no law found, and the noise floor is not known".to_owned()
            }
            OnMassVerdict::EffectsFoundResidualNotJudged => {
                format!(
                    "missing: {names}; the residual is not judged: the noise floor is not known"
                )
            }
        }
    }
}
