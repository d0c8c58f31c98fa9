//! The second net of a rig, behind CRC and counter: no command steps further than the ram may go.
//!
//! ```text
//! |x - x_last| <= v_max n T,    n: commands since the last one that was followed, at most 5
//! ```
//! `v_max` is the agreed limit. Before a first command `x_last` is where the ram stands, and `n` is
//! 5. A command that steps further is not followed: the reference runs on as if none had come, and
//! the watchdog is not fed. Two of them in a row are no accident.

use can_protocol::arming::Limits;

/// Commands that may be lost between two that are followed.
const MOST_PERIODS: u32 = 5;
/// Refused commands in a row after which the rig goes safe.
const MOST_IN_A_ROW: u32 = 2;
/// Rounding of a displacement in a frame, twice, and of the measured one that a host begins from
/// (m).
const ROUNDING_M: f64 = 2e-6;

/// What a rig remembers of the commands that it has followed.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct StepNet {
    /// The furthest that the ram may go in a period (m).
    period_m: f64,
    /// Cycle of the sender and displacement of the last command that was followed (m).
    last: Option<(u32, f64)>,
    in_a_row: u32,
}

impl StepNet {
    /// That of a session with these limits and a period (s).
    pub(super) fn new(agreed: Limits, period_s: f64) -> Self {
        debug_assert!(period_s > 0.0, "a period of {period_s} s");
        let velocity_m_per_s = f64::from(agreed.velocity_um_per_s) * 1e-6;
        Self { period_m: velocity_m_per_s * period_s, ..Self::default() }
    }

    /// Judges a command by its cycle and its displacement, for a ram that stands at `stands_m`
    /// before the first one. Its step in multiples of the allowed one, where it goes too far.
    pub(super) fn refuses(&mut self, cycle: u32, x_m: f64, stands_m: f64) -> Option<f64> {
        let (n, from_m) = match self.last {
            Some((last, last_m)) => (cycle.saturating_sub(last).clamp(1, MOST_PERIODS), last_m),
            None => (MOST_PERIODS, stands_m),
        };
        let step_m = (x_m - from_m).abs();
        let allowed_m = self.period_m * f64::from(n) + ROUNDING_M;
        if step_m <= allowed_m {
            (self.last, self.in_a_row) = (Some((cycle, x_m)), 0);
            return None;
        }
        self.in_a_row = self.in_a_row.saturating_add(1);
        Some(step_m / allowed_m)
    }

    /// Whether so many in a row were refused that the rig is to go safe.
    pub(super) fn is_torn(&self) -> bool {
        self.in_a_row >= MOST_IN_A_ROW
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0.5 mm in a period of 1 ms.
    fn net() -> StepNet {
        let limits = Limits {
            stroke_um: 100_000,
            velocity_um_per_s: 500_000,
            acceleration_mm_per_s2: 20_000,
            force_n: 30_000,
        };
        StepNet::new(limits, 1e-3)
    }

    #[test]
    fn a_step_counts_from_the_last_command_that_was_followed() {
        let mut net = net();
        assert_eq!(net.refuses(0, 20.0e-3, 20.1e-3), None);
        assert_eq!(net.refuses(1, 20.5e-3, 0.0), None);
        assert!(net.refuses(2, 21.1e-3, 0.0).is_some());
        // The host goes on where it was: two periods later, two steps.
        assert_eq!(net.refuses(3, 21.5e-3, 0.0), None);
        // Four were lost: five steps, and no more after ten.
        assert_eq!(net.refuses(8, 24.0e-3, 0.0), None);
        assert!(net.refuses(18, 27.0e-3, 0.0).is_some_and(|times| times < 1.3));
        assert!(!net.is_torn());
    }

    #[test]
    fn a_first_command_begins_near_the_ram() {
        assert_eq!(net().refuses(7, 2.4e-3, 0.0), None);
        assert!(net().refuses(7, 2.6e-3, 0.0).is_some());
    }

    #[test]
    fn two_in_a_row_tear_it() {
        let mut net = net();
        for (cycle, x_m, is_torn) in
            [(0, 0.0, false), (1, 9e-3, false), (2, 0.0, false), (3, 9e-3, false), (4, 9e-3, true)]
        {
            net.refuses(cycle, x_m, 0.0);
            assert_eq!(net.is_torn(), is_torn, "{cycle}");
        }
    }
}
