//! One case, run and scored: one line of JSON.

use super::case::Case;
use super::plan::{HYDRAULIC, Kind};
use super::size::records;
use super::specimen::{Mounted, mount};
use firmware_core::damper::Damper;
use identification::result::{Errors, IdentifyResult, Verdict};
use identification::{Control, Question, TestSet, identify, simulate, start_deflection_m};
use measurement::Measurement;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Standard deviations of half a 95 % interval.
const HALF_INTERVAL: f64 = 1.96;
/// A datasheet may move a parameter by this share of its standard deviation, or of itself.
const UNMOVED: f64 = 0.5;
const UNMOVED_SHARE: f64 = 0.01;

/// The result of a case, as its file holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseResult {
    /// Number of the case.
    pub index: usize,
    /// Seed of the campaign.
    pub campaign_seed: u64,
    /// Fewer and shorter tests than usual.
    pub brief: bool,
    /// What kind of case it is.
    pub kind: String,
    /// `yaw` or `small` or the type of a hydraulic damper.
    pub damper: String,
    /// The force has coloured noise.
    pub coloured: bool,
    /// What is missing in truth; the disturbance for cases outside the catalogue.
    pub truth: Vec<String>,
    /// The wanted size, in multiples of the noise.
    pub size: f64,
    /// The sizes of the true effects.
    pub sizes: Vec<f64>,
    /// All sizes are the wanted ones.
    pub reached: bool,
    /// True parameters, where there is a true damper.
    pub parameters: Vec<(String, f64)>,
    /// rms of the noise, N.
    pub noise_n: f64,
    /// The verdict; empty where there is none.
    pub verdict: String,
    /// What was named, in the order of acceptance.
    pub named: Vec<Named>,
    /// The coordinate of what is unexplained.
    pub unexplained: Option<String>,
    /// Why true effects were not named.
    pub missed_because: Vec<String>,
    /// Errors, where there is an identification.
    pub errors: Option<CaseErrors>,
    /// Stated intervals, where the model has the right form.
    pub intervals: Vec<Interval>,
    /// The result with the wrong datasheet differs from that without one.
    pub datasheet_moved: Option<bool>,
    /// Why there is no identification.
    pub failure: Option<String>,
    /// Time that the identification took, s.
    pub seconds: f64,
}

/// An effect that was named.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Named {
    /// Its name.
    pub name: String,
    /// Effects that the records cannot distinguish from it.
    pub alternatives: Vec<String>,
    /// Probability of such a finding by chance.
    pub p_value: f64,
    /// Share of the squared error that it removes on the pieces held out.
    pub holdout_gain: f64,
}

impl Named {
    /// True when it is this effect or says that it may be.
    pub fn may_be(&self, truth: &str) -> bool {
        self.name == truth || self.alternatives.iter().any(|other| other == truth)
    }
}

/// Errors of a case, N rms.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CaseErrors {
    /// Noise floor as it was found.
    pub floor_n: f64,
    /// Refitted nominal damper on the training tests.
    pub train_before_n: f64,
    /// With effects.
    pub train_after_n: f64,
    /// Refitted nominal damper on the hold-out.
    pub before_n: f64,
    /// With effects.
    pub after_n: f64,
    /// The true damper on the same tests; none where no damper of the core is true.
    pub truth_n: Option<f64>,
    /// The true damper on the training tests: more than the noise where the bench itself,
    /// its filters and its sampling rate bend the record.
    #[serde(default)]
    pub train_truth_n: Option<f64>,
    /// rms of the measured force of the hold-out.
    pub force_n: f64,
}

/// A stated 95 % interval against the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// The parameter, with its effect before it.
    pub parameter: String,
    /// The truth lies within.
    pub covers: bool,
    /// Identified less true value, in standard deviations.
    pub off: f64,
}

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
        kind: case.kind.name().to_owned(),
        damper: match case.kind {
            Kind::Hydraulic { which } => HYDRAULIC[which].to_owned(),
            _ => case.class.to_owned(),
        },
        coloured: case.sensors.coloured.is_some(),
        truth: Vec::new(),
        size: case.size(),
        sizes: Vec::new(),
        reached: true,
        parameters: Vec::new(),
        noise_n: case.noise_n(),
        verdict: String::new(),
        named: Vec::new(),
        unexplained: None,
        missed_because: Vec::new(),
        errors: None,
        intervals: Vec::new(),
        datasheet_moved: None,
        failure: None,
        seconds: 0.0,
    };
    match mount(case, control) {
        Ok(mounted) => line.fill(case, &mounted, control),
        Err(why) => line.failure = Some(why.to_string()),
    }
    // What a stopped step returns is no result.
    (!stop.load(Ordering::Relaxed)).then_some(line)
}

impl CaseResult {
    fn fill(&mut self, case: &Case, mounted: &Mounted, control: Control<'_>) {
        self.truth = mounted.truth.iter().map(|name| (*name).to_owned()).collect();
        self.sizes = mounted.sizes.iter().map(|sized| sized.size).collect();
        self.reached = mounted.sizes.iter().all(|sized| sized.reached);
        self.parameters = mounted.damper.as_ref().map(true_parameters).unwrap_or_default();
        let (train, holdout) = match records(case, &*mounted.specimen, &case.sensors, control.stop)
        {
            Ok(records) => records,
            Err(why) => {
                self.failure = Some(why.to_string());
                return;
            }
        };
        let (fitted, judged) = (TestSet::new(train.clone()), TestSet::new(holdout.clone()));
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
        let found = identify(question, control);
        self.seconds = begin.elapsed().as_secs_f64();
        let result = match found {
            Ok(found) => found.result,
            Err(why) => {
                self.failure = Some(why.to_string());
                return;
            }
        };
        self.datasheet_moved =
            without.map(|without| without.map_or(true, |without| differ(&result, &without)));
        self.take(&result);
        self.errors = errors(&result, mounted.damper.as_ref(), [&fitted, &judged]);
        let named: Vec<&str> = result.effects.iter().map(|effect| effect.name).collect();
        if mounted.damper.is_some() && named == mounted.truth {
            self.intervals = intervals(&result, &self.parameters);
        }
    }

    fn take(&mut self, result: &IdentifyResult) {
        verdict_name(result.verdict).clone_into(&mut self.verdict);
        self.named = result
            .effects
            .iter()
            .map(|effect| Named {
                name: effect.name.to_owned(),
                alternatives: effect.alternatives.iter().map(|name| (*name).to_owned()).collect(),
                p_value: effect.evidence.p_value,
                holdout_gain: effect.evidence.holdout_gain,
            })
            .collect();
        self.unexplained = result.unexplained.as_ref().map(|part| part.coordinate.to_owned());
        let unnamed = |name: &str| self.truth.iter().any(|truth| truth == name);
        let rejected = result.rejected.iter().map(|one| (one.name, &one.why));
        let not_testable = result.not_testable.iter().map(|one| (one.name, &one.why));
        self.missed_because = rejected
            .chain(not_testable)
            .filter(|(name, _)| unnamed(name))
            .map(|(name, why)| format!("{name}: {why}"))
            .collect();
    }

    /// The first name is right, or says that it may be what is true.
    pub fn first_is_right(&self) -> bool {
        self.named.first().is_some_and(|first| self.truth.iter().any(|truth| first.may_be(truth)))
    }

    /// An unexplained residual was found.
    pub fn says_unexplained(&self) -> bool {
        self.unexplained.is_some()
    }

    /// Error on the hold-out over that of the true damper.
    pub fn over_truth(&self) -> Option<f64> {
        let errors = self.errors?;
        errors.truth_n.filter(|truth| *truth > 0.0).map(|truth| errors.after_n / truth)
    }
}

const fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::NoMissingEffect => "no_missing_effect",
        Verdict::EffectsFound => "effects_found",
        Verdict::Unexplained => "unexplained",
        Verdict::EffectsFoundAndUnexplained => "effects_found_and_unexplained",
        Verdict::NotJudged => "not_judged",
    }
}

fn errors(
    result: &IdentifyResult,
    truth: Option<&Damper>,
    [fitted, judged]: [&TestSet; 2],
) -> Option<CaseErrors> {
    let held = |errors: &Option<Errors>| {
        let errors = errors.as_ref()?;
        Some((errors.train_rmse_n, errors.holdout_rmse_n?))
    };
    let (train_before_n, before_n) = held(&result.errors.refitted)?;
    let (train_after_n, after_n) = held(&result.errors.with_effects)?;
    Some(CaseErrors {
        floor_n: result.noise_floor_n.unwrap_or(0.0),
        train_before_n,
        train_after_n,
        before_n,
        after_n,
        truth_n: truth.map(|damper| rmse_of(damper, judged)),
        train_truth_n: truth.map(|damper| rmse_of(damper, fitted)),
        force_n: judged.rms_force_n(),
    })
}

/// rms error of a damper on tests, N, over the same samples as those of `identify`.
fn rmse_of(damper: &Damper, tests: &TestSet) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for test in &tests.tests {
        let start_m = start_deflection_m(damper, test);
        let force_n = simulate(damper, test, start_m);
        let Measurement { force_n: measured, .. } = &test.record;
        for i in test.counted() {
            let error = measured[i] - force_n[i];
            sum += error * error;
            count += 1;
        }
    }
    (sum / f64::from(count.max(1))).sqrt()
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
