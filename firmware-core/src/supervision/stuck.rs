//! A sensor that has frozen.
//!
//! A live sensor has noise: its raw code changes nearly every cycle. A frozen one repeats the same
//! code while the ram moves. Zero force inside the clearance of a damper is no freeze: its code
//! still flickers.
//!
//! ```text
//! stuck    the same code for 20 cycles in which |v| > v_min, and for longer than four times the
//!          longest run of equal codes in motion before
//! ```
//!
//! The second condition learns the sensor: one with a coarse resolution repeats codes by itself,
//! and one without noise (an ideal emulator) repeats zero through a clearance. Such a sensor counts
//! as stuck only at a code other than the one it rests at.
//!
//! Limits: a freeze while the ram stands still is seen when it moves again.

/// Cycles in motion with one code, where nothing else is stated.
pub const FEWEST_CYCLES: u32 = 20;
/// Multiple of the longest run before.
const LONGER: u32 = 4;
/// Cycles in motion after which the longest run is known.
const KNOWN_CYCLES: u32 = 500;

/// What the detector of one sensor remembers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Stuck {
    code: Option<u64>,
    run_cycles: u32,
    longest_cycles: u32,
    moving_cycles: u32,
    reported: bool,
}

impl Stuck {
    /// Takes the raw code of a cycle; true while the sensor counts as stuck.
    ///
    /// `fewest` is the number of cycles in motion with one code from which on it may; `resting` is
    /// the code that it shows without a load, at which a sensor without noise may stay; `moves`
    /// says whether the ram is fast enough to change it.
    ///
    /// ```
    /// use firmware_core::supervision::{FEWEST_CYCLES, Stuck};
    /// let mut stuck = Stuck::default();
    /// let noisy = (0..600).any(|n| stuck.take(FEWEST_CYCLES, 1000 + n % 7, 0, true));
    /// let frozen = (0..40).position(|_| stuck.take(FEWEST_CYCLES, 1234, 0, true));
    /// assert_eq!((noisy, frozen), (false, Some(19)));
    /// ```
    pub fn take(&mut self, fewest: u32, code: u64, resting: u64, moves: bool) -> bool {
        if self.code != Some(code) {
            // The run that made the sensor count as stuck is no measure of a live one.
            if !self.reported {
                self.longest_cycles = self.longest_cycles.max(self.run_cycles);
            }
            (self.code, self.run_cycles) = (Some(code), 0);
        }
        if moves {
            self.run_cycles = self.run_cycles.saturating_add(1);
            self.moving_cycles = self.moving_cycles.saturating_add(1);
        }
        let has_noise = self.moving_cycles >= KNOWN_CYCLES && self.longest_cycles < fewest;
        let enough = fewest.max(LONGER.saturating_mul(self.longest_cycles));
        let at_rest = code == resting && !has_noise;
        self.reported = self.run_cycles >= enough && !at_rest;
        self.reported
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cycle in which a sensor counts as stuck that freezes in a given cycle.
    fn stuck_after(freeze: usize, code: impl Fn(usize) -> u64) -> Option<usize> {
        let mut stuck = Stuck::default();
        (0..5000).position(|n| stuck.take(FEWEST_CYCLES, code(n.min(freeze)), 0, true))
    }

    /// A force of 16 kN in steps of 0.2 N at 3.5 Hz, with a flicker of one code.
    fn force(n: usize) -> u64 {
        let wave = 80_000.0 * libm::sin(0.022 * n as f64);
        (wave as i64 + (n * n % 3) as i64) as u64
    }

    #[test]
    fn a_live_sensor_is_never_stuck() {
        assert_eq!(stuck_after(5000, force), None);
        // The rest inside a clearance flickers too.
        assert_eq!(
            stuck_after(5000, |n| if (n / 100).is_multiple_of(2) {
                (n % 3) as u64
            } else {
                force(n)
            }),
            None
        );
    }

    #[test]
    fn a_frozen_sensor_is_found_after_twenty_cycles() {
        assert_eq!(stuck_after(1000, force), Some(1019));
        // Frozen at zero: the flicker is lost.
        assert_eq!(stuck_after(1000, |n| if n == 1000 { 0 } else { force(n) }), Some(1019));
    }

    #[test]
    fn a_sensor_without_noise_may_rest_in_its_clearance_and_may_not_freeze_elsewhere() {
        let ideal = |n: usize| if (n / 60).is_multiple_of(2) { 0 } else { force(n) };
        assert_eq!(stuck_after(5000, ideal), None);
        let found = stuck_after(1150, ideal);
        assert!(found.is_some_and(|n| n < 1150 + 300), "{found:?}");
    }

    #[test]
    fn a_ram_that_stands_still_freezes_nothing() {
        let mut stuck = Stuck::default();
        assert!((0..5000).all(|_| !stuck.take(FEWEST_CYCLES, 77, 0, false)));
    }
}
