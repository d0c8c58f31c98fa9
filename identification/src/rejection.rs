//! Why the candidates of the last round were rejected, in words.

use super::acceptance::objection;
use super::finding::{Outdone, Rejected};
use super::judged::Judged;
use super::round::Round;
use super::test_set::TestSet;
use super::trial::Trial;

/// All candidates that the records could show: those fitted by their error on left-out pieces, then
/// those screened out.
pub(crate) fn rejections(
    standing: &Judged,
    round: &Round,
    outdone: &[Outdone],
    tests: &TestSet,
) -> Vec<Rejected> {
    let fitted = round.trials.iter().map(|trial| fitted(standing, round, trial, tests));
    let screened_out = round.open().filter(|index| !round.has_tried(*index));
    fitted.chain(screened_out.map(|index| screened_out_of(round, index, outdone))).collect()
}

fn fitted(standing: &Judged, round: &Round, trial: &Trial, tests: &TestSet) -> Rejected {
    let why = objection(standing, trial, round.tried.len(), tests)
        .unwrap_or_else(|| "another choice is made when a test is left out".to_owned());
    let name = round.tried[trial.candidate].effect.name;
    Rejected { name, why, holdout_gain: Some(trial.evidence.holdout_gain) }
}

fn screened_out_of(round: &Round, index: usize, outdone: &[Outdone]) -> Rejected {
    let of_candidate = round.screened.iter().filter(|screened| screened.candidate == index);
    let gain = 100.0 * of_candidate.map(|screened| screened.gain(None)).fold(0.0, f64::max);
    let name = round.tried[index].effect.name;
    let why = format!("screened out: to first order it explains {gain:.2} % of the residual");
    let Some(earlier) = outdone.iter().rfind(|other| other.name == name) else {
        return Rejected { name, why, holdout_gain: None };
    };
    let Outdone { gain, by, gain_of_other, .. } = earlier;
    Rejected {
        name,
        why: format!(
            "removes {:.1} % of the squared error on left-out tests where {by} removes {:.1} %; \
             with it, {why}",
            100.0 * gain,
            100.0 * gain_of_other
        ),
        holdout_gain: Some(*gain),
    }
}
