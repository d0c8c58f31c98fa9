//! The clock: absolute deadlines on a grid that never shifts.
//!
//! Tick `k` is due at `start + k period`, on `CLOCK_MONOTONIC`. A tick whose time has passed when
//! the cycle before it ends is skipped: it is counted and never caught up, and the grid stays where
//! it is. Two steps in a row would command a speed that the model never had.
//!
//! [`Grid`] is the arithmetic alone. [`Pacer`] adds the sleep by `clock_nanosleep` with an absolute
//! time, or omits it for a run that needs no wall time.

use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{Timespec, clock_gettime};
use std::time::Duration;

/// Ticks at equal distances.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    period_ns: u64,
    /// Time of the tick that was used last.
    last_ns: u64,
}

/// A tick of the clock: the time at which a cycle is due, and how the wait for it went. The default
/// is the tick of a cycle without a clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tick {
    /// When it is due (ns).
    pub due_ns: u64,
    /// How long after that the caller woke up (ns).
    pub lateness_ns: u64,
    /// Ticks that were skipped since the last one.
    pub skipped: u64,
}

impl Grid {
    /// A grid whose tick 0, used already, is at `start_ns`. A period of zero counts as 1 ns.
    pub fn new(start_ns: u64, period_ns: u64) -> Self {
        Self { period_ns: period_ns.max(1), last_ns: start_ns }
    }

    /// The first tick after the last one that is not past, and how many were.
    ///
    /// ```
    /// use hil_host::clock::{Grid, Tick};
    /// let mut grid = Grid::new(0, 1000);
    /// assert_eq!(grid.next(400), Tick { due_ns: 1000, ..Tick::default() });
    /// // The cycle of tick 1 took 2.5 periods: ticks 2 and 3 are skipped, 4 is met.
    /// assert_eq!(grid.next(3500), Tick { due_ns: 4000, skipped: 2, lateness_ns: 0 });
    /// ```
    pub fn next(&mut self, now_ns: u64) -> Tick {
        let since_ns = now_ns.saturating_sub(self.last_ns);
        // A tick that is just now is not past.
        let skipped = since_ns.saturating_sub(1) / self.period_ns;
        self.last_ns += (skipped + 1) * self.period_ns;
        debug_assert!(self.last_ns >= now_ns, "the next tick is past");
        Tick { due_ns: self.last_ns, skipped, lateness_ns: 0 }
    }

    /// Distance of two ticks (ns).
    pub fn period_ns(&self) -> u64 {
        self.period_ns
    }
}

/// Waits for one tick after the other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pacer {
    grid: Grid,
    time: Time,
    skipped: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Time {
    Monotonic,
    Virtual,
}

impl Pacer {
    /// A pacer on the monotonic clock; tick 0 is now, the first wait is for tick 1. `slow_down`
    /// stretches the period for a machine that cannot hold it, 1 for real time.
    pub fn new(period_ns: u64, slow_down: u32) -> Self {
        let period_ns = period_ns.saturating_mul(u64::from(slow_down.max(1)));
        Self { grid: Grid::new(now_ns(), period_ns), time: Time::Monotonic, skipped: 0 }
    }

    /// A pacer for cycles of this real time; where it is zero, as in memory, it never waits.
    pub(crate) fn every(cycle: Duration) -> Self {
        match cycle.as_nanos() {
            0 => Self::virtual_time(1),
            nanos => Self::new(u64::try_from(nanos).unwrap_or(u64::MAX), 1),
        }
    }

    /// A pacer that never waits: every tick is met to the nanosecond, starting at time 0.
    pub fn virtual_time(period_ns: u64) -> Self {
        Self { grid: Grid::new(0, period_ns), time: Time::Virtual, skipped: 0 }
    }

    /// Puts tick 0 at the present, after a pause.
    pub fn restart(&mut self) {
        self.grid.last_ns = self.now_ns();
    }

    /// Waits for the next tick that is not past.
    pub fn wait(&mut self) -> Tick {
        let tick = self.grid.next(self.now_ns());
        self.skipped += tick.skipped;
        let woken_ns = match self.time {
            Time::Monotonic => {
                sleep_until(tick.due_ns);
                now_ns()
            }
            Time::Virtual => tick.due_ns,
        };
        Tick { lateness_ns: woken_ns.saturating_sub(tick.due_ns), ..tick }
    }

    /// Ticks skipped so far.
    pub fn skipped(&self) -> u64 {
        self.skipped
    }

    /// Distance of two ticks of the wall clock (ns).
    pub fn period_ns(&self) -> u64 {
        self.grid.period_ns
    }

    /// The present on this pacer's clock (ns).
    pub fn now_ns(&self) -> u64 {
        match self.time {
            Time::Monotonic => now_ns(),
            Time::Virtual => self.grid.last_ns,
        }
    }
}

/// The monotonic clock (ns).
pub fn now_ns() -> u64 {
    let now = clock_gettime(rustix::time::ClockId::Monotonic);
    now.tv_sec as u64 * NS_PER_S + now.tv_nsec as u64
}

const NS_PER_S: u64 = 1_000_000_000;

/// Sleeps until a time of the monotonic clock; a signal does not cut it short.
fn sleep_until(deadline_ns: u64) {
    let deadline = Timespec {
        tv_sec: (deadline_ns / NS_PER_S) as i64,
        tv_nsec: (deadline_ns % NS_PER_S) as _,
    };
    while clock_nanosleep_absolute(ClockId::Monotonic, &deadline) == Err(rustix::io::Errno::INTR) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_keeps_its_phase_whatever_the_cycles_take() {
        let mut grid = Grid::new(17, 1_000_000);
        // Work of each cycle in units of the period, and the ticks that it costs.
        let cycles = [(0.1, 0), (0.999, 0), (1.0, 0), (1.001, 1), (0.5, 0), (7.3, 7), (0.0, 0)];
        let mut now_ns = 17;
        let mut ticks = 0;
        for (work, lost) in cycles {
            now_ns += (work * 1e6) as u64;
            let tick = grid.next(now_ns);
            ticks += lost + 1;
            assert_eq!(
                tick,
                Tick { due_ns: 17 + ticks * 1_000_000, skipped: lost, lateness_ns: 0 },
                "{work}"
            );
            assert!(tick.due_ns >= now_ns);
            now_ns = tick.due_ns;
        }
    }

    #[test]
    fn late_wake_ups_do_not_shift_the_grid() {
        let mut grid = Grid::new(0, 1000);
        for tick in 1..=1000 {
            // Each wake-up is 300 ns late and the work takes 600.
            let now_ns = if tick == 1 { 0 } else { (tick - 1) * 1000 + 900 };
            assert_eq!(grid.next(now_ns), Tick { due_ns: tick * 1000, ..Tick::default() });
        }
    }

    #[test]
    fn virtual_time_is_exact_and_misses_nothing() {
        let mut pacer = Pacer::virtual_time(500);
        for tick in 1..=3 {
            assert_eq!(pacer.wait(), Tick { due_ns: 500 * tick, ..Tick::default() });
        }
        assert_eq!((pacer.skipped(), pacer.now_ns()), (0, 1500));
    }

    #[test]
    fn a_pacer_on_the_monotonic_clock_never_wakes_early_and_counts_what_it_missed() {
        let mut pacer = Pacer::new(1_000, 50);
        let start_ns = pacer.grid.last_ns;
        let mut expected = 0;
        for _ in 0..20 {
            let tick = pacer.wait();
            expected += 1 + tick.skipped;
            assert_eq!(tick.due_ns, start_ns + 50_000 * expected);
            assert!(now_ns() >= tick.due_ns + tick.lateness_ns);
        }
        assert_eq!(pacer.skipped() + 20, expected);
    }
}
