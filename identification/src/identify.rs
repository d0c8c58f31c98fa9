//! The whole identification: from records to three models and the findings about them.

use super::budget::MOST_PASSES;
use super::canonical::with_idle_at_usual;
use super::cautions;
use super::control::Control;
use super::data_rate;
use super::empirical::{Empirical, FittedMap, empirical};
use super::error::IdentificationError;
use super::finding::Findings;
use super::fit::{Effort, Fit, fit};
use super::gate::{CheckedOn, Gate, gate};
use super::grey_box::{GreyBox, vector_of};
use super::judged::Judged;
use super::question::Question;
use super::residual::ResidualAnalysis;
use super::result::{IdentifyResult, Models, Parts, Simulated};
use super::search::search;
use super::start::nominal_fit;
use super::test_set::TestSet;
use firmware_core::damper::{Damper, Nominal};

/// An identification: everything that the result, the predictions and the report are made from.
#[derive(Debug, Clone)]
pub struct Identification {
    /// The tests that were fitted.
    pub train: TestSet,
    /// The tests that no fit has seen.
    pub holdout: TestSet,
    /// The three models on the training tests.
    pub on_train: Models<Option<Fit>>,
    /// The three models on the tests held out.
    pub on_holdout: Models<Option<Fit>>,
    /// What the search found.
    pub findings: Findings,
    /// The damper with every effect that was found.
    pub damper: Damper,
    /// The residual before any effect was added.
    pub residual_before: ResidualAnalysis,
    /// The residual with every effect that was found.
    pub residual_after: ResidualAnalysis,
    /// The empirical map, kept or not; none where it was not asked for.
    pub empirical: Option<Empirical>,
    /// The result as it is written.
    pub result: IdentifyResult,
}

impl Identification {
    /// The empirical map, if it is kept.
    pub(crate) fn kept_map(&self) -> Option<&FittedMap> {
        self.empirical.as_ref().and_then(Empirical::kept)
    }
}

/// Finds the effects that the nominal model lacks. Once the work is stopped, it ends with the
/// effects that were accepted so far.
///
/// # Errors
/// There is nothing to fit, nothing fits, or the work is stopped before the nominal model is
/// fitted.
pub fn identify(
    question: Question,
    control: Control<'_>,
) -> Result<Identification, IdentificationError> {
    let Question { train, holdout, datasheet, empirical: wanted, thorough, notes } = question;
    let (train, holdout) = (TestSet::new(train), TestSet::new(holdout));
    let (factor, steps_s) = data_rate::enough(&train);
    let searched = train.thinned(factor, &steps_s);
    let findings = search_from_nominal(&searched, datasheet.as_ref(), thorough, control)?;
    let (findings, gate) = gate(findings, (&searched, &holdout), control);
    let findings = on_all_samples(findings, &train, control)?;
    control.report("residual");
    let damper = damper_of(&findings)?;
    let models = ThreeModels::new(&train, datasheet.as_ref(), &findings);
    let (on_train, on_holdout) = (models.on_train(&train), models.on_holdout(&holdout));
    let (residual_before, residual_after) = residuals(&models, &train, &on_holdout, &holdout)?;
    let empirical = wanted.then(|| {
        let on_holdout = on_holdout.with_effects.as_ref();
        map_of_residual(&findings, &residual_after, on_holdout, (&train, &holdout), control)
    });
    let remarks = residual_after.remark().into_iter().chain(checked(&gate));
    let cautions = cautions::all(&findings, on_train.datasheet.as_ref(), (&train, &holdout));
    let result = IdentifyResult::new(Parts {
        train: Simulated { tests: &train, models: &on_train },
        holdout: Simulated { tests: &holdout, models: &on_holdout },
        datasheet: datasheet.as_ref(),
        findings: &findings,
        gate: &gate,
        residual_before: &residual_before,
        residual_after: &residual_after,
        empirical: empirical.as_ref(),
        notes: notes.into_iter().chain(cautions).chain(remarks).collect(),
    });
    Ok(Identification {
        train,
        holdout,
        on_train,
        on_holdout,
        findings,
        damper,
        residual_before,
        residual_after,
        empirical,
        result,
    })
}

/// What the gate has checked, and on what.
fn checked(gate: &Gate) -> Option<String> {
    let on = match gate.checked_on {
        CheckedOn::Nothing => return None,
        CheckedOn::HoldoutInRange => {
            "on the tests held out, within the range of the training tests"
        }
        CheckedOn::TrainingLeftOut => {
            "on the training tests, each left out in turn: too few of the held-out samples are \
             within the range of the training tests"
        }
    };
    Some(if gate.cut.is_empty() {
        format!("the effects were checked {on}")
    } else {
        format!(
            "the effects were checked {on}, and {} cut: the errors on the tests held out are those \
             of a model that was checked on them, not predictions",
            gate.cut.join(", ")
        )
    })
}

/// Fits the nominal damper and searches for the effects that it lacks.
fn search_from_nominal(
    train: &TestSet,
    datasheet: Option<&Nominal>,
    thorough: bool,
    control: Control<'_>,
) -> Result<Findings, IdentificationError> {
    if train.counted_samples() < 2 {
        return Err(IdentificationError::NothingToFit);
    }
    let failed = || {
        if control.is_stopped() {
            IdentificationError::Interrupted
        } else {
            IdentificationError::NoFit
        }
    };
    control.report("nominal damper");
    let given = datasheet.map(vector_of);
    let nominal = nominal_fit(train, given.as_deref(), control).ok_or_else(failed)?;
    let most_passes = if thorough { f64::INFINITY } else { MOST_PASSES };
    search(nominal, train, most_passes, control).ok_or_else(failed)
}

/// The findings with both models fitted to all samples. Where the work is stopped, they are judged
/// as they are.
fn on_all_samples(
    findings: Findings,
    train: &TestSet,
    control: Control<'_>,
) -> Result<Findings, IdentificationError> {
    control.report("fit to all samples");
    let whole = |judged: &Judged| -> Result<Judged, IdentificationError> {
        let Fit { model, values, .. } = judged.fit();
        let fitted = fit(model, values, train, Effort::FULL, control);
        let values = fitted.as_ref().map_or(values, |fitted| &fitted.values);
        // The starts of the dashpots as everyone finds them who simulates the model.
        let fitted = Fit::evaluate(model, values, train);
        let judged = fitted.and_then(|fit| Judged::new(fit, train));
        let judged = judged.ok_or(IdentificationError::NoFit)?;
        Ok(with_idle_at_usual(judged, train))
    };
    let refitted = whole(&findings.refitted)?;
    let with_effects = if findings.accepted.is_empty() {
        refitted.clone()
    } else {
        whole(&findings.with_effects)?
    };
    Ok(Findings { refitted, with_effects, ..findings })
}

fn damper_of(findings: &Findings) -> Result<Damper, IdentificationError> {
    let fit = findings.with_effects.fit();
    fit.model.damper(&fit.values).ok_or(IdentificationError::NoFit)
}

/// The maker's model, the refitted nominal model and the model with effects.
struct ThreeModels<'a> {
    datasheet: Option<(GreyBox, Vec<f64>)>,
    refitted: &'a Fit,
    with_effects: &'a Fit,
}

impl<'a> ThreeModels<'a> {
    fn new(train: &TestSet, datasheet: Option<&Nominal>, findings: &'a Findings) -> Self {
        Self {
            datasheet: datasheet.map(|sheet| (GreyBox::nominal(&train.scale), vector_of(sheet))),
            refitted: findings.refitted.fit(),
            with_effects: findings.with_effects.fit(),
        }
    }

    fn of_datasheet(&self, tests: &TestSet) -> Option<Fit> {
        let (model, values) = self.datasheet.as_ref()?;
        Fit::evaluate(model, values, tests)
    }

    fn on_train(&self, train: &TestSet) -> Models<Option<Fit>> {
        Models {
            datasheet: self.of_datasheet(train),
            refitted: Some(self.refitted.clone()),
            with_effects: Some(self.with_effects.clone()),
        }
    }

    fn on_holdout(&self, holdout: &TestSet) -> Models<Option<Fit>> {
        Models {
            datasheet: self.of_datasheet(holdout),
            refitted: self.refitted.on(holdout),
            with_effects: self.with_effects.on(holdout),
        }
    }
}

/// The residuals on the training tests, before and after effects were added. Where the last one is
/// noise, but the tests held out are not followed, that is what remains unexplained.
fn residuals(
    models: &ThreeModels<'_>,
    train: &TestSet,
    on_holdout: &Models<Option<Fit>>,
    holdout: &TestSet,
) -> Result<(ResidualAnalysis, ResidualAnalysis), IdentificationError> {
    let analysed = |fit: &Fit| ResidualAnalysis::new(fit, train).ok_or(IdentificationError::NoFit);
    let (before, after) = (analysed(models.refitted)?, analysed(models.with_effects)?);
    let held_out = on_holdout.with_effects.as_ref();
    let after = after.or_unexplained(|| {
        cautions::not_followed((models.with_effects, train), (held_out?, holdout))
    });
    Ok((before, after))
}

fn map_of_residual(
    findings: &Findings,
    residual: &ResidualAnalysis,
    on_holdout: Option<&Fit>,
    tests: (&TestSet, &TestSet),
    control: Control<'_>,
) -> Empirical {
    if control.is_stopped() {
        return Empirical::interrupted();
    }
    control.report("empirical map");
    empirical(&findings.with_effects, residual, on_holdout, tests)
}
