//! Motions that were computed ahead, until their time has come.

use crate::command::Command;
use crate::virtual_wear::MOST_AHEAD_CYCLES;

/// One for each cycle.
const KEPT: usize = MOST_AHEAD_CYCLES as usize + 1;

/// The last motions, a ring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ahead {
    kept: [Command; KEPT],
    newest: usize,
}

impl Default for Ahead {
    fn default() -> Self {
        Self::resting(Command::default())
    }
}

impl Ahead {
    /// Rest at one place.
    pub(super) const fn resting(command: Command) -> Self {
        Self { kept: [command; KEPT], newest: 0 }
    }

    /// Takes a motion that is wanted in so many cycles, and gives the one for now.
    pub(super) fn take(&mut self, command: Command, ahead_cycles: u8) -> Command {
        debug_assert!(ahead_cycles <= MOST_AHEAD_CYCLES, "{ahead_cycles} cycles ahead");
        self.newest = (self.newest + 1) % KEPT;
        if let Some(place) = self.kept.get_mut(self.newest) {
            *place = command;
        }
        let place = (self.newest + KEPT - usize::from(ahead_cycles) % KEPT) % KEPT;
        self.kept.get(place).copied().unwrap_or(command)
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
