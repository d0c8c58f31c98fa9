//! Motions that were computed ahead, until their time has come.

use crate::command::Command;
use crate::ring::Ring;
use crate::virtual_wear::MOST_AHEAD_CYCLES;

/// The last motions, one for each cycle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ahead(Ring<Command, { MOST_AHEAD_CYCLES as usize + 1 }>);

impl Ahead {
    /// Rest at one place.
    pub(super) const fn resting(command: Command) -> Self {
        Self(Ring::filled(command))
    }

    /// Takes a motion that is wanted in so many cycles, and gives the one for now.
    pub(super) fn take(&mut self, command: Command, ahead_cycles: u8) -> Command {
        debug_assert!(ahead_cycles <= MOST_AHEAD_CYCLES, "{ahead_cycles} cycles ahead");
        self.0.keep(command);
        self.0.ago(usize::from(ahead_cycles)).unwrap_or(command)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_comes_out_after_as_many_cycles_as_it_was_ahead() {
        let at = |displacement_m: f64| Command { displacement_m, velocity_m_per_s: 0.0 };
        for ahead_cycles in [0, 1, 7, MOST_AHEAD_CYCLES] {
            let mut ahead = Ahead::resting(at(-1.0));
            for cycle in 0..200 {
                let now = ahead.take(at(f64::from(cycle)), ahead_cycles);
                let expected = cycle - i32::from(ahead_cycles);
                assert_eq!(now, at(if expected < 0 { -1.0 } else { f64::from(expected) }));
            }
        }
    }
}
