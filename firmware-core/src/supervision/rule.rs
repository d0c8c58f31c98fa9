//! A limit on a signal: how far, for how long, and what happens then.
//!
//! A rule trips when its signal is beyond its limit in `debounce_cycles` cycles in a row. A value
//! that is no number is beyond every limit. Once it has tripped it stays so.

/// What a tripped rule asks for, the mildest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Action {
    /// It is written down.
    Log,
    /// The last believed value is held while the signal is beyond its limit.
    Hold,
    /// The run ends in order.
    RampOut,
    /// Motion stops at once; the rig holds its position.
    Stop,
    /// Motion stops, and the rig is asked to switch its power off: its position is not believed.
    PowerOff,
}

impl Action {
    /// All actions.
    pub const ALL: [Self; 5] = [Self::Log, Self::Hold, Self::RampOut, Self::Stop, Self::PowerOff];

    /// Its name in a scenario.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Log => "log",
            Self::Hold => "hold",
            Self::RampOut => "ramp out",
            Self::Stop => "stop",
            Self::PowerOff => "power off",
        }
    }
}

/// A limit with its debounce and its action.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rule {
    /// Largest magnitude that is believed, in the unit of the signal.
    pub limit: f64,
    /// Cycles in a row beyond it, at least 1.
    pub debounce_cycles: u32,
    /// What happens then.
    pub action: Action,
}

/// What a rule remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RuleState {
    /// Cycles in a row beyond the limit.
    beyond_cycles: u32,
    /// Largest magnitude so far; values that are no number count as infinite. None before the first
    /// value.
    largest: Option<f64>,
    /// Value at which it tripped.
    tripped_at: Option<f64>,
}

impl Rule {
    /// Takes the value of a cycle; gives the action while the rule is tripped, or while it holds.
    /// A rule that holds does so from the first cycle beyond its limit.
    ///
    /// ```
    /// use firmware_core::supervision::{Action, Rule, RuleState};
    /// let rule = Rule { limit: 20e3, debounce_cycles: 2, action: Action::RampOut };
    /// let mut state = RuleState::default();
    /// assert_eq!(rule.take(&mut state, -21e3), None);
    /// assert_eq!(rule.take(&mut state, 22e3), Some(Action::RampOut));
    /// // Tripped stays tripped.
    /// assert_eq!(rule.take(&mut state, 0.0), Some(Action::RampOut));
    /// assert_eq!(state.tripped_at(), Some(22e3));
    /// ```
    pub fn take(&self, state: &mut RuleState, value: f64) -> Option<Action> {
        debug_assert!(self.debounce_cycles > 0, "a rule without a cycle trips on nothing");
        debug_assert!(self.limit >= 0.0, "a limit of {} lets nothing pass", self.limit);
        let magnitude = if value.is_nan() { f64::INFINITY } else { value.abs() };
        state.largest = Some(state.largest.map_or(magnitude, |before| before.max(magnitude)));
        let is_beyond = magnitude > self.limit;
        state.beyond_cycles = if is_beyond { state.beyond_cycles.saturating_add(1) } else { 0 };
        if state.tripped_at.is_none() && state.beyond_cycles >= self.debounce_cycles {
            state.tripped_at = Some(value);
        }
        match self.action {
            Action::Hold => is_beyond.then_some(Action::Hold),
            Action::Log => (state.beyond_cycles >= self.debounce_cycles).then_some(Action::Log),
            action => state.tripped_at.map(|_| action),
        }
    }
}

impl RuleState {
    /// The value at which it tripped.
    pub fn tripped_at(&self) -> Option<f64> {
        self.tripped_at
    }

    /// The largest magnitude so far, tripped or not; none before the first value.
    pub fn largest(&self) -> Option<f64> {
        self.largest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULE: Rule = Rule { limit: 1.0, debounce_cycles: 3, action: Action::Stop };

    fn trips_at(values: &[f64]) -> Option<usize> {
        let mut state = RuleState::default();
        values.iter().position(|value| RULE.take(&mut state, *value).is_some())
    }

    #[test]
    fn it_trips_in_the_third_cycle_in_a_row() {
        assert_eq!(trips_at(&[2.0, -2.0, 2.0]), Some(2));
        assert_eq!(trips_at(&[2.0, 2.0, 0.0, 2.0, 2.0, 0.0]), None);
        // The limit itself is within it.
        assert_eq!(trips_at(&[1.0, 1.0, 1.0, 1.0]), None);
        let mut state = RuleState::default();
        for value in [2.0, -3.0, 4.0, 5.0] {
            RULE.take(&mut state, value);
        }
        assert_eq!((state.tripped_at(), state.largest()), (Some(4.0), Some(5.0)));
    }

    #[test]
    fn no_number_is_beyond_every_limit() {
        assert_eq!(trips_at(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY]), Some(2));
        let mut state = RuleState::default();
        RULE.take(&mut state, f64::NAN);
        assert_eq!(state.largest(), Some(f64::INFINITY));
    }

    #[test]
    fn a_hold_ends_with_its_cause() {
        let hold = Rule { action: Action::Hold, ..RULE };
        let mut state = RuleState::default();
        let held = [0.0, 2.0, 0.0, 2.0].map(|value| hold.take(&mut state, value).is_some());
        assert_eq!(held, [false, true, false, true]);
    }

    #[test]
    fn what_is_logged_ends_with_its_cause_and_waits_for_its_debounce() {
        let log = Rule { action: Action::Log, ..RULE };
        let mut state = RuleState::default();
        let logged =
            [2.0, 2.0, 2.0, 2.0, 0.0, 2.0].map(|value| log.take(&mut state, value).is_some());
        assert_eq!(logged, [false, false, true, true, false, false]);
    }

    #[test]
    fn actions_are_ordered_by_what_they_do() {
        assert!(Action::ALL.is_sorted());
        assert_eq!(
            Action::ALL.map(Action::name).join(", "),
            "log, hold, ramp out, stop, power off"
        );
    }
}
