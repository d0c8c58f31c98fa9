//! Two effects at once.
//!
//! An effect may help only where another one is there too: alone it mends some tests and spoils others, as
//! each of two that pull the same parameter in different directions does. Where no candidate is accepted
//! alone and the residual is far above its noise, the best few are taken on trial one after the other, with
//! a whole round on each. A pair is accepted when
//!
//! - the second is accepted on top of the first by the usual rules ([`super::acceptance`]);
//! - both together are accepted on top of the standing model by the same rules, with every ordered pair of
//!   candidates counted against the significance;
//! - both together take away at least half of the squared error on left-out pieces.
//!
//! Pairs that predict equally well are told as alternatives, one effect at a time. No further first is taken on
//! trial past a limit of work.

use super::acceptance::{choose, objection, remakes, told_apart};
use super::candidate::Candidate;
use super::fit::Fit;
use super::round::Round;
use super::search::{Accepted, Progress, corrected};
use super::tests_at_hand::TestsAtHand;
use super::trial::{Judged, LEAST_GAIN, Trial, evidence};

/// Candidates that are taken on trial as the first of two.
const FIRSTS: usize = 3;
/// Share of the squared error on left-out pieces that two together have to take away. Two effects can bend
/// themselves to much; what is neither of them leaves the better half.
const LEAST_JOINT_GAIN: f64 = 0.5;

/// Two effects of which neither was accepted alone.
pub struct Pair {
    /// The effects, in the order of the model.
    pub accepted: [Accepted; 2],
    /// The model with both, near its bottom.
    pub fit: Fit,
    /// The second of them as it was tried.
    pub second: Candidate,
}

/// A pair that nothing speaks against.
struct Found {
    pair: Pair,
    /// Both against the standing model.
    joint: Trial,
}

/// The pair to accept, if there is one. No first is tried `at_the_limit` of work; `progress` is told what is
/// being done.
pub fn pair(
    standing: &Judged,
    round: &Round,
    (beginnings, tests): (&TestsAtHand, &TestsAtHand),
    at_the_limit: &mut dyn FnMut() -> bool,
    progress: Progress<'_>,
) -> Option<Pair> {
    let firsts = round.trials.iter().filter(|trial| trial.evidence.holdout_gain >= LEAST_GAIN);
    let mut found: Vec<Found> = firsts
        .take(FIRSTS)
        .take_while(|_| !at_the_limit())
        .filter_map(|first| {
            let name = round.tried[first.candidate].effect.name;
            let told = |what: &str| progress(&format!("with {name}: {what}"));
            second(standing, round, first, (beginnings, tests), &told)
        })
        .collect();
    found.sort_by(|a, b| {
        a.joint.judged.left_out.total_n2().total_cmp(&b.joint.judged.left_out.total_n2())
    });
    let best = found.first()?;
    let alike = |index: &usize| !told_apart(&best.joint.judged, &found[*index].joint.judged, tests);
    let alike: Vec<usize> = (0..found.len()).filter(alike).collect();
    // The same order among equals as for one effect.
    let rank = |index: &usize| {
        let joint = &found[*index].joint;
        (remakes(standing, joint), joint.judged.standing.fit.values.len(), *index)
    };
    let winner = alike.iter().copied().min_by_key(rank)?;
    let names = |index: usize| found[index].pair.accepted.each_ref().map(|effect| effect.name);
    let others: Vec<_> = alike.into_iter().filter(|i| *i != winner).map(names).collect();
    let mut pair = found.swap_remove(winner).pair;
    for other in others {
        tell_beside(&mut pair.accepted, other);
    }
    Some(pair)
}

/// The second of two, if there is one for this first.
fn second(
    standing: &Judged,
    round: &Round,
    first: &Trial,
    (beginnings, tests): (&TestsAtHand, &TestsAtHand),
    progress: Progress<'_>,
) -> Option<Found> {
    let next = Round::of(&first.judged, &[], beginnings, tests, progress);
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
            evidence: corrected(&joint.evidence, pairs),
            alternatives: Vec::new(),
            together_with: Some(names[1]),
        },
        Accepted {
            name: names[1],
            evidence: corrected(&second.evidence, next.shown.len()),
            alternatives: alternatives.iter().map(|index| name(&next.trials[*index])).collect(),
            together_with: None,
        },
    ];
    let fit = second.judged.standing.fit.clone();
    let second = next.tried[second.candidate].clone();
    Some(Found { pair: Pair { accepted, fit, second }, joint })
}

/// Tells what a pair that predicts as well has in the place of one of the two.
fn tell_beside(accepted: &mut [Accepted; 2], other: [&'static str; 2]) {
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
    use crate::trial::Evidence;

    #[test]
    fn pair_that_shares_an_effect_tells_an_alternative_to_the_other() {
        let evidence = Evidence { holdout_gain: 0.9, improved: 1.0, p_value: 1e-9 };
        let mut pair = ["seal_friction", "sensor_delay"].map(|name| Accepted {
            name,
            evidence,
            alternatives: Vec::new(),
            together_with: None,
        });
        tell_beside(&mut pair, ["sensor_delay", "second_valve_stage"]);
        tell_beside(&mut pair, ["sensor_delay", "seal_friction"]);
        tell_beside(&mut pair, ["moving_mass", "entrained_air"]);
        assert_eq!(pair[0].alternatives, ["second_valve_stage"]);
        assert!(pair[1].alternatives.is_empty());
    }
}
