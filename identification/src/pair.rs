//! Two effects at once.
//!
//! An effect may help only together with another one: alone it improves some tests and spoils
//! others, as each of two effects does that pull the same parameter in different directions. Where
//! no candidate is accepted alone and the residual is far above its noise, each of the best few is
//! added on trial, with a whole round on top of it. A pair is accepted when
//!
//! - the second is accepted on top of the first by the usual rules ([`super::acceptance`]);
//! - both together are accepted on top of the standing model by the same rules, with every ordered
//!   pair of candidates counted against the significance;
//! - both together remove at least half of the squared error on left-out pieces.
//!
//! Pairs that predict equally well are named as alternatives, one effect at a time. Past a limit of
//! work no further first effect is tried.

use super::acceptance::{choose, distinguishable, objection, remakes};
use super::budget::Budget;
use super::candidate::Candidate;
use super::control::{Control, Step};
use super::evidence::{LEAST_GAIN, evidence};
use super::finding::Accepted;
use super::fit::Fit;
use super::judged::Judged;
use super::round::Round;
use super::test_set::TestSet;
use super::trial::Trial;

/// Candidates that are tried as the first of two.
const FIRSTS: usize = 3;
/// Share of the squared error on left-out pieces that two effects together have to remove. Two
/// effects can imitate many others, but then more than half of the error remains.
const LEAST_JOINT_GAIN: f64 = 0.5;

/// Two effects of which neither was accepted alone.
pub(crate) struct Pair {
    /// The effects, in the order of the model.
    pub accepted: [Accepted; 2],
    /// The model with both, near its minimum.
    pub fit: Fit,
    /// The second of them as it was tried.
    pub second: Candidate,
}

/// A pair that passes every test.
struct Acceptable {
    pair: Pair,
    /// Both against the standing model.
    joint: Trial,
}

/// The pair to accept, if there is one. No further first effect is tried once the budget is spent.
pub(crate) fn pair(
    standing: &Judged,
    round: &Round,
    (beginnings, tests): (&TestSet, &TestSet),
    budget: &mut Budget<'_>,
    control: Control<'_>,
) -> Option<Pair> {
    let firsts = round.trials.iter().filter(|trial| trial.evidence.holdout_gain >= LEAST_GAIN);
    let mut found: Vec<Acceptable> = firsts
        .take(FIRSTS)
        .take_while(|_| !budget.is_spent())
        .enumerate()
        .filter_map(|(place, first)| {
            let name = round.tried[first.candidate].effect.name;
            let progress = |step: &Step<'_>| {
                let what = format!("with {name}: {}", step.what);
                (control.progress)(&Step { what: &what, round: step.round });
            };
            let control = Control { progress: &progress, ..control };
            let number = round.number + 1 + place;
            second(standing, round, first, (beginnings, tests), number, control)
        })
        .collect();
    found.sort_by(|a, b| {
        a.joint.judged.left_out.total_n2().total_cmp(&b.joint.judged.left_out.total_n2())
    });
    let best = found.first()?;
    let alike =
        |index: &usize| !distinguishable(&best.joint.judged, &found[*index].joint.judged, tests);
    let alike: Vec<usize> = (0..found.len()).filter(alike).collect();
    // The same order among equals as for one effect.
    let rank = |index: &usize| {
        let joint = &found[*index].joint;
        (remakes(standing, joint), joint.judged.fit().values.len(), *index)
    };
    let winner = alike.iter().copied().min_by_key(rank)?;
    let names = |index: usize| found[index].pair.accepted.each_ref().map(|effect| effect.name);
    let others: Vec<_> = alike.into_iter().filter(|i| *i != winner).map(names).collect();
    let mut pair = found.swap_remove(winner).pair;
    for other in others {
        add_alternatives(&mut pair.accepted, other);
    }
    Some(pair)
}

/// The second of two, if there is one for this first.
fn second(
    standing: &Judged,
    round: &Round,
    first: &Trial,
    (beginnings, tests): (&TestSet, &TestSet),
    number: usize,
    control: Control<'_>,
) -> Option<Acceptable> {
    let next = Round::run(&first.judged, &[], (beginnings, tests), number, control);
    let (winner, alternatives) = choose(&first.judged, &next.trials, &next.tried, tests)?;
    let second = &next.trials[winner];
    let joint = Trial {
        candidate: first.candidate,
        judged: second.judged.clone(),
        evidence: evidence(standing, &second.judged, tests),
    };
    let pairs = round.tried.len() * next.tried.len();
    let too_little = joint.evidence.holdout_gain < LEAST_JOINT_GAIN;
    if too_little || objection(standing, &joint, pairs, tests).is_some() {
        return None;
    }
    let name = |trial: &Trial| next.tried[trial.candidate].effect.name;
    let names = [round.tried[first.candidate].effect.name, name(second)];
    let accepted = [
        Accepted {
            name: names[0],
            evidence: joint.evidence.among(pairs),
            alternatives: Vec::new(),
            together_with: Some(names[1]),
        },
        Accepted {
            name: names[1],
            evidence: second.evidence.among(next.shown.len()),
            alternatives: alternatives.iter().map(|index| name(&next.trials[*index])).collect(),
            together_with: None,
        },
    ];
    let fit = second.judged.fit().clone();
    let second = next.tried[second.candidate].clone();
    Some(Acceptable { pair: Pair { accepted, fit, second }, joint })
}

/// Adds an effect of a pair that predicts as well as an alternative to the one it replaces.
fn add_alternatives(accepted: &mut [Accepted; 2], other: [&'static str; 2]) {
    let names = [accepted[0].name, accepted[1].name];
    for (place, shared) in [(0, names[1]), (1, names[0])] {
        let Some(at) = other.iter().position(|name| *name == shared) else { continue };
        let instead = other[1 - at];
        let alternatives = &mut accepted[place].alternatives;
        if instead != names[place] && !alternatives.contains(&instead) {
            alternatives.push(instead);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::Evidence;

    #[test]
    fn a_pair_that_shares_an_effect_is_an_alternative_to_the_other() {
        let evidence =
            Evidence { holdout_gain: 0.9, gain_in_band: 0.9, improved: 1.0, p_value: 1e-9 };
        let mut pair = ["seal_friction", "sensor_delay"].map(|name| Accepted {
            name,
            evidence,
            alternatives: Vec::new(),
            together_with: None,
        });
        add_alternatives(&mut pair, ["sensor_delay", "second_valve_stage"]);
        add_alternatives(&mut pair, ["sensor_delay", "seal_friction"]);
        add_alternatives(&mut pair, ["moving_mass", "entrained_air"]);
        assert_eq!(pair[0].alternatives, ["second_valve_stage"]);
        assert!(pair[1].alternatives.is_empty());
    }
}
