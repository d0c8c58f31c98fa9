//! The last believed force of a rig: what the vehicle feels while no new one comes.
//!
//! In the loop nothing is an error: a force that is missing, late or bad is an input state. The
//! guard holds the last good force. What is good, and for how long it may be held, is judged before
//! ([`Belief`](crate::supervision::Belief)).

/// What arrived for a slot since the last cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ForceInput {
    /// A new, checked force (N).
    Fresh(f64),
    /// Nothing.
    Missing,
    /// Something that failed a check, or a rig that says its force is invalid.
    Invalid,
}

/// The last believed force of a slot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guard {
    /// The force (N); zero before the first one.
    pub force_n: f64,
}

impl Default for Guard {
    fn default() -> Self {
        Self::NEW
    }
}

impl Guard {
    /// Nothing has happened yet.
    pub(crate) const NEW: Self = Self { force_n: 0.0 };

    /// Takes what arrived and gives the force to use (N). One that is no number is not used.
    ///
    /// ```
    /// use firmware_core::guard::{ForceInput, Guard};
    /// let mut guard = Guard::default();
    /// assert_eq!(guard.take(ForceInput::Fresh(1.5e3)), 1.5e3);
    /// for bad in [ForceInput::Missing, ForceInput::Invalid, ForceInput::Fresh(f64::NAN)] {
    ///     assert_eq!(guard.take(bad), 1.5e3);
    /// }
    /// ```
    pub fn take(&mut self, input: ForceInput) -> f64 {
        if let ForceInput::Fresh(force_n) = input
            && force_n.is_finite()
        {
            self.force_n = force_n;
        }
        self.force_n
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_is_held_until_the_next_that_is_a_number() {
        let mut guard = Guard::default();
        assert_eq!(guard.take(ForceInput::Missing), 0.0);
        assert_eq!(guard.take(ForceInput::Fresh(1.5e3)), 1.5e3);
        for bad in [ForceInput::Missing, ForceInput::Invalid, ForceInput::Fresh(f64::NAN)] {
            assert_eq!(guard.take(bad), 1.5e3);
        }
        assert_eq!(guard.take(ForceInput::Fresh(-2.0)), -2.0);
    }
}
