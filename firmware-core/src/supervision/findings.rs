//! What the checks of a rig have found: the first cause that ends a run, and what ends nothing.

use super::cause::{Cause, Signal};
use super::checks::Condition;
use super::rule::{Action, Rule, RuleState};

/// Something beyond a limit whose action is to log or to hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noted {
    /// The first of its kind: signal, value, limit and action.
    pub first: Cause,
    /// Cycle of the first one, counted from 0.
    pub first_cycle: u64,
    /// How often it was found: once in each cycle, or cycle of the motion.
    pub times: u64,
    /// Value of the largest magnitude.
    pub largest: f64,
}

/// What was found of one rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Findings {
    cause: Option<Cause>,
    /// The strongest action that any cause has asked for.
    action: Option<Action>,
    /// Whether a check whose action is to hold is beyond its limit in this cycle.
    holds: bool,
    /// Cycles judged.
    cycles: u64,
    /// What ended nothing, by signal.
    noted: [Option<Noted>; Signal::ALL.len()],
}

impl Default for Findings {
    /// Nothing found.
    fn default() -> Self {
        let noted = [None; Signal::ALL.len()];
        Self { cause: None, action: None, holds: false, cycles: 0, noted }
    }
}

impl Findings {
    /// The first cause that asks for an end.
    pub(super) fn cause(&self) -> Option<Cause> {
        self.cause
    }

    /// The strongest action that any cause has asked for.
    pub(super) fn action(&self) -> Option<Action> {
        self.action
    }

    /// Whether the last believed force is held in this cycle.
    pub(super) fn holds(&self) -> bool {
        self.holds
    }

    /// What ended nothing.
    pub(super) fn noted(&self) -> impl Iterator<Item = Noted> + '_ {
        self.noted.iter().flatten().copied()
    }

    /// A cycle is over.
    pub(super) fn end_cycle(&mut self) {
        self.holds = false;
        self.cycles += 1;
        debug_assert!(
            self.cause.is_none_or(|cause| cause.action > Action::Hold),
            "what is only logged or held ends nothing"
        );
    }

    /// Judges the value of a cycle by its rule.
    pub(super) fn on_rule(
        &mut self,
        rule: &Rule,
        state: &mut RuleState,
        signal: Signal,
        value: f64,
    ) {
        if let Some(action) = rule.take(state, value) {
            self.act(Cause { signal, value, limit: rule.limit, action });
        }
    }

    /// Judges a condition that has held for so many cycles in a row.
    pub(super) fn on_condition(&mut self, condition: Condition, cycles: u32, signal: Signal) {
        debug_assert!(condition.cycles > 0, "{signal:?} in no cycle");
        if cycles >= condition.cycles {
            let (value, limit) = (f64::from(cycles), f64::from(condition.cycles));
            self.act(Cause { signal, value, limit, action: condition.action });
        }
    }

    /// Does what a check asks for.
    pub(super) fn act(&mut self, cause: Cause) {
        if cause.action > Action::Hold {
            self.cause = self.cause.or(Some(cause));
            self.action = self.action.max(Some(cause.action));
            return;
        }
        self.holds |= cause.action == Action::Hold;
        let place = self.noted.get_mut(cause.signal as usize);
        debug_assert!(place.is_some(), "{:?} is none of the signals", cause.signal);
        let Some(place) = place else { return };
        let (first_cycle, largest) = (self.cycles, cause.value);
        let noted = place.get_or_insert(Noted { first: cause, first_cycle, times: 0, largest });
        noted.times += 1;
        if cause.value.abs() > noted.largest.abs() {
            noted.largest = cause.value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_keeps_its_first_cycle_its_number_and_the_largest_value() {
        let mut found = Findings::default();
        let cause = |value| Cause { signal: Signal::Work, value, limit: 1.0, action: Action::Log };
        for (cycle, value) in [2.0, -5.0, 3.0, 0.0].into_iter().enumerate() {
            if cycle < 3 {
                found.act(cause(value));
            }
            found.end_cycle();
        }
        let noted = Noted { first: cause(2.0), first_cycle: 0, times: 3, largest: -5.0 };
        assert!(found.noted().eq([noted]));
        assert_eq!((found.cause(), found.action()), (None, None));
    }

    #[test]
    fn a_hold_lasts_for_its_cycle_and_the_strongest_action_rules() {
        let mut found = Findings::default();
        let cause = |action| Cause { signal: Signal::Force, value: 2.0, limit: 1.0, action };
        found.act(cause(Action::Hold));
        assert!(found.holds());
        found.end_cycle();
        assert!(!found.holds());
        for action in [Action::RampOut, Action::PowerOff, Action::Stop] {
            found.act(cause(action));
        }
        assert_eq!(found.cause(), Some(cause(Action::RampOut)));
        assert_eq!(found.action(), Some(Action::PowerOff));
    }
}
