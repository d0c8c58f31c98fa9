//! One case, run and scored.
//!
//! `identify` gets the training tests and the hold-out, and in some cases a datasheet that is
//! wrong. Errors are those on the third set, which neither the search nor the gate has seen.

use super::case::Case;
use super::design::{HYDRAULIC, Truth};
use super::line::{CaseErrors, CaseResult, Interval, Named, verdict_name};
use super::next_test::separate;
use super::noise::silent;
use super::size::records;
use super::specimen::{Mounted, mount};
use crate::error::EvidenceError;
use firmware_core::damper::Damper;
use identification::result::IdentifyResult;
use identification::{
    Control, Fit, Identification, Question, TestSet, identify, simulate, start_deflection_m,
};
use measurement::Measurement;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use virtual_bench::series_model::neighbour::NEIGHBOURS;

/// Standard deviations of half a 95 % interval.
const HALF_INTERVAL: f64 = 1.96;
/// A datasheet may move a parameter by this share of its standard deviation, or of itself.
const UNMOVED: f64 = 0.5;
const UNMOVED_SHARE: f64 = 0.01;

/// Runs a case and scores it; none once `stop` is set, which every step of it reads.
pub(super) fn score(
    case: &Case,
    campaign_seed: u64,
    brief: bool,
    stop: &AtomicBool,
) -> Option<CaseResult> {
    let control = Control { progress: &|_| {}, stop };
    let mut line = CaseResult {
        index: case.index,
        campaign_seed,
        brief,
        kind: case.of.truth.kind().to_owned(),
        motion: case.of.motion.name().to_owned(),
        noise: case.of.noise.name().to_owned(),
        damper: match case.of.truth {
            Truth::Hydraulic(which) => HYDRAULIC[which].to_owned(),
            _ => case.class.to_owned(),
        },
        truth: Vec::new(),
        near: match case.of.truth {
            Truth::Neighbour(which) => NEIGHBOURS[which].near.map(str::to_owned),
            _ => None,
        },
        size: case.of.size,
        sizes: Vec::new(),
        reached: true,
        parameters: Vec::new(),
        noise_n: case.noise_n(),
        true_noise_n: None,
        noise_floor_n: None,
        noise_at_least_n: None,
        noise_floor_method: String::new(),
        verdict: String::new(),
        not_judged: None,
        named: Vec::new(),
        resembles: Vec::new(),
        unexplained: None,
        missed_because: Vec::new(),
        errors: None,
        intervals: Vec::new(),
        datasheet_moved: None,
        next_test: None,
        failure: None,
        sizing_seconds: 0.0,
        seconds: 0.0,
        next_test_seconds: 0.0,
    };
    let begin = Instant::now();
    let mounted = mount(case, control);
    line.sizing_seconds = begin.elapsed().as_secs_f64();
    let filled = mounted.and_then(|mounted| line.fill(case, &mounted, control));
    line.failure = filled.err().map(|why| why.to_string());
    // What a stopped step returns is no result.
    (!stop.load(Ordering::Relaxed)).then_some(line)
}

/// The records of the three sets.
struct Sets {
    train: Vec<Measurement>,
    holdout: Vec<Measurement>,
    third: Vec<Measurement>,
}

impl Sets {
    fn record(case: &Case, mounted: &Mounted, control: Control<'_>) -> Result<Self, EvidenceError> {
        let tests = case.tests.all();
        let mut train = records(case, &*mounted.specimen, &case.sensors, &tests, control.stop)?;
        let mut holdout = train.split_off(case.tests.train.len());
        let third = holdout.split_off(case.tests.holdout.len());
        Ok(Self { train, holdout, third })
    }
}

impl CaseResult {
    fn fill(
        &mut self,
        case: &Case,
        mounted: &Mounted,
        control: Control<'_>,
    ) -> Result<(), EvidenceError> {
        self.truth = mounted.truth.iter().map(|name| (*name).to_owned()).collect();
        self.sizes = mounted.sizes.iter().map(|sized| sized.size).collect();
        self.reached = mounted.sizes.iter().all(|sized| sized.reached);
        self.parameters = mounted.damper.as_ref().map(true_parameters).unwrap_or_default();
        let Sets { train, holdout, third } = Sets::record(case, mounted, control)?;
        self.true_noise_n = Some(true_noise_n(case, mounted, &train, control)?);
        let question = Question {
            train,
            holdout,
            datasheet: case.datasheet,
            empirical: false,
            thorough: false,
            notes: Vec::new(),
        };
        let without = case.datasheet.is_some().then(|| {
            let question = Question { datasheet: None, ..question.clone() };
            identify(question, control).map(|found| found.result)
        });
        let begin = Instant::now();
        let found = identify(question, control)?;
        self.seconds = begin.elapsed().as_secs_f64();
        self.datasheet_moved =
            without.map(|without| without.map_or(true, |without| differ(&found.result, &without)));
        self.take(&found.result);
        self.errors = errors(&found, mounted.damper.as_ref(), &TestSet::new(third));
        let names: Vec<&str> = found.result.effects.iter().map(|effect| effect.name).collect();
        if mounted.damper.is_some() && names == mounted.truth {
            self.intervals = intervals(&found.result, &self.parameters);
        }
        let begin = Instant::now();
        let right: Vec<&str> = self.right_names().collect();
        self.next_test = separate(case, &*mounted.specimen, &found, &right, control)?;
        self.next_test_seconds = begin.elapsed().as_secs_f64();
        Ok(())
    }

    fn take(&mut self, result: &IdentifyResult) {
        verdict_name(result.verdict).clone_into(&mut self.verdict);
        self.noise_floor_n = result.noise_floor_n;
        self.noise_at_least_n = result.noise_at_least_n;
        result.noise_floor_method.clone_into(&mut self.noise_floor_method);
        self.not_judged.clone_from(&result.not_judged);
        self.named = Named::all_of(result);
        self.resembles = result.resembles.iter().map(|name| (*name).to_owned()).collect();
        self.unexplained = result.unexplained.as_ref().map(|part| part.coordinate.to_owned());
        let missed = |name: &str| {
            let named = self.named.iter().any(|one| one.may_be(name));
            !named && self.right_names().any(|truth| truth == name)
        };
        let rejected = result.rejected.iter().map(|one| (one.name, &one.why));
        let not_testable = result.not_testable.iter().map(|one| (one.name, &one.why));
        self.missed_because = rejected
            .chain(not_testable)
            .filter(|(name, _)| missed(name))
            .map(|(name, why)| format!("{name}: {why}"))
            .collect();
    }
}

/// rms of the noise in the force of the training tests, N, over the samples that errors count: the
/// record less that of the same visit without noise.
fn true_noise_n(
    case: &Case,
    mounted: &Mounted,
    train: &[Measurement],
    control: Control<'_>,
) -> Result<f64, EvidenceError> {
    let sensors = silent(&case.sensors);
    let exact = records(case, &*mounted.specimen, &sensors, &case.tests.train, control.stop)?;
    let (mut sum, mut count) = (0.0, 0_u32);
    for (record, exact) in train.iter().zip(&exact) {
        let pairs = record.force_n.iter().zip(&exact.force_n).skip(record.run_in);
        for (with, without) in pairs {
            sum += (with - without) * (with - without);
            count += 1;
        }
    }
    Ok((sum / f64::from(count.max(1))).sqrt())
}

fn errors(found: &Identification, truth: Option<&Damper>, third: &TestSet) -> Option<CaseErrors> {
    let of_train = |fit: &Option<Fit>| Some(fit.as_ref()?.rms_n(&found.train));
    let refitted = found.on_train.refitted.as_ref()?;
    let refitted = refitted.model.damper(&refitted.values)?;
    Some(CaseErrors {
        train_before_n: of_train(&found.on_train.refitted)?,
        train_after_n: of_train(&found.on_train.with_effects)?,
        train_truth_n: truth.map(|damper| rmse_of(damper, &found.train)),
        before_n: rmse_of(&refitted, third),
        after_n: rmse_of(&found.damper, third),
        truth_n: truth.map(|damper| rmse_of(damper, third)),
        force_n: third.measured_rms_n()?,
    })
}

/// rms error of a damper on tests, N, over the same samples as those of `identify`.
fn rmse_of(damper: &Damper, tests: &TestSet) -> f64 {
    let each = tests.tests.iter();
    let force_n: Vec<Vec<f64>> =
        each.map(|test| simulate(damper, test, start_deflection_m(damper, test))).collect();
    tests.rmse_n(&force_n).unwrap_or(0.0)
}

fn true_parameters(damper: &Damper) -> Vec<(String, f64)> {
    let nominal = damper.nominal();
    let mut all = vec![
        ("ce_n_s_per_m".to_owned(), nominal.ce_n_s_per_m),
        ("ke_n_per_m".to_owned(), nominal.ke_n_per_m),
        ("clearance_2a_m".to_owned(), nominal.clearance_2a_m),
        ("f_relief_n".to_owned(), nominal.f_relief_n),
        ("c2_n_s_per_m".to_owned(), nominal.c2_n_s_per_m),
    ];
    for effect in damper.effects() {
        let rows = effect.parameters().iter().zip(effect.values());
        all.extend(rows.map(|(row, value)| (format!("{}.{}", effect.name(), row.name), value)));
    }
    all
}

fn intervals(result: &IdentifyResult, truth: &[(String, f64)]) -> Vec<Interval> {
    let mut stated: Vec<(String, f64, f64)> = Vec::new();
    for (name, value) in &result.nominal {
        stated.extend(value.std.map(|std| (name.clone(), value.value, std)));
    }
    for effect in &result.effects {
        for (name, value) in &effect.parameters {
            let name = format!("{}.{name}", effect.name);
            stated.extend(value.std.map(|std| (name, value.value, std)));
        }
    }
    stated
        .into_iter()
        .filter(|(_, _, std)| *std > 0.0)
        .filter_map(|(parameter, value, std)| {
            let (_, truth) = truth.iter().find(|(name, _)| *name == parameter)?;
            let off = (value - truth) / std;
            Some(Interval { parameter, covers: off.abs() <= HALF_INTERVAL, off })
        })
        .collect()
}

/// Two results say different things.
fn differ(one: &IdentifyResult, other: &IdentifyResult) -> bool {
    let names = |result: &IdentifyResult| -> Vec<&str> {
        result.effects.iter().map(|effect| effect.name).collect()
    };
    let moved = one.nominal.iter().any(|(name, value)| {
        let Some(other) = other.nominal.get(name) else { return true };
        let allowed = value.std.map_or(UNMOVED_SHARE * value.value.abs(), |std| UNMOVED * std);
        (value.value - other.value).abs() > allowed
    });
    one.verdict != other.verdict || names(one) != names(other) || moved
}
