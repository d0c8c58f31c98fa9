//! The result of one case: one line of JSON.

use identification::result::{IdentifyResult, Verdict};
use serde::{Deserialize, Serialize};

/// The result of a case, as its file holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseResult {
    /// Number of the case.
    pub index: usize,
    /// Seed of the campaign.
    pub campaign_seed: u64,
    /// Fewer tests than usual.
    pub brief: bool,
    /// What kind of truth it is.
    pub kind: String,
    /// How the actuator moves.
    pub motion: String,
    /// What noise the records have.
    pub noise: String,
    /// `yaw` or `small` or the type of a hydraulic damper.
    pub damper: String,
    /// What is missing in truth; the disturbance or the part where no effect is.
    pub truth: Vec<String>,
    /// The effect that a neighbour is near.
    pub near: Option<String>,
    /// The wanted size, in multiples of the noise.
    pub size: f64,
    /// The sizes that were reached.
    pub sizes: Vec<f64>,
    /// All sizes are the wanted ones.
    pub reached: bool,
    /// True parameters, where there is a true damper.
    pub parameters: Vec<(String, f64)>,
    /// rms of the noise that sizes count in, N.
    pub noise_n: f64,
    /// rms of the noise in the force of the training tests, N: the record less the same without
    /// noise.
    pub true_noise_n: Option<f64>,
    /// The noise floor that was found, N.
    pub noise_floor_n: Option<f64>,
    /// The lower bound that was found where there is no floor, N.
    pub noise_at_least_n: Option<f64>,
    /// How either was found.
    pub noise_floor_method: String,
    /// The verdict; empty where there is none.
    pub verdict: String,
    /// Why the records cannot show that nothing more is missing.
    pub not_judged: Option<String>,
    /// What was named, in the order of acceptance.
    pub named: Vec<Named>,
    /// Effects that the residual resembles.
    pub resembles: Vec<String>,
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
    /// What the next test gave, where there are rivals.
    pub next_test: Option<NextTestResult>,
    /// Why there is no identification.
    pub failure: Option<String>,
    /// Time until the specimen had its size, s.
    pub sizing_seconds: f64,
    /// Time that the identification took, s.
    pub seconds: f64,
    /// Time that the next test took, with its identification, s.
    pub next_test_seconds: f64,
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
    /// What a result names.
    pub(super) fn all_of(result: &IdentifyResult) -> Vec<Self> {
        let each = result.effects.iter().map(|effect| Self {
            name: effect.name.to_owned(),
            alternatives: effect.alternatives.iter().map(|name| (*name).to_owned()).collect(),
            p_value: effect.evidence.p_value,
            holdout_gain: effect.evidence.holdout_gain,
        });
        each.collect()
    }

    /// True when it is this effect or says that it may be.
    pub fn may_be(&self, truth: &str) -> bool {
        self.name == truth || self.alternatives.iter().any(|other| other == truth)
    }
}

/// Errors of a case, N rms; those of the third set without a prefix.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CaseErrors {
    /// Refitted nominal damper on the training tests.
    pub train_before_n: f64,
    /// With effects.
    pub train_after_n: f64,
    /// The true damper on the training tests: more than the noise where the bench itself, its
    /// filters and its sampling rate bend the record.
    pub train_truth_n: Option<f64>,
    /// Refitted nominal damper on the third set.
    pub before_n: f64,
    /// With effects.
    pub after_n: f64,
    /// The true damper; none where no damper of the core is true.
    pub truth_n: Option<f64>,
    /// rms of the measured force.
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

/// What one more test made of two rivals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NextTestResult {
    /// The rivals: what was named, and its first alternative that a test separates.
    pub rivals: [String; 2],
    /// Which of them is true, or near the truth; none where neither is.
    pub true_one: Option<String>,
    /// The test that was proposed; none where no test within the limits separates them.
    pub proposed: Option<String>,
    /// What is named with that test, with its alternatives.
    pub named: Vec<Named>,
    /// Why there is no identification with that test.
    pub failure: Option<String>,
    /// The true one is named without the other as an alternative; none where no test was run, or
    /// neither is true.
    pub separated: Option<bool>,
}

impl CaseResult {
    /// What a right first name would be: an effect that is missing, or the one that a neighbour is
    /// near.
    pub fn right_names(&self) -> impl Iterator<Item = &str> {
        let near = self.near.as_deref();
        let own = if near.is_some() { &[] } else { &self.truth[..] };
        own.iter().map(String::as_str).chain(near)
    }

    /// The first name is right, or says that it may be what is true.
    pub fn first_is_right(&self) -> bool {
        let first = self.named.first();
        first.is_some_and(|first| self.right_names().any(|truth| first.may_be(truth)))
    }

    /// An unexplained residual was found.
    pub fn says_unexplained(&self) -> bool {
        self.unexplained.is_some()
    }

    /// The verdict is that nothing is missing.
    pub fn is_clean(&self) -> bool {
        self.verdict == verdict_name(Verdict::NoMissingEffect)
    }

    /// An effect is named, and nothing is said to be unexplained or to resemble another one.
    pub fn is_confident(&self) -> bool {
        !self.named.is_empty() && !self.says_unexplained() && self.resembles.is_empty()
    }

    /// It says that something is there which it cannot name, or that it cannot judge.
    pub fn is_honest(&self) -> bool {
        self.says_unexplained() || !self.resembles.is_empty() || self.not_judged.is_some()
    }

    /// Error on the third set over that of the true damper.
    pub fn over_truth(&self) -> Option<f64> {
        let errors = self.errors?;
        errors.truth_n.filter(|truth| *truth > 0.0).map(|truth| errors.after_n / truth)
    }

    /// Error on the third set over that of the refitted nominal damper, where an effect is named.
    pub fn over_refit(&self) -> Option<f64> {
        let errors = self.errors.filter(|_| !self.named.is_empty())?;
        (errors.before_n > 0.0).then(|| errors.after_n / errors.before_n)
    }
}

/// A verdict as it is written.
pub(super) const fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::NoMissingEffect => "no_missing_effect",
        Verdict::EffectsFound => "effects_found",
        Verdict::Unexplained => "unexplained",
        Verdict::EffectsFoundAndUnexplained => "effects_found_and_unexplained",
        Verdict::NotJudged => "not_judged",
    }
}
