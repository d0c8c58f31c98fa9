//! What a caller sees of a long computation, and how it ends it early.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// A callback for progress and a flag that ends the work.
///
/// The flag is read between fits and within them. Once it is set, every fit ends without a result,
/// and the search returns what it has accepted so far.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Called at the beginning of each step, from any thread.
    pub progress: &'a (dyn Fn(&Step<'_>) + Sync),
    /// Ends the work when it is set.
    pub stop: &'a AtomicBool,
}

/// A step of a long computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Step<'a> {
    /// What it does, in a few words.
    pub what: &'a str,
    /// The round of the search, where it is part of one.
    pub round: Option<RoundProgress>,
}

/// How far a round of the search is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RoundProgress {
    /// Number of the round, from 1.
    pub number: usize,
    /// Steps that have begun before.
    pub done: usize,
    /// Steps of the round.
    pub of: usize,
}

/// A flag that is never set.
static NEVER: AtomicBool = AtomicBool::new(false);

impl Control<'static> {
    /// Reports nothing and is never stopped.
    pub const QUIET: Self = Self { progress: &|_| {}, stop: &NEVER };
}

impl Control<'_> {
    /// Reports a step.
    pub(crate) fn report(&self, what: &str) {
        (self.progress)(&Step { what, round: None });
    }

    /// True once the work is to end.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Counts the steps of a round of the search.
pub(crate) struct Steps<'a> {
    control: Control<'a>,
    number: usize,
    done: AtomicUsize,
    of: AtomicUsize,
}

impl<'a> Steps<'a> {
    /// A round of this number with so many steps.
    pub(crate) fn new(control: Control<'a>, number: usize, of: usize) -> Self {
        debug_assert!(number > 0, "rounds are counted from 1");
        Self { control, number, done: AtomicUsize::new(0), of: AtomicUsize::new(of) }
    }

    /// More steps than were known at first.
    pub(crate) fn expect(&self, more: usize) {
        self.of.fetch_add(more, Ordering::Relaxed);
    }

    /// Reports the beginning of a step.
    pub(crate) fn begin(&self, what: &str) {
        let done = self.done.fetch_add(1, Ordering::Relaxed);
        let of = self.of.load(Ordering::Relaxed).max(done + 1);
        let round = RoundProgress { number: self.number, done, of };
        (self.control.progress)(&Step { what, round: Some(round) });
    }
}

impl std::fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Control").field("stop", self.stop).finish_non_exhaustive()
    }
}
