//! The result of an identification, built from its parts.

use super::{
    EffectFound, EffectNotTestable, EffectRejected, EmpiricalPart, Errors, EvidenceFound,
    IdentifyResult, Models, NominalValue, ParameterValue, PerTest, Questions, UnexplainedPart,
    Verdict,
};
use crate::empirical::{Empirical, FittedMap};
use crate::finding::Findings;
use crate::fit::Fit;
use crate::gate::Gate;
use crate::grey_box::{NOMINAL, vector_of};
use crate::residual::question::Answer;
use crate::residual::{ResidualAnalysis, Unexplained};
use crate::test_set::{Test, TestSet};
use crate::uncertainty::uncertainty;
use firmware_core::damper::effects::CATALOGUE;
use firmware_core::damper::{MapKnot, Nominal};
use std::collections::BTreeMap;

/// Everything that a result is built from.
pub(crate) struct Parts<'a> {
    pub(crate) train: Simulated<'a>,
    pub(crate) holdout: Simulated<'a>,
    pub(crate) datasheet: Option<&'a Nominal>,
    pub(crate) findings: &'a Findings,
    pub(crate) gate: &'a Gate,
    pub(crate) residual_before: &'a ResidualAnalysis,
    pub(crate) residual_after: &'a ResidualAnalysis,
    pub(crate) empirical: Option<&'a Empirical>,
    pub(crate) notes: Vec<String>,
}

/// Tests and the three models simulated on them.
#[derive(Clone, Copy)]
pub(crate) struct Simulated<'a> {
    pub(crate) tests: &'a TestSet,
    pub(crate) models: &'a Models<Option<Fit>>,
}

impl IdentifyResult {
    pub(crate) fn new(parts: Parts<'_>) -> Self {
        let Parts { train, holdout, datasheet, findings, .. } = parts;
        let deviations = uncertainty(&findings.with_effects.linearised, train.tests);
        let noise = &parts.residual_after.noise;
        Self {
            verdict: verdict(findings, parts.residual_after),
            interrupted: findings.interrupted,
            noise_floor_n: noise.floor_n,
            noise_at_least_n: noise.at_least_n,
            noise_floor_method: noise.method,
            questions: Questions::of(parts.residual_after),
            not_judged: not_judged(parts.residual_after),
            errors: errors_of_models(train, holdout),
            per_test: per_test(train, "train").chain(per_test(holdout, "holdout")).collect(),
            nominal: nominal_values(findings, &deviations, datasheet),
            effects: effects_found(findings, &deviations, train.tests),
            gate: parts.gate.clone(),
            resembles: resembles(parts.gate, parts.residual_after),
            rejected: rejected(findings),
            not_testable: not_testable(findings, train.tests),
            unexplained: parts.residual_after.unexplained.as_ref().map(unexplained),
            unexplained_before: parts.residual_before.unexplained.as_ref().map(unexplained),
            empirical: parts.empirical.map(|map| empirical_part(map, train.tests, holdout.tests)),
            notes: parts.notes,
        }
    }
}

fn verdict(findings: &Findings, residual: &ResidualAnalysis) -> Verdict {
    match (findings.accepted.is_empty(), residual.unexplained.is_none()) {
        (true, true) if not_judged(residual).is_some() => Verdict::NotJudged,
        (true, true) => Verdict::NoMissingEffect,
        (false, true) => Verdict::EffectsFound,
        (true, false) => Verdict::Unexplained,
        (false, false) => Verdict::EffectsFoundAndUnexplained,
    }
}

/// Why a residual without structure cannot be called noise.
fn not_judged(residual: &ResidualAnalysis) -> Option<String> {
    if residual.unexplained.is_some() { None } else { residual.not_judged() }
}

/// Effects that were cut, where more of the force follows from the motion than the model knows.
fn resembles(gate: &Gate, residual: &ResidualAnalysis) -> Vec<&'static str> {
    if residual.motion.answer == Answer::Yes { gate.cut.clone() } else { Vec::new() }
}

fn errors_of_models(train: Simulated<'_>, holdout: Simulated<'_>) -> Models<Option<Errors>> {
    train.models.zip_with(holdout.models, |on_train, on_holdout| {
        let held_n = on_holdout.map(|fit| fit.force_n.as_slice());
        errors((train.tests, &on_train?.force_n), (holdout.tests, held_n))
    })
}

/// Errors of simulated forces on the training tests and on those held out.
fn errors(
    (train, train_n): (&TestSet, &[Vec<f64>]),
    (holdout, holdout_n): (&TestSet, Option<&[Vec<f64>]>),
) -> Option<Errors> {
    let train_rmse_n = train.rmse_n(train_n)?;
    let holdout_rmse_n = holdout_n.and_then(|force_n| holdout.rmse_n(force_n));
    Some(Errors {
        train_rmse_n,
        holdout_rmse_n,
        train_nrmse: train_rmse_n / train.measured_rms_n()?,
        holdout_nrmse: holdout_rmse_n.zip(holdout.measured_rms_n()).map(|(held, rms)| held / rms),
    })
}

fn per_test<'a>(
    simulated: Simulated<'a>,
    role: &'static str,
) -> impl Iterator<Item = PerTest> + 'a {
    let Simulated { tests, models } = simulated;
    tests.tests.iter().enumerate().map(move |(index, test)| {
        let forces = models.map(|fit| fit.as_ref().map(|fit| fit.force_n[index].as_slice()));
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
    findings: &Findings,
    deviations: &[Option<f64>],
    datasheet: Option<&Nominal>,
) -> BTreeMap<String, NominalValue> {
    let fit = findings.with_effects.fit();
    let given = datasheet.map(vector_of);
    NOMINAL
        .iter()
        .enumerate()
        .map(|(index, (name, unit))| {
            let value = NominalValue {
                value: fit.values[index],
                std: deviations[index],
                unit,
                datasheet: given.as_ref().map(|given| given[index]),
            };
            ((*name).to_owned(), value)
        })
        .collect()
}

fn effects_found(
    findings: &Findings,
    deviations: &[Option<f64>],
    train: &TestSet,
) -> Vec<EffectFound> {
    let fit = findings.with_effects.fit();
    let declared = train.tests.iter().all(|test| test.record.direction_declared);
    let turned = train.tests.iter().any(|test| test.record.force_turned);
    findings
        .accepted
        .iter()
        .zip(&fit.model.effects)
        .enumerate()
        .map(|(index, (accepted, info))| {
            let places = fit.model.range_of(index);
            let whole = CATALOGUE.iter().find(|whole| whole.name == info.name);
            let rows = whole.map_or(info.parameters, |whole| whole.parameters);
            let parameters = rows
                .iter()
                .enumerate()
                .map(|(row_index, row)| {
                    // Parameters that share a value are the last ones of the table.
                    let k = (places.start + row_index).min(places.end - 1);
                    let (value, std) = (fit.values[k], deviations[k]);
                    (row.name, ParameterValue { value, std, unit: row.unit.symbol() })
                })
                .collect();
            let direction = info.directional.then_some(match (declared, turned) {
                (true, false) => "positive is extension, as declared",
                (true, true) => {
                    "positive is extension if the displacement was right, to which the force was \
                     turned"
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

/// The tests that show each effect of a group.
fn separating_test(name: &str, alternatives: &[&str]) -> String {
    let tests = std::iter::once(name).chain(alternatives.iter().copied()).filter_map(|name| {
        let info = CATALOGUE.iter().find(|info| info.name == name)?;
        Some(format!("{name}: {}", info.shown_by))
    });
    tests.collect::<Vec<_>>().join(" ")
}

fn rejected(findings: &Findings) -> Vec<EffectRejected> {
    let each = findings.rejected.iter().map(|rejected| EffectRejected {
        name: rejected.name,
        why: rejected.why.clone(),
        holdout_gain: rejected.holdout_gain,
    });
    each.collect()
}

fn not_testable(findings: &Findings, train: &TestSet) -> Vec<EffectNotTestable> {
    let mut all: Vec<EffectNotTestable> = findings
        .not_testable
        .iter()
        .map(|hidden| EffectNotTestable {
            name: hidden.name,
            why: hidden.why.clone(),
            test_that_would: hidden.test_that_would.to_owned(),
        })
        .collect();
    let rate_hz = train.lowest_rate_hz();
    let kept = |name: &str| train.destroyed(name).is_none();
    let too_fast = CATALOGUE.iter().filter(|info| info.needs_rate_hz > rate_hz);
    for info in too_fast.filter(|info| kept(info.name)) {
        let needs = info.needs_rate_hz;
        let why = format!("it needs {needs} samples per second, the records have {rate_hz:.0}");
        let test_that_would = info.shown_by.to_owned();
        all.push(EffectNotTestable { name: info.name, why, test_that_would });
    }
    for info in CATALOGUE {
        if let Some(done) = train.destroyed(info.name) {
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

fn empirical_part(tried: &Empirical, train: &TestSet, holdout: &TestSet) -> EmpiricalPart {
    let fitted = tried.fitted.as_ref();
    let with_map =
        |map: &FittedMap| errors((train, &map.on_train), (holdout, Some(&map.on_holdout)));
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
        errors: fitted.and_then(with_map),
    }
}
