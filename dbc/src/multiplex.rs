//! Multiplexed signals: one is in a frame only if another one, its selector, has certain values.
//!
//! A selector may itself be multiplexed (extended multiplexing, `SG_MUL_VAL_`), so that a signal
//! has a chain of conditions. All of them have to hold.

use crate::field::Field;

/// Longest chain.
pub(crate) const MOST_CONDITIONS: usize = 4;

/// Most ranges of values of one selector.
pub(crate) const MOST_RANGES: usize = 8;

/// A selector and the values with which a signal is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Condition {
    pub(crate) selector: Field,
    /// First and last value of each range; the rest are empty.
    pub(crate) ranges: [Option<(u64, u64)>; MOST_RANGES],
}

impl Condition {
    fn holds(&self, data: &[u8]) -> bool {
        let Some(value) = self.selector.get(data) else { return false };
        self.ranges.iter().flatten().any(|(first, last)| (*first..=*last).contains(&value))
    }

    /// Whether no value of the same selector meets both.
    fn excludes(&self, other: &Self) -> bool {
        let is_common = |(first, last): &(u64, u64)| {
            let mut ranges = other.ranges.iter().flatten();
            ranges.any(|(other_first, other_last)| first <= other_last && other_first <= last)
        };
        self.selector == other.selector && !self.ranges.iter().flatten().any(is_common)
    }
}

/// When a signal is in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Presence {
    pub(crate) conditions: [Option<Condition>; MOST_CONDITIONS],
}

impl Presence {
    /// Whether it is in this payload.
    pub(crate) fn is_in(&self, data: &[u8]) -> bool {
        self.conditions.iter().flatten().all(|condition| condition.holds(data))
    }

    /// Whether no frame meets both.
    pub(crate) fn excludes(&self, other: &Self) -> bool {
        let mut conditions = self.conditions.iter().flatten();
        conditions.any(|one| other.conditions.iter().flatten().any(|other| one.excludes(other)))
    }

    /// Sets the selectors so that it is: each to the first of its values.
    pub(crate) fn select(&self, data: &mut [u8]) {
        for condition in self.conditions.iter().flatten() {
            if let Some((first, _)) = condition.ranges.iter().flatten().next()
                && !condition.holds(data)
            {
                condition.selector.set(data, *first & condition.selector.ones());
            }
        }
    }

    /// Whether it is in every frame of its message.
    pub(crate) fn is_always(&self) -> bool {
        self.conditions.iter().all(Option::is_none)
    }
}
