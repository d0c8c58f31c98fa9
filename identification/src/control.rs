//! What a caller sees of a long computation, and how it ends it early.

use std::sync::atomic::{AtomicBool, Ordering};

/// A callback for progress and a flag that ends the work.
///
/// The flag is read between fits and within them. Once it is set, every fit ends without a result,
/// and the search returns what it has accepted so far.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Called with a short description of each step, from any thread.
    pub progress: &'a (dyn Fn(&str) + Sync),
    /// Ends the work when it is set.
    pub stop: &'a AtomicBool,
}

/// A flag that is never set.
static NEVER: AtomicBool = AtomicBool::new(false);

impl Control<'static> {
    /// Reports nothing and is never stopped.
    pub const QUIET: Self = Self { progress: &|_| {}, stop: &NEVER };
}

impl Control<'_> {
    /// Reports a step.
    pub(crate) fn report(&self, step: &str) {
        (self.progress)(step);
    }

    /// True once the work is to end.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

impl std::fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Control").field("stop", self.stop).finish_non_exhaustive()
    }
}
