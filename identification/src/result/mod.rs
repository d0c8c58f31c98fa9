//! The schema of `result.json`.

mod build;
mod sentence;

pub(crate) use build::{Parts, Simulated};

pub use crate::gate::{CheckedOn, Gate, Prefix};
use crate::residual::ResidualAnalysis;
use crate::residual::question::Answer;
pub(crate) use sentence::place;
use serde::Serialize;
use std::collections::BTreeMap;

/// The verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The refitted model explains all but noise.
    NoMissingEffect,
    /// Named effects explain the residual of the refitted model.
    EffectsFound,
    /// The residual has structure that nothing in the catalogue explains.
    Unexplained,
    /// Named effects explain a part; structure remains.
    EffectsFoundAndUnexplained,
    /// The records cannot show whether the residual of the refitted model is noise.
    NotJudged,
}

/// The result of an identification.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IdentifyResult {
    /// The verdict.
    pub verdict: Verdict,
    /// The search was interrupted: the effects are those that were accepted until then.
    pub interrupted: bool,
    /// rms of the noise, N, from cycles or tests that repeat; none where it is unknown.
    pub noise_floor_n: Option<f64>,
    /// A lower bound of it, N, where it is unknown and there is one.
    pub noise_at_least_n: Option<f64>,
    /// The method by which either was found, or the reason why it is unknown.
    pub noise_floor_method: &'static str,
    /// What was asked of the residual of the final model without a noise floor.
    pub questions: Questions,
    /// Why these records cannot show that nothing more is missing; none where they can, and where
    /// structure remains.
    pub not_judged: Option<String>,
    /// Errors of the three models.
    pub errors: Models<Option<Errors>>,
    /// Test by test.
    pub per_test: Vec<PerTest>,
    /// Nominal parameters of the final model.
    pub nominal: BTreeMap<String, NominalValue>,
    /// Effects that were found missing.
    pub effects: Vec<EffectFound>,
    /// How the effects were checked on tests that the search has not seen.
    pub gate: Gate,
    /// Effects that the residual resembles, and that did not survive that check.
    pub resembles: Vec<&'static str>,
    /// Effects that were looked for and not found.
    pub rejected: Vec<EffectRejected>,
    /// Effects that these records cannot show.
    pub not_testable: Vec<EffectNotTestable>,
    /// Structure that remains.
    pub unexplained: Option<UnexplainedPart>,
    /// Structure in the residual of the refitted nominal model.
    pub unexplained_before: Option<UnexplainedPart>,
    /// An empirical map of the residual, which is no physics; none where it was not asked for.
    pub empirical: Option<EmpiricalPart>,
    /// Notes for the reader: the choice of the hold-out, repairs of records, conversions.
    pub notes: Vec<String>,
}

/// Questions to the residual of the final model that need no noise floor.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Questions {
    /// Does it follow the motion?
    pub follows_motion: MotionAnswer,
    /// Does its size follow the force?
    pub size_follows_force: SizeAnswer,
}

/// Does the residual follow the motion?
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MotionAnswer {
    /// `yes`, `no` or `not_tested`.
    pub answer: &'static str,
    /// Why these records do not answer it.
    pub why: Option<String>,
    /// Share of the squared residual that a regression on the motion removes on left-out pieces.
    pub share: f64,
    /// Share of the pieces that it predicts better.
    pub improved: f64,
    /// Pieces that were left out in turn.
    pub pieces: usize,
    /// rms of what it removes, N.
    pub rms_n: f64,
}

/// Does the size of the residual follow the force?
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SizeAnswer {
    /// `yes`, `no` or `not_tested`.
    pub answer: &'static str,
    /// Why these records do not answer it.
    pub why: Option<String>,
    /// Rank correlation with the force.
    pub correlation: f64,
    /// Probability of that much by chance.
    pub p_value: f64,
}

impl Questions {
    pub(crate) fn of(residual: &ResidualAnalysis) -> Self {
        let name = |answer: &Answer| match answer {
            Answer::Yes => ("yes", None),
            Answer::No => ("no", None),
            Answer::NotTested(why) => ("not_tested", Some(why.clone())),
        };
        let ResidualAnalysis { motion, size, .. } = residual;
        let ((of_motion, why_motion), (of_size, why_size)) =
            (name(&motion.answer), name(&size.answer));
        Self {
            follows_motion: MotionAnswer {
                answer: of_motion,
                why: why_motion,
                share: motion.share,
                improved: motion.improved,
                pieces: motion.pieces,
                rms_n: motion.rms_n,
            },
            size_follows_force: SizeAnswer {
                answer: of_size,
                why: why_size,
                correlation: size.correlation,
                p_value: size.p_value,
            },
        }
    }
}

/// One value for each of the three models.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Models<T> {
    /// The maker's numbers.
    pub datasheet: T,
    /// The nominal model fitted to the training tests: the baseline.
    pub refitted: T,
    /// The same with the effects that were found.
    pub with_effects: T,
}

impl<T> Models<Option<T>> {
    /// The same for each model.
    pub(crate) fn map<'a, U>(&'a self, to: impl Fn(&'a Option<T>) -> U) -> Models<U> {
        Models {
            datasheet: to(&self.datasheet),
            refitted: to(&self.refitted),
            with_effects: to(&self.with_effects),
        }
    }

    /// The same for each model and that of `other`.
    pub(crate) fn zip_with<'a, U>(
        &'a self,
        other: &'a Self,
        to: impl Fn(Option<&'a T>, Option<&'a T>) -> U,
    ) -> Models<U> {
        Models {
            datasheet: to(self.datasheet.as_ref(), other.datasheet.as_ref()),
            refitted: to(self.refitted.as_ref(), other.refitted.as_ref()),
            with_effects: to(self.with_effects.as_ref(), other.with_effects.as_ref()),
        }
    }
}

/// Errors of free-run simulation over all samples but the run-in.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Errors {
    /// rms over the training tests, N.
    pub train_rmse_n: f64,
    /// rms over the tests held out, N.
    pub holdout_rmse_n: Option<f64>,
    /// The same over the rms of the measured force.
    pub train_nrmse: f64,
    /// The same over the rms of the measured force.
    pub holdout_nrmse: Option<f64>,
}

/// One test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PerTest {
    /// Its name.
    pub file: String,
    /// `train` or `holdout`.
    pub role: &'static str,
    /// Samples that errors count.
    pub samples: usize,
    /// Samples at the beginning that no error counts.
    pub run_in_samples: usize,
    /// rms error, N.
    pub rmse_n: Models<Option<f64>>,
    /// Largest simulated over largest measured force, less one.
    pub peak_force_error: Models<Option<f64>>,
    /// Simulated over measured work per cycle, less one; none without cycles.
    pub work_per_cycle_error: Models<Option<f64>>,
}

/// A nominal parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NominalValue {
    /// Identified value.
    pub value: f64,
    /// Its standard deviation; none where the records do not fix it.
    pub std: Option<f64>,
    /// Unit of both.
    pub unit: &'static str,
    /// Value of the datasheet.
    pub datasheet: Option<f64>,
}

/// A parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterValue {
    /// Identified value.
    pub value: f64,
    /// Its standard deviation; none where the records do not fix it.
    pub std: Option<f64>,
    /// Unit of both.
    pub unit: &'static str,
}

/// An effect that was found missing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectFound {
    /// Its name.
    pub name: &'static str,
    /// Its place in the damper.
    pub place: &'static str,
    /// Its equation.
    pub equation: &'static str,
    /// Its parameters.
    pub parameters: BTreeMap<&'static str, ParameterValue>,
    /// The evidence for it.
    pub evidence: EvidenceFound,
    /// Effects that these records cannot distinguish from it.
    pub alternatives: Vec<&'static str>,
    /// The test that would distinguish it from them.
    pub separating_test: Option<String>,
    /// Its direction, for effects that differ between extension and compression.
    pub direction: Option<&'static str>,
}

/// The evidence for an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EvidenceFound {
    /// Share of the squared error on left-out pieces that it removes.
    pub holdout_gain: f64,
    /// Share of those pieces that it improves or leaves unchanged.
    pub tests_improved: f64,
    /// Probability of such a finding by chance, all candidates counted.
    pub p_value: f64,
}

/// An effect that was looked for and not found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectRejected {
    /// Its name.
    pub name: &'static str,
    /// Why it was not accepted.
    pub why: String,
    /// Share of the squared error on left-out pieces; none if it was not fitted.
    pub holdout_gain: Option<f64>,
}

/// An effect that these records cannot show.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectNotTestable {
    /// Its name.
    pub name: &'static str,
    /// Why not.
    pub why: String,
    /// The test that would show it.
    pub test_that_would: String,
}

/// Structure that nothing in the catalogue explains.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnexplainedPart {
    /// Its rms, N.
    pub rms_n: f64,
    /// The coordinate over which it has a shape.
    pub coordinate: &'static str,
    /// In words.
    pub description: String,
}

/// A smooth map of the residual over one coordinate: empirical, never physical.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EmpiricalPart {
    /// It gains on tests that it has not seen, and is kept.
    pub kept: bool,
    /// The reason.
    pub why: String,
    /// Its coordinate; none where no map could be fitted, as for all fields below.
    pub coordinate: Option<&'static str>,
    /// Unit of the coordinate.
    pub unit: Option<&'static str>,
    /// Places of its knots.
    pub at: Option<Vec<f64>>,
    /// Force at each while the damper extends, N.
    pub upper_n: Option<Vec<f64>>,
    /// Force at each while it is compressed, N.
    pub lower_n: Option<Vec<f64>>,
    /// Share of the squared error on left-out pieces that it removes.
    pub holdout_gain: Option<f64>,
    /// Share of those pieces that it improves or leaves unchanged.
    pub tests_improved: Option<f64>,
    /// Errors of the model with effects and map.
    pub errors: Option<Errors>,
}
