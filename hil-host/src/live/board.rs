//! What the page shows: the newest of everything, between the run and the thread of the page.
//!
//! The run puts and goes on; what the page has not taken by then is replaced. Nothing here grows
//! and nobody waits: the one lock that both sides take is held for a move, and the run only tries
//! it.

use super::timing::Timing;
use scenario::run::{Run, Slot, SlotForce};
use serde::Serialize;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// What does not change in a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Facts {
    /// Title of the scenario.
    pub(crate) title: String,
    pub(crate) vehicle: String,
    pub(crate) speed_kmh: f64,
    pub(crate) duration_s: f64,
    pub(crate) bus: String,
    pub(crate) pace: &'static str,
    /// Whether a clock sets the pace.
    pub(crate) is_clocked: bool,
    /// The damper slots, in their order.
    pub(crate) slots: Vec<SlotFacts>,
    /// What is to be warned of before the run begins.
    pub(crate) warnings: Vec<String>,
    /// Edges of the histogram of cycle times (µs).
    pub(crate) edges_us: Vec<f64>,
}

/// A damper slot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct SlotFacts {
    pub(crate) place: String,
    /// Where its force comes from, as results name it.
    pub(crate) is: &'static str,
    /// Place of the damper whose rig stands for it.
    pub(crate) of: Option<String>,
    /// Whether the sign of that rig's force is reversed.
    pub(crate) is_reversed: bool,
}

impl SlotFacts {
    /// Those of the slots of a run.
    pub(crate) fn of(run: &Run) -> Vec<Self> {
        let of = |slot: &Slot| {
            let (of, is_reversed) = match slot.force {
                SlotForce::StandIn { of, is_reversed, .. } => (run.slots.get(of), is_reversed),
                SlotForce::Modelled(_) | SlotForce::Rig { .. } => (None, false),
            };
            let of = of.map(|rig| rig.place.clone());
            Self { place: slot.place.clone(), is: slot.force.name(), of, is_reversed }
        };
        run.slots.iter().map(of).collect()
    }
}

/// What happens before the first cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Files, tracks and sessions are made ready.
    Preparing = 0,
    /// The rigs are met.
    Meeting = 1,
    /// They are armed.
    Arming = 2,
}

impl Phase {
    const ALL: [Self; 3] = [Self::Preparing, Self::Meeting, Self::Arming];
}

/// What is new since the last one.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub(crate) struct Update {
    /// Its number, from one: a gap is what the page has missed.
    pub(crate) number: u64,
    pub(crate) cycle: u64,
    pub(crate) time_s: f64,
    pub(crate) distance_m: f64,
    pub(crate) state: &'static str,
    /// What ends the run.
    pub(crate) cause: Option<String>,
    /// Rows since the last update, decimated: time in ms, and for every slot what its rig was
    /// told and measured (displacements in µm, force in N; null without a rig), the extension in µm
    /// and the force in N that acts.
    pub(crate) samples: Vec<Vec<Option<i64>>>,
    pub(crate) rigs: Vec<RigNow>,
    pub(crate) interlocks: Vec<Interlock>,
    pub(crate) timing: Timing,
}

/// How a rig is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct RigNow {
    /// Number of its slot, from zero.
    pub(crate) slot: usize,
    /// Its own state; none before its first measurement.
    pub(crate) state: Option<&'static str>,
    /// Age of the measurement that is believed (cycles).
    pub(crate) age_cycles: Option<u8>,
    /// Cycles with and without a new valid force.
    pub(crate) fresh: u64,
    pub(crate) lost: u64,
    /// Share of the measured force in what the vehicle feels.
    pub(crate) coupling: f64,
    pub(crate) temperature_degc: Option<f64>,
    /// What the watch over it says; none without one.
    pub(crate) watch: Option<&'static str>,
}

/// A check of a rig, or a limit of its commands: how far what it is of has come towards it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Interlock {
    /// Number of the slot, from zero.
    pub(crate) slot: usize,
    /// Key of the check in a scenario.
    pub(crate) check: &'static str,
    pub(crate) unit: Option<&'static str>,
    /// The largest value so far.
    pub(crate) largest: Option<f64>,
    pub(crate) limit: Option<f64>,
    /// What is left of the limit (%).
    pub(crate) margin_percent: Option<f64>,
    pub(crate) has_tripped: bool,
    /// What follows then.
    pub(crate) action: Option<&'static str>,
}

/// How a run has ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RunEnd {
    /// In one line.
    pub words: String,
    /// What led to it, or what is to be said in addition; none where there is nothing.
    pub why: Option<String>,
    /// What is to be warned of.
    pub warnings: Vec<String>,
    /// The result folder, once its files are written.
    pub files: Option<String>,
    /// Whether nothing was wrong.
    pub is_good: bool,
}

/// The newest of everything.
#[derive(Debug, Default)]
pub(crate) struct Board {
    facts: OnceLock<Facts>,
    phase: AtomicU8,
    newest: Mutex<Option<Update>>,
    end: Mutex<Option<RunEnd>>,
    is_closing: AtomicBool,
}

impl Board {
    /// Puts what does not change, once.
    pub(crate) fn begin(&self, facts: Facts) {
        let is_first = self.facts.set(facts).is_ok();
        debug_assert!(is_first, "a page of two runs");
    }

    pub(crate) fn enter(&self, phase: Phase) {
        self.phase.store(phase as u8, Ordering::Relaxed);
    }

    /// Replaces the update that the page has not taken; false where the page is just taking one.
    pub(crate) fn put(&self, update: Update) -> bool {
        let Ok(mut newest) = self.newest.try_lock() else { return false };
        *newest = Some(update);
        true
    }

    /// Puts the end, or what is known of it later.
    pub(crate) fn end(&self, end: RunEnd) {
        *locked(&self.end) = Some(end);
    }

    /// Has the page show what there is, and end.
    pub(crate) fn close(&self) {
        self.is_closing.store(true, Ordering::Release);
    }

    pub(crate) fn is_closing(&self) -> bool {
        self.is_closing.load(Ordering::Acquire)
    }

    pub(super) fn facts(&self) -> Option<&Facts> {
        self.facts.get()
    }

    pub(super) fn phase(&self) -> Phase {
        let code = usize::from(self.phase.load(Ordering::Relaxed));
        Phase::ALL.get(code).copied().unwrap_or(Phase::Preparing)
    }

    pub(super) fn take(&self) -> Option<Update> {
        locked(&self.newest).take()
    }

    pub(super) fn known_end(&self) -> Option<RunEnd> {
        locked(&self.end).clone()
    }
}

#[cfg(test)]
impl Board {
    /// Takes the lock of the update for ever.
    pub(super) fn hang(&self) {
        std::mem::forget(self.newest.lock());
    }
}

/// What a thread that has panicked left is as good as any.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_update_wins_and_nobody_waits_for_the_page() {
        let board = Board::default();
        for number in 1..=3 {
            assert!(board.put(Update { number, ..Update::default() }));
        }
        assert_eq!(board.take().map(|update| update.number), Some(3));
        assert_eq!(board.take(), None);
        // A page that hangs while it takes is passed by.
        let hangs = board.newest.lock().unwrap();
        assert!(!board.put(Update::default()));
        drop(hangs);
        assert!(board.put(Update::default()));
    }

    #[test]
    fn phases_are_listed_in_their_own_order() {
        assert!(Phase::ALL.iter().enumerate().all(|(n, phase)| *phase as usize == n));
        let board = Board::default();
        assert_eq!(board.phase(), Phase::Preparing);
        board.enter(Phase::Arming);
        assert_eq!(board.phase(), Phase::Arming);
    }
}
