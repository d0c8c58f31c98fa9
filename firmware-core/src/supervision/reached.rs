//! How far a signal has come towards its limit.
//!
//! ```text
//! margin = 1 - |largest| / limit
//! ```
//! A signal may be beyond its limit for fewer cycles than its debounce has: then its margin is
//! negative, and nothing has tripped.

use super::cause::Signal;
use super::rule::{Action, Rule, RuleState};

/// The largest value of a signal, next to its limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    /// Key of the check in a scenario.
    pub key: &'static str,
    /// Unit of both values; none for a share.
    pub unit: Option<&'static str>,
    /// The largest magnitude; none where the signal was never there.
    pub largest: Option<f64>,
    /// The limit.
    pub limit: f64,
    /// Whether it was beyond the limit for as long as the check asks for.
    pub has_tripped: bool,
    /// What follows then; none of a limit that is not a check of a rig.
    pub action: Option<Action>,
}

impl Reached {
    /// Checks of a rig that have a limit.
    pub const COUNT: usize = 14;

    /// Of a rule.
    pub(super) fn of_rule(signal: Signal, rule: &Rule, state: &RuleState) -> Self {
        Self {
            key: signal.key(),
            unit: signal.unit(),
            largest: state.largest(),
            limit: rule.limit,
            has_tripped: state.tripped_at().is_some(),
            action: Some(rule.action),
        }
    }

    /// Of a share.
    pub(super) fn of_share(
        key: &'static str,
        largest: Option<f64>,
        limit: f64,
        action: Action,
    ) -> Self {
        let has_tripped = largest.is_some_and(|largest| largest > limit);
        Self { key, unit: None, largest, limit, has_tripped, action: Some(action) }
    }

    /// Of a number of cycles.
    pub(super) fn of_count(key: &'static str, largest: f64, limit: f64, action: Action) -> Self {
        let has_tripped = largest > limit;
        let action = Some(action);
        Self { key, unit: Some("cycles"), largest: Some(largest), limit, has_tripped, action }
    }

    /// What is left of the limit, as a share of it; none where nothing was measured or the limit is
    /// zero or infinite.
    ///
    /// ```
    /// use firmware_core::supervision::{Belief, Checks};
    /// let nothing = Belief::default().reached(&Checks::usual(15, 1e-3, 40e3));
    /// assert!(nothing.iter().all(|reached| reached.margin().is_none_or(|margin| margin == 1.0)));
    /// ```
    pub fn margin(&self) -> Option<f64> {
        let is_scale = self.limit > 0.0 && self.limit.is_finite();
        self.largest.filter(|_| is_scale).map(|largest| 1.0 - largest / self.limit)
    }
}
