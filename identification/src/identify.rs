//! The whole identification: records in, three models and the story of what was found out.

use super::cautions::{extrapolations, not_followed, on_bounds, other_unit};
use super::empirical::{Empirical, FittedMap, empirical};
use super::fit::Fit;
use super::grey_box::{GreyBox, NOMINAL, vector_of};
use super::left_over::{LeftOver, Unexplained};
use super::result::{
    EffectFound, EffectNotTestable, EffectRejected, EmpiricalPart, Errors, EvidenceFound,
    IdentifyResult, Models, NominalValue, ParameterValue, PerTest, UnexplainedPart, Verdict,
};
use super::search::{Found, MOST_PASSES, Progress, search};
use super::start::nominal_fit;
use super::tests_at_hand::{Test, TestsAtHand};
use super::uncertainty::uncertainty;
use firmware_core::damper::effects::CATALOGUE;
use firmware_core::damper::{Damper, MapKnot, Nominal};
use measurement::Measurement;

/// What an identification starts from.
#[derive(Debug, Clone)]
pub struct Question {
    /// Records to fit.
    pub train: Vec<Measurement>,
    /// Records that no fit sees.
    pub holdout: Vec<Measurement>,
    /// The maker's numbers, if there are any.
    pub datasheet: Option<Nominal>,
    /// A smooth map, which is no physics, is wanted on what is left.
    pub empirical: bool,
    /// The search goes on past its usual limit of work.
    pub thorough: bool,
    /// What the reader should know of all this.
    pub notes: Vec<String>,
}

/// An identification: everything that the result, the predictions and the report are made from.
#[derive(Debug, Clone)]
pub struct Identification {
    /// The tests that were fitted.
    pub train: TestsAtHand,
    /// The tests that no fit has seen.
    pub holdout: TestsAtHand,
    /// The three models on the training tests.
    pub on_train: Models<Option<Fit>>,
    /// The three models on the tests held out.
    pub on_holdout: Models<Option<Fit>>,
    /// What the search found.
    pub found: Found,
    /// The residual before any effect was added.
    pub left_before: LeftOver,
    /// The residual with all effects that were found.
    pub left_after: LeftOver,
    /// What came of the wish for an empirical map; none where nobody had it.
    pub empirical: Option<Empirical>,
    /// The result as it is written.
    pub result: IdentifyResult,
}

/// Why there is no identification.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IdentifyError {
    /// No test has samples beyond its run-in.
    NothingToFit,
    /// No damper follows the records at all.
    NoFit,
}

impl std::fmt::Display for IdentifyError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NothingToFit => write!(f, "no training test has samples beyond its run-in"),
            Self::NoFit => write!(f, "no damper follows these records at all"),
        }
    }
}

impl std::error::Error for IdentifyError {}

/// Finds what the nominal model lacks. `progress` is told what is being done.
///
/// # Errors
/// Nothing to fit, or nothing fits.
pub fn identify(
    question: Question,
    progress: Progress<'_>,
) -> Result<Identification, IdentifyError> {
    let Question { train, holdout, datasheet, empirical: wanted, thorough, mut notes } = question;
    let train = TestsAtHand::new(train);
    let holdout = TestsAtHand::new(holdout);
    if train.counted_samples() < 2 {
        return Err(IdentifyError::NothingToFit);
    }
    if !train.whole_tests {
        let (tests, pieces) = (train.tests.len(), train.pieces.len());
        notes.push(format!(
            "training tests: {tests}, fewer than four: folds leave out {pieces} runs of whole cycles \
             with a guard gap between them, and not whole tests"
        ));
    }
    progress("the nominal damper");
    let given = datasheet.as_ref().map(vector_of);
    let nominal = nominal_fit(&train, given.as_deref()).ok_or(IdentifyError::NoFit)?;
    let most_passes = if thorough { f64::INFINITY } else { MOST_PASSES };
    let found = search(nominal, &train, most_passes, progress).ok_or(IdentifyError::NoFit)?;
    if found.cut_short {
        notes.push(format!(
            "the search ended at its limit of work, {MOST_PASSES} passes of a model over the training tests: \
             --thorough goes on"
        ));
    }
    progress("what is left");
    let (refitted, with_effects) = (&found.refitted.standing.fit, &found.with_effects.standing.fit);
    let sheet =
        |tests: &TestsAtHand| Fit::of(&GreyBox::nominal(&train.scale), given.as_deref()?, tests);
    let on_train = Models {
        datasheet: sheet(&train),
        refitted: Some(refitted.clone()),
        with_effects: Some(with_effects.clone()),
    };
    let on_holdout = Models {
        datasheet: sheet(&holdout),
        refitted: of(refitted, &holdout),
        with_effects: of(with_effects, &holdout),
    };
    notes.extend(other_unit(on_train.datasheet.as_ref(), &train));
    notes.extend(extrapolations(&train, &holdout));
    notes.extend(on_bounds(with_effects, &train));
    notes.extend(found.accepted.iter().filter_map(|first| {
        let second = found.accepted.iter().find(|other| Some(other.name) == first.together_with)?;
        Some(format!(
            "{} and {} were accepted together, neither of them alone: the evidence of {} is that of both",
            first.name, second.name, first.name
        ))
    }));
    let left = |fit: &Fit| LeftOver::of(fit, &train).ok_or(IdentifyError::NoFit);
    let (left_before, mut left_after) = (left(refitted)?, left(with_effects)?);
    if left_after.unexplained.is_none()
        && let Some(held_out) = &on_holdout.with_effects
    {
        left_after.unexplained = not_followed((with_effects, &train), (held_out, &holdout));
    }
    let tried = wanted.then(|| {
        progress("an empirical map");
        let on_holdout = on_holdout.with_effects.as_ref();
        empirical(&found.with_effects, &left_after, on_holdout, (&train, &holdout))
    });
    let deviations = uncertainty(&found.with_effects.standing, &train);
    let mut identification = Identification {
        result: IdentifyResult {
            verdict: verdict(&found, &left_after),
            noise_floor_n: left_after.noise_floor_n,
            noise_floor_method: left_after.noise_floor_method.to_owned(),
            errors: Models { datasheet: None, refitted: None, with_effects: None },
            per_test: Vec::new(),
            nominal: nominal_values(&found, &deviations, datasheet.as_ref()),
            effects: effects_found(&found, &deviations, &train),
            rejected: rejected(&found),
            not_testable: not_testable(&found, &train),
            unexplained: left_after.unexplained.as_ref().map(unexplained),
            unexplained_before: left_before.unexplained.as_ref().map(unexplained),
            empirical: None,
            notes,
        },
        train,
        holdout,
        on_train,
        on_holdout,
        found,
        left_before,
        left_after,
        empirical: tried,
    };
    identification.result.empirical = identification.empirical.as_ref().map(|tried| {
        let errors = |fitted: &FittedMap| {
            identification.errors_of(&fitted.on_train, Some(&fitted.on_holdout))
        };
        empirical_part(tried, tried.fitted.as_ref().and_then(errors))
    });
    identification.result.errors = identification.errors();
    identification.result.per_test = identification.per_test();
    Ok(identification)
}

impl Identification {
    /// The damper with everything that was found.
    pub fn damper(&self) -> Option<Damper> {
        let fit = &self.found.with_effects.standing.fit;
        fit.model.damper(&fit.values)
    }

    fn errors(&self) -> Models<Option<Errors>> {
        self.on_train.zip_with(&self.on_holdout, |train, holdout| {
            self.errors_of(&train?.force_n, holdout.map(|fit| fit.force_n.as_slice()))
        })
    }

    /// Errors of simulated forces on the training tests and on those held out.
    fn errors_of(&self, train_n: &[Vec<f64>], holdout_n: Option<&[Vec<f64>]>) -> Option<Errors> {
        let train = self.train.rmse_n(train_n)?;
        let held = holdout_n.and_then(|force_n| self.holdout.rmse_n(force_n));
        Some(Errors {
            train_rmse_n: train,
            holdout_rmse_n: held,
            train_nrmse: train / self.train.measured_rms_n()?,
            holdout_nrmse: held.zip(self.holdout.measured_rms_n()).map(|(held, rms)| held / rms),
        })
    }

    fn per_test(&self) -> Vec<PerTest> {
        let rows = |tests: &TestsAtHand, models: &Models<Option<Fit>>, role| {
            let each = tests.tests.iter().enumerate();
            each.map(|(index, test)| {
                let forces =
                    models.map(|fit| fit.as_ref().map(|fit| fit.force_n[index].as_slice()));
                PerTest {
                    file: test.record.name.clone(),
                    role,
                    samples: test.counted().len(),
                    run_in_samples: test.record.run_in,
                    rmse_n: forces.map(|force| force.map(|force| test.rmse_n(force))),
                    peak_force_error: forces.map(|force| peak_error(test, (*force)?)),
                    work_per_cycle_error: forces.map(|force| work_error(test, (*force)?)),
                }
            })
            .collect::<Vec<_>>()
        };
        let mut all = rows(&self.train, &self.on_train, "train");
        all.extend(rows(&self.holdout, &self.on_holdout, "holdout"));
        all
    }
}

impl<T> Models<Option<T>> {
    /// The same for each model.
    pub fn map<'a, U>(&'a self, to: impl Fn(&'a Option<T>) -> U) -> Models<U> {
        Models {
            datasheet: to(&self.datasheet),
            refitted: to(&self.refitted),
            with_effects: to(&self.with_effects),
        }
    }

    fn zip_with<'a, U>(
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

/// A fitted model on other tests.
fn of(fit: &Fit, tests: &TestsAtHand) -> Option<Fit> {
    Fit::of(&fit.model, &fit.values, tests)
}

fn verdict(found: &Found, left: &LeftOver) -> Verdict {
    match (found.accepted.is_empty(), left.unexplained.is_none()) {
        (true, true) => Verdict::NoMissingEffect,
        (false, true) => Verdict::EffectsFound,
        (true, false) => Verdict::Unexplained,
        (false, false) => Verdict::EffectsFoundAndUnexplained,
    }
}

fn peak_error(test: &Test, force_n: &[f64]) -> Option<f64> {
    let peak = |values: &[f64]| values[test.counted()].iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let measured = peak(&test.record.force_n);
    (measured > 0.0).then(|| peak(force_n) / measured - 1.0)
}

fn work_error(test: &Test, force_n: &[f64]) -> Option<f64> {
    let record = &test.record;
    let mut whole = record.cycles.iter().copied().filter(|at| *at >= record.run_in);
    let (start, end) = (whole.next()?, whole.next_back()?);
    let work = |force: &[f64]| -> f64 {
        let end = end.min(force.len() - 1);
        (start..end)
            .map(|i| {
                let travel = record.displacement_m[i + 1] - record.displacement_m[i];
                0.5 * (force[i] + force[i + 1]) * travel
            })
            .sum()
    };
    let measured = work(&record.force_n);
    (measured > 0.0).then(|| work(force_n) / measured - 1.0)
}

fn nominal_values(
    found: &Found,
    deviations: &[Option<f64>],
    datasheet: Option<&Nominal>,
) -> std::collections::BTreeMap<String, NominalValue> {
    let standing = &found.with_effects.standing;
    let given = datasheet.map(vector_of);
    NOMINAL
        .iter()
        .enumerate()
        .map(|(index, (name, unit))| {
            let value = NominalValue {
                value: standing.fit.values[index],
                std: deviations[index],
                unit,
                datasheet: given.as_ref().map(|given| given[index]),
            };
            ((*name).to_owned(), value)
        })
        .collect()
}

fn effects_found(
    found: &Found,
    deviations: &[Option<f64>],
    train: &TestsAtHand,
) -> Vec<EffectFound> {
    let standing = &found.with_effects.standing;
    let declared = train.tests.iter().all(|test| test.record.direction_declared);
    let turned = train.tests.iter().any(|test| test.record.force_turned);
    found
        .accepted
        .iter()
        .zip(&standing.fit.model.effects)
        .enumerate()
        .map(|(index, (accepted, info))| {
            let rows = info.parameters.iter().zip(standing.fit.model.range_of(index));
            let parameters = rows
                .map(|(row, k)| {
                    let (value, std) = (standing.fit.values[k], deviations[k]);
                    (row.name, ParameterValue { value, std, unit: row.unit.symbol() })
                })
                .collect();
            let direction = info.directional.then_some(match (declared, turned) {
                (true, false) => "positive is extension, as declared",
                (true, true) => {
                    "positive is extension if the displacement was right, to which the force was turned"
                }
                (false, _) => "not declared: positive is side A, negative side B",
            });
            EffectFound {
                name: info.name,
                place: info.place.name(),
                equation: info.equation,
                parameters,
                evidence: EvidenceFound {
                    holdout_gain: accepted.evidence.holdout_gain,
                    tests_improved: accepted.evidence.improved,
                    p_value: accepted.evidence.p_value,
                },
                alternatives: accepted.alternatives.clone(),
                separating_test: (!accepted.alternatives.is_empty())
                    .then(|| separating_test(info.name, &accepted.alternatives)),
                direction,
            }
        })
        .collect()
}

/// The tests that show each of a group.
fn separating_test(name: &str, alternatives: &[&str]) -> String {
    let tests = std::iter::once(name).chain(alternatives.iter().copied()).filter_map(|name| {
        let info = CATALOGUE.iter().find(|info| info.name == name)?;
        Some(format!("{name}: {}", info.shown_by))
    });
    tests.collect::<Vec<_>>().join(" ")
}

fn rejected(found: &Found) -> Vec<EffectRejected> {
    let each = found.rejected.iter().map(|rejected| EffectRejected {
        name: rejected.name,
        why: rejected.why.clone(),
        holdout_gain: rejected.holdout_gain,
    });
    each.collect()
}

fn not_testable(found: &Found, train: &TestsAtHand) -> Vec<EffectNotTestable> {
    let mut all: Vec<EffectNotTestable> = found
        .not_testable
        .iter()
        .map(|hidden| EffectNotTestable {
            name: hidden.name,
            why: hidden.why.clone(),
            test_that_would: hidden.test_that_would.to_owned(),
        })
        .collect();
    let rate_hz = super::candidate::rate_hz(train);
    let kept = |name: &str| super::candidate::destroyed(train, name).is_none();
    let too_fast = CATALOGUE.iter().filter(|info| info.needs_rate_hz > rate_hz);
    for info in too_fast.filter(|info| kept(info.name)) {
        let needs = info.needs_rate_hz;
        let why = format!("it needs {needs} samples per second, the records have {rate_hz:.0}");
        let test_that_would = info.shown_by.to_owned();
        all.push(EffectNotTestable { name: info.name, why, test_that_would });
    }
    for info in CATALOGUE {
        if let Some(done) = super::candidate::destroyed(train, info.name) {
            let why = format!("the processing of the records has destroyed its traces: {done}");
            let test_that_would = format!("The unprocessed records. {}", info.shown_by);
            all.push(EffectNotTestable { name: info.name, why, test_that_would });
        }
    }
    all
}

fn unexplained(part: &Unexplained) -> UnexplainedPart {
    UnexplainedPart {
        rms_n: part.rms_n,
        coordinate: part.coordinate,
        description: part.description.clone(),
    }
}

fn empirical_part(tried: &Empirical, errors: Option<Errors>) -> EmpiricalPart {
    let fitted = tried.fitted.as_ref();
    let map = fitted.map(|fitted| &fitted.map);
    let all = |of: fn(&MapKnot) -> f64| map.map(|map| map.knots().iter().map(of).collect());
    EmpiricalPart {
        kept: tried.kept,
        why: tried.why.clone(),
        coordinate: map.map(|map| map.coordinate().name()),
        unit: map.map(|map| map.coordinate().unit()),
        at: all(|knot| knot.at),
        upper_n: all(|knot| knot.upper_n),
        lower_n: all(|knot| knot.lower_n),
        holdout_gain: fitted.map(|fitted| fitted.holdout_gain),
        tests_improved: fitted.map(|fitted| fitted.tests_improved),
        errors,
    }
}
