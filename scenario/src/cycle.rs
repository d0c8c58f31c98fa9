//! How often the control loop turns.
//!
//! ```toml
//! rate_hz = 2000                   # of a scenario: 1000 (the default), 2000 or 4000
//! substeps = 4                     # per millisecond at every rate: 2 per cycle at 2 kHz
//! ```
//! A faster loop holds measured forces for a shorter time and commands rigs more often. The vehicle
//! is stepped on the same grid of substeps at every rate, so a run whose dampers are all modelled
//! is the same run. Everything that a scenario or the protocol counts in cycles (watchdogs,
//! debounces, windows of losses) stays a number of cycles; everything that is stated in seconds
//! (ramps, the measurement of the delay, braking) stays a time.
//!
//! Two frames of classical CAN take 27 % of a bus of 1 Mbit/s at 1 kHz and more than all of it at
//! 4 kHz: faster loops need CAN FD.

use std::fmt;

/// Length of a cycle of the usual loop (s): of studies, of tests in open loop, and of a run whose
/// scenario names no rate.
pub const CYCLE_S: f64 = 1e-3;

/// How often the control loop turns: the usual rate, or a multiple that divides a substep grid of
/// four per millisecond.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Rate {
    /// 1 kHz.
    #[default]
    Usual,
    /// 2 kHz.
    Double,
    /// 4 kHz.
    Fourfold,
}

impl Rate {
    /// All rates, the slowest first.
    pub const ALL: [Self; 3] = [Self::Usual, Self::Double, Self::Fourfold];

    /// The rate of so many cycles per second, if there is one.
    ///
    /// ```
    /// use scenario::run::Rate;
    /// assert_eq!(Rate::of_hz(2000), Some(Rate::Double));
    /// assert_eq!(Rate::of_hz(3000), None);
    /// ```
    pub fn of_hz(hz: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|rate| rate.hz() == hz)
    }

    /// Cycles per second (Hz).
    pub const fn hz(self) -> u32 {
        1000 * self.per_ms()
    }

    /// Cycles per millisecond.
    pub const fn per_ms(self) -> u32 {
        match self {
            Self::Usual => 1,
            Self::Double => 2,
            Self::Fourfold => 4,
        }
    }

    /// Length of a cycle (s).
    ///
    /// ```
    /// use scenario::run::{CYCLE_S, Rate};
    /// assert_eq!(Rate::Usual.cycle_s(), CYCLE_S);
    /// assert_eq!(Rate::Fourfold.cycle_s(), 0.25e-3);
    /// ```
    pub const fn cycle_s(self) -> f64 {
        // Exact: a division by a power of two.
        CYCLE_S / self.per_ms() as f64
    }

    /// Length of a cycle (ns).
    pub const fn cycle_ns(self) -> u64 {
        1_000_000 / self.per_ms() as u64
    }

    /// Whole cycles in a time (s), to the nearest.
    pub fn cycles(self, time_s: f64) -> u64 {
        debug_assert!(time_s >= 0.0 && time_s.is_finite(), "cycles of {time_s} s");
        libm::round(time_s / self.cycle_s()) as u64
    }

    /// The lengths of a cycle as words: "1 ms", "0.25 ms".
    pub const fn cycle_in_words(self) -> &'static str {
        match self {
            Self::Usual => "1 ms",
            Self::Double => "0.5 ms",
            Self::Fourfold => "0.25 ms",
        }
    }
}

impl fmt::Display for Rate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} kHz", self.per_ms())
    }
}
