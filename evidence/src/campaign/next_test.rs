//! The proof of the next test: rivals that the records do not separate, one more test on the same
//! specimen with the same sensors, and what is named then.

use super::case::Case;
use super::line::{Named, NextTestResult};
use super::size::records;
use crate::error::EvidenceError;
use identification::{Control, Identification, Motion, Question, identify, next_tests};
use virtual_bench::bench_visit::Specimen;
use virtual_bench::bench_visit::proposals::{RigLimits, proposals};
use virtual_bench::bench_visit::protocol::Test;

/// Stroke and speed of the rig over those of the training tests.
const ROOM: f64 = 1.2;
/// Sampling rate of the motions, Hz.
const RATE_HZ: f64 = 500.0;

/// Separates the rivals of an identification by one more test; none where there are no rivals.
/// `right` holds the names that are right; `holdout` is the hold-out of the first question.
///
/// # Errors
/// A motion or record that cannot be prepared, an identification that fails, the work is stopped.
pub(super) fn separate(
    case: &Case,
    specimen: &dyn Specimen,
    found: &Identification,
    right: &[&str],
    control: Control<'_>,
) -> Result<Option<NextTestResult>, EvidenceError> {
    let rivals = found.result.effects.iter().find(|effect| !effect.alternatives.is_empty());
    let Some(rivals) = rivals else { return Ok(None) };
    let is_true = |name: &str| right.contains(&name);
    let all = proposals(&RigLimits {
        stroke_m: ROOM * case.extent.extension_m.max(case.extent.compression_m),
        speed_m_per_s: ROOM * case.extent.speed_m_per_s,
    });
    let motions: Vec<Motion> = all
        .iter()
        .map(|proposal| Motion {
            name: proposal.test.name.clone(),
            rate_hz: RATE_HZ,
            displacement_m: proposal.displacement_m(RATE_HZ),
        })
        .collect();
    let largest_force_n = case.sensors.force.range;
    let tests = next_tests(found, &motions, largest_force_n, control)?;
    let separates = |test: &&identification::NextTest| {
        let [one, other] = &test.separates;
        found
            .result
            .effects
            .iter()
            .any(|effect| effect.name == *one && effect.alternatives.contains(&other.as_str()))
    };
    let mut outcome = NextTestResult {
        rivals: [rivals.name.to_owned(), rivals.alternatives[0].to_owned()],
        true_one: None,
        proposed: None,
        named: Vec::new(),
        failure: None,
        separated: None,
    };
    let next = tests.iter().find(separates);
    if let Some(next) = next {
        outcome.rivals.clone_from(&next.separates);
        outcome.proposed = Some(next.name.clone());
        match with_one_more(case, specimen, &all[next.motion].test, control) {
            Ok(named) => outcome.named = named,
            Err(EvidenceError::Stopped) => return Err(EvidenceError::Stopped),
            Err(why) => outcome.failure = Some(why.to_string()),
        }
    }
    let [one, other] = &outcome.rivals;
    let own = [(one, other), (other, one)].into_iter().find(|(own, _)| is_true(own));
    if let Some((own, other)) = own {
        outcome.separated = next.map(|_| remains(&outcome.named, own, other));
        outcome.true_one = Some(own.clone());
    }
    Ok(Some(outcome))
}

/// What is named when the training tests have one more.
fn with_one_more(
    case: &Case,
    specimen: &dyn Specimen,
    test: &Test,
    control: Control<'_>,
) -> Result<Vec<Named>, EvidenceError> {
    // At the end of the visit, so that all records before stay the same.
    let holds = case.tests.holdout.len();
    let tests = [&case.tests.train[..], &case.tests.holdout, std::slice::from_ref(test)].concat();
    let mut all = records(case, specimen, &case.sensors, &tests, control.stop)?;
    let more = all.split_off(case.tests.train.len() + holds);
    let holdout = all.split_off(case.tests.train.len());
    all.extend(more);
    let question = Question {
        train: all,
        holdout,
        datasheet: None,
        empirical: false,
        thorough: false,
        notes: Vec::new(),
    };
    Ok(Named::all_of(&identify(question, control)?.result))
}

/// The true one is named and the other one is not among its alternatives, or it is the only one of
/// the two that may be.
fn remains(named: &[Named], own: &str, other: &str) -> bool {
    let alone = |one: &Named| one.name == own && !one.may_be(other);
    let may_be = |name: &str| named.iter().any(|one| one.may_be(name));
    named.iter().any(alone) || (may_be(own) && !may_be(other))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rivals_are_separated_where_the_true_one_remains_without_the_other() {
        let one = |name: &str, alternatives: &[&str]| Named {
            name: name.to_owned(),
            alternatives: alternatives.iter().map(|name| (*name).to_owned()).collect(),
            p_value: 0.0,
            holdout_gain: 1.0,
        };
        assert!(remains(&[one("a", &[])], "a", "b"));
        assert!(remains(&[one("c", &["a"])], "a", "b"));
        assert!(remains(&[one("a", &[]), one("b", &[])], "a", "b"));
        assert!(!remains(&[one("a", &["b"])], "a", "b"));
        assert!(!remains(&[one("b", &[])], "a", "b"));
        assert!(!remains(&[], "a", "b"));
    }
}
