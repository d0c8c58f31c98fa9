//! What stands between a received force and the vehicle, and what a rig gets when that breaks off.
//!
//! In the loop nothing is an error: a force that is missing, late or bad is an input state. The
//! guard holds the last good force, counts, and trips after a fixed number of cycles without a good
//! one. After that the rig gets a safe stop: bring the commanded motion to rest within a
//! deceleration, then hold the position.

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

/// Parameters of the guard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guard {
    /// Cycles without a good force after which it trips.
    pub patience_cycles: u32,
    /// Largest believable force (N).
    pub force_limit_n: f64,
}

impl Default for Guard {
    fn default() -> Self {
        Self { patience_cycles: 5, force_limit_n: 100.0e3 }
    }
}

/// What the guard of one slot remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GuardState {
    /// Last good force (N).
    pub force_n: f64,
    /// Cycles since it came.
    pub age_cycles: u32,
    /// Cycles without a frame.
    pub missing: u64,
    /// Cycles with a bad frame or an unbelievable force.
    pub invalid: u64,
    /// Whether it has tripped; it stays so.
    pub tripped: bool,
}

impl Guard {
    /// Takes what arrived and gives the force to use (N).
    ///
    /// ```
    /// use firmware_core::guard::{ForceInput, Guard, GuardState};
    /// let (guard, mut state) = (Guard::default(), GuardState::default());
    /// assert_eq!(guard.take(&mut state, ForceInput::Fresh(1.5e3)), 1.5e3);
    /// assert_eq!(guard.take(&mut state, ForceInput::Missing), 1.5e3);
    /// assert!(!state.tripped);
    /// ```
    pub fn take(&self, state: &mut GuardState, input: ForceInput) -> f64 {
        debug_assert!(self.force_limit_n >= 0.0, "a force limit below zero lets nothing pass");
        let was_tripped = state.tripped;
        match input {
            ForceInput::Fresh(force_n) if force_n.abs() <= self.force_limit_n => {
                state.force_n = force_n;
                state.age_cycles = 0;
            }
            ForceInput::Missing => {
                state.missing += 1;
                state.age_cycles = state.age_cycles.saturating_add(1);
            }
            ForceInput::Fresh(_) | ForceInput::Invalid => {
                state.invalid += 1;
                state.age_cycles = state.age_cycles.saturating_add(1);
            }
        }
        state.tripped |= state.age_cycles >= self.patience_cycles;
        debug_assert!(state.force_n.abs() <= self.force_limit_n, "a held force beyond the limit");
        debug_assert!(state.tripped || !was_tripped, "a guard that has tripped stays tripped");
        state.force_n
    }
}

/// Where a rig's command stands.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command {
    /// Displacement from mid-stroke (m).
    pub displacement_m: f64,
    /// Velocity (m/s).
    pub velocity_m_per_s: f64,
}

/// Deceleration of a safe stop (m/s2): 76 mm/s, the working point of the study, rests in 8 ms.
pub const STOP_DECELERATION_M_PER_S2: f64 = 10.0;

impl Command {
    /// Whether both numbers are finite.
    pub(crate) fn is_finite(self) -> bool {
        self.displacement_m.is_finite() && self.velocity_m_per_s.is_finite()
    }

    /// The command one cycle further into a safe stop, at the usual deceleration or the most that
    /// is allowed (m/s2).
    #[must_use]
    pub fn stopping(self, cycle_s: f64, most_m_per_s2: f64) -> Self {
        debug_assert!(cycle_s > 0.0 && cycle_s.is_finite(), "cycle of {cycle_s} s");
        debug_assert!(most_m_per_s2 > 0.0, "a stop at {most_m_per_s2} m/s2");
        let change = STOP_DECELERATION_M_PER_S2.min(most_m_per_s2) * cycle_s;
        let speed = (self.velocity_m_per_s.abs() - change).max(0.0);
        let velocity_m_per_s =
            if speed > 0.0 { libm::copysign(speed, self.velocity_m_per_s) } else { 0.0 };
        let mean = 0.5 * (self.velocity_m_per_s + velocity_m_per_s);
        // Within the last cycle it rests before the cycle is over.
        let share = if speed > 0.0 { 1.0 } else { (self.velocity_m_per_s.abs() / change).min(1.0) };
        Self { displacement_m: self.displacement_m + mean * share * cycle_s, velocity_m_per_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_trips_in_the_fifth_cycle_without_a_good_force_and_stays_tripped() {
        let (guard, mut state) = (Guard::default(), GuardState::default());
        guard.take(&mut state, ForceInput::Fresh(10.0));
        let bad = [
            ForceInput::Missing,
            ForceInput::Invalid,
            ForceInput::Fresh(f64::NAN),
            ForceInput::Fresh(1e9),
            ForceInput::Missing,
        ];
        for (count, input) in bad.into_iter().enumerate() {
            assert!(!state.tripped, "after {count} bad cycles");
            assert_eq!(guard.take(&mut state, input), 10.0);
        }
        assert!(state.tripped);
        assert_eq!((state.missing, state.invalid), (2, 3));
        guard.take(&mut state, ForceInput::Fresh(11.0));
        assert!(state.tripped);
    }

    #[test]
    fn a_safe_stop_rests_after_the_braking_distance_and_holds() {
        let mut command = Command { displacement_m: 0.01, velocity_m_per_s: -0.0765 };
        for _ in 0..20 {
            let next = command.stopping(1e-3, 20.0);
            assert!((next.velocity_m_per_s - command.velocity_m_per_s).abs() <= 0.010_000_1);
            command = next;
        }
        assert_eq!(command.velocity_m_per_s, 0.0);
        let distance = 0.0765 * 0.0765 / (2.0 * STOP_DECELERATION_M_PER_S2);
        assert!((command.displacement_m - (0.01 - distance)).abs() < 1e-12);
        assert_eq!(command, command.stopping(1e-3, 20.0));
    }
}
