//! How fast trips are simulated: time of vehicles over time of cores.
//!
//! Every trip counts itself, on whatever core it runs. Only the cycles count, with what is recorded
//! of them; steady running, tracks and what is made of signals do not.

use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Trips and what they took, summed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pace {
    /// Time that vehicles were under way (s).
    pub simulated_s: f64,
    /// Time of cores that went into it (s).
    pub busy_s: f64,
}

impl Pace {
    /// The sum of many; none where no time is recorded.
    ///
    /// ```
    /// use vehicle_studies::trip::Pace;
    /// let of = |simulated_s: f64| Pace { simulated_s, busy_s: 1.0 };
    /// let each = [of(30.0), of(10.0)];
    /// let all = Pace::over(each).unwrap();
    /// assert_eq!(all.in_words(), "40 s simulated, 20 s per second of one core");
    /// ```
    pub fn over(each: impl IntoIterator<Item = Self>) -> Option<Self> {
        let none = Self { simulated_s: 0.0, busy_s: 0.0 };
        let all = each.into_iter().fold(none, |all, one| Self {
            simulated_s: all.simulated_s + one.simulated_s,
            busy_s: all.busy_s + one.busy_s,
        });
        (all.busy_s > 0.0).then_some(all)
    }

    /// In words.
    pub fn in_words(&self) -> String {
        let pace = self.simulated_s / self.busy_s;
        format!("{:.0} s simulated, {pace:.0} s per second of one core", self.simulated_s)
    }
}

/// Where trips on many cores count themselves.
#[derive(Debug, Default)]
pub(super) struct Odometer {
    cycles: AtomicU64,
    busy_us: AtomicU64,
}

impl Odometer {
    /// Counts cycles that took a time.
    pub(super) fn count(&self, cycles: u64, busy: Duration) {
        self.cycles.fetch_add(cycles, Ordering::Relaxed);
        self.busy_us.fetch_add(busy.as_micros() as u64, Ordering::Relaxed);
    }

    /// What was counted so far with cycles of a length (s); none before the first.
    pub(super) fn pace(&self, cycle_s: f64) -> Option<Pace> {
        Pace::over([Pace {
            simulated_s: cycle_s * self.cycles.load(Ordering::Relaxed) as f64,
            busy_s: 1e-6 * self.busy_us.load(Ordering::Relaxed) as f64,
        }])
    }
}
