//! The search: which effects are missing, one after the other.
//!
//! 1. Screen every candidate against the residual of the standing model ([`super::screening`]).
//! 2. Fit the best few together with all other parameters, in free-run simulation
//!    ([`super::trial`]).
//! 3. Accept the one with the smallest error on left-out pieces if it passes every test
//!    ([`super::acceptance`]), and name the alternatives that the records cannot distinguish from
//!    it.
//! 4. Refit the model with it ([`super::settling`]), give parameters that may share a value one
//!    where the model then predicts as well ([`super::sharing`]), and drop every earlier effect
//!    without which it does. Start again, up to four effects.
//! 5. Where no candidate is accepted and the residual is above the noise, look for two effects at
//!    once ([`super::pair`]).
//!
//! Pairs need many fits. Past a limit of work no further pair is tried, and after an accepted pair
//! nothing else is tried; past three times that limit no round begins. The result says so.

use super::acceptance::choose;
use super::budget::Budget;
use super::candidate::{Candidate, candidates};
use super::canonical::{canonical, with_idle_at_usual};
use super::control::Control;
use super::evidence::{LEAST_GAIN, evidence};
use super::finding::{Accepted, Findings, Outdone, Rejected};
use super::fit::{Effort, Fit, fit};
use super::grey_box::GreyBox;
use super::judged::Judged;
use super::pair::{Pair, pair};
use super::rejection::rejections;
use super::round::Round;
use super::settling::{BETTER_MINIMUM, settled};
use super::sharing::with_shared_values;
use super::start::{BEGINNING_S, NominalFit};
use super::test_set::TestSet;
use super::trial::Trial;

/// Most effects that are accepted.
const MOST_EFFECTS: usize = 4;
/// Most times that two are accepted at once.
const MOST_PAIRS: usize = MOST_EFFECTS / 2;

/// Searches from a fitted nominal model, for pairs up to `most_passes` over all tests. None where a
/// model cannot be judged, or where the work is stopped before the nominal model is.
pub fn search(
    nominal: NominalFit,
    tests: &TestSet,
    most_passes: f64,
    control: Control<'_>,
) -> Option<Findings> {
    let mut search = Search::start(nominal, tests, most_passes, control)?;
    loop {
        let round = search.next_round();
        let decision = search.decide(&round);
        if control.is_stopped() {
            return Some(search.interrupted());
        }
        let settled = match decision {
            Decision::Restart(better) => {
                search.restart(better);
                continue;
            }
            Decision::Accept(choice) => search.accept(&round, &choice),
            Decision::AcceptPair(pair) => search.accept_pair(pair),
            Decision::End => return Some(search.ended(&round)),
        };
        if settled.is_none() {
            return control.is_stopped().then(|| search.interrupted());
        }
    }
}

/// The state of a search between two rounds.
struct Search<'a> {
    tests: &'a TestSet,
    beginnings: TestSet,
    /// Other minima of the nominal damper.
    other_minima: Vec<Vec<f64>>,
    budget: Budget<'a>,
    control: Control<'a>,
    refitted: Judged,
    standing: Judged,
    accepted: Vec<Accepted>,
    outdone: Vec<Outdone>,
    pairs: usize,
    rounds: usize,
}

/// The consequence of a round.
enum Decision {
    /// The standing model has a better minimum: judge all candidates against that.
    Restart(Judged),
    /// One effect is missing.
    Accept(Choice),
    /// Two effects are missing.
    AcceptPair(Pair),
    /// Nothing more can be accepted.
    End,
}

/// Indices of the trial to accept and of those that cannot be distinguished from it.
struct Choice {
    winner: usize,
    alternatives: Vec<usize>,
}

impl<'a> Search<'a> {
    fn start(
        nominal: NominalFit,
        tests: &'a TestSet,
        most_passes: f64,
        control: Control<'a>,
    ) -> Option<Self> {
        let refitted = Judged::new(nominal.fit, tests)?;
        Some(Self {
            tests,
            beginnings: tests.beginnings(BEGINNING_S),
            other_minima: nominal.others,
            budget: Budget::new(tests, most_passes),
            control,
            standing: refitted.clone(),
            refitted,
            accepted: Vec::new(),
            outdone: Vec::new(),
            pairs: 0,
            rounds: 0,
        })
    }

    /// Tries the candidates on the standing model; past the limit of work they are screened only.
    fn next_round(&mut self) -> Round {
        let spent = (self.pairs > 0 && self.budget.is_spent()) || self.budget.is_far_exceeded();
        if self.rounds > 0 && spent {
            return Round::screened(&self.standing, self.tests, self.control);
        }
        self.rounds += 1;
        let sets = (&self.beginnings, self.tests);
        Round::run(&self.standing, &self.other_minima, sets, self.rounds, self.control)
    }

    fn decide(&mut self, round: &Round) -> Decision {
        if let Some(better) = self.better_minimum(&round.trials) {
            return Decision::Restart(better);
        }
        if self.has_room_for(1)
            && let Some((winner, alternatives)) =
                choose(&self.standing, &round.trials, &round.tried, self.tests)
        {
            return Decision::Accept(Choice { winner, alternatives });
        }
        let pairs_open = self.has_room_for(2) && self.pairs < MOST_PAIRS;
        let sets = (&self.beginnings, self.tests);
        if pairs_open
            && round.above_noise
            && let Some(pair) = pair(&self.standing, round, sets, &mut self.budget, self.control)
        {
            return Decision::AcceptPair(pair);
        }
        Decision::End
    }

    fn has_room_for(&self, effects: usize) -> bool {
        self.accepted.len() + effects <= MOST_EFFECTS
    }

    /// The standing model from the parameters of the best trial, if its error is smaller there: the
    /// gain of a better minimum is not the gain of an effect.
    fn better_minimum(&self, trials: &[Trial]) -> Option<Judged> {
        let before = self.standing.fit();
        let seen = |trial: &&Trial| trial.judged.fit().total_n2();
        let best = trials.iter().min_by(|a, b| seen(a).total_cmp(&seen(b)))?;
        let values = best.judged.fit().values.get(..before.values.len())?;
        let again = fit(&before.model, values, self.tests, Effort::FULL, self.control)?;
        let better = again.total_n2() < (1.0 - BETTER_MINIMUM) * before.total_n2();
        if better { Judged::new(again, self.tests) } else { None }
    }

    fn restart(&mut self, better: Judged) {
        debug_assert!(better.fit().total_n2() < self.standing.fit().total_n2());
        if self.accepted.is_empty() {
            self.refitted = better.clone();
        }
        self.standing = better;
    }

    fn accept(&mut self, round: &Round, choice: &Choice) -> Option<()> {
        let winner = &round.trials[choice.winner];
        let candidate = &round.tried[winner.candidate];
        let name = |trial: &Trial| round.tried[trial.candidate].effect.name;
        self.control.report(&format!("settling {}", name(winner)));
        let new = Accepted {
            name: name(winner),
            evidence: winner.evidence.among(round.shown.len()),
            alternatives: choice.alternatives.iter().map(|i| name(&round.trials[*i])).collect(),
            together_with: None,
        };
        self.settle(winner.judged.fit(), candidate, [new])?;
        let others = round.trials.iter().filter(|other| other.candidate != winner.candidate);
        self.outdone.extend(others.map(|other| Outdone {
            name: name(other),
            gain: other.evidence.holdout_gain,
            by: name(winner),
            gain_of_other: winner.evidence.holdout_gain,
        }));
        Some(())
    }

    fn accept_pair(&mut self, pair: Pair) -> Option<()> {
        let [first, second] = pair.accepted.each_ref().map(|effect| effect.name);
        self.control.report(&format!("settling {first} and {second}"));
        self.settle(&pair.fit, &pair.second, pair.accepted)?;
        self.pairs += 1;
        Some(())
    }

    /// Takes over a model with newly accepted effects: refitted to its minimum, and without the
    /// effects that the new ones have made idle. Changes nothing where the work is stopped.
    fn settle<const N: usize>(
        &mut self,
        fit: &Fit,
        candidate: &Candidate,
        new: [Accepted; N],
    ) -> Option<()> {
        let settled = settled(fit, candidate, self.tests, self.control)?;
        let standing = Judged::new(canonical(settled, self.tests), self.tests)?;
        let standing = with_idle_at_usual(standing, self.tests);
        let standing = with_shared_values(standing, self.tests, self.control);
        let accepted = self.accepted.iter().cloned().chain(new).collect();
        let (standing, accepted) = without_idle(standing, accepted, self.tests, self.control);
        if self.control.is_stopped() {
            return None;
        }
        debug_assert!(accepted.len() <= MOST_EFFECTS);
        debug_assert!(
            accepted.iter().map(|effect| effect.name).eq(names_of(&standing.fit().model)),
            "the accepted effects are those of the model, in its order"
        );
        (self.standing, self.accepted) = (standing, accepted);
        Some(())
    }

    /// The findings after a last round in which nothing was accepted.
    fn ended(self, round: &Round) -> Findings {
        let rejected = rejections(&self.standing, round, &self.outdone, self.tests);
        let not_testable = round.unseen().cloned().collect();
        Findings {
            refitted: self.refitted,
            with_effects: self.standing,
            accepted: self.accepted,
            rejected,
            not_testable,
            cut_short: self.budget.has_cut_short(),
            interrupted: false,
        }
    }

    /// The findings of the rounds so far. Every candidate that is still open is rejected as such.
    fn interrupted(self) -> Findings {
        let open = candidates(&self.standing.fit().model, self.tests);
        let rejected = open.iter().map(|candidate| Rejected {
            name: candidate.effect.name,
            why: "the search was interrupted before this effect was judged".to_owned(),
            holdout_gain: None,
        });
        Findings {
            rejected: rejected.collect(),
            refitted: self.refitted,
            with_effects: self.standing,
            accepted: self.accepted,
            not_testable: Vec::new(),
            cut_short: self.budget.has_cut_short(),
            interrupted: true,
        }
    }
}

fn names_of(model: &GreyBox) -> impl Iterator<Item = &'static str> {
    model.effects.iter().map(|effect| effect.name)
}

/// Drops every effect but the newest without which the model predicts as well: a later effect may
/// explain what an earlier one was accepted for.
fn without_idle(
    mut standing: Judged,
    mut accepted: Vec<Accepted>,
    tests: &TestSet,
    control: Control<'_>,
) -> (Judged, Vec<Accepted>) {
    let mut index = 0;
    while index + 1 < accepted.len() {
        control.report(&format!("without {}", accepted[index].name));
        if let Some(simpler) = as_good_without(index, &standing, tests, control) {
            standing = simpler;
            accepted.remove(index);
        } else {
            index += 1;
        }
    }
    (standing, accepted)
}

/// The model without one of its effects, if that effect gains too little.
fn as_good_without(
    index: usize,
    standing: &Judged,
    tests: &TestSet,
    control: Control<'_>,
) -> Option<Judged> {
    let fitted = standing.fit();
    let (model, values) = fitted.with_effects_kept(|k| k != index, &tests.scale);
    let without = Judged::new(fit(&model, &values, tests, Effort::FULL, control)?, tests)?;
    let gain = evidence(&without, standing, tests).holdout_gain;
    let seen_gain = 1.0 - fitted.total_n2() / without.fit().total_n2();
    (gain < LEAST_GAIN || seen_gain < LEAST_GAIN).then_some(without)
}
