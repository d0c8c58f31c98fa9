//! What a caller sees of the search, and how it ends it early.

use std::sync::atomic::{AtomicBool, Ordering};

/// A callback for progress and a flag that ends the work.
#[derive(Clone, Copy)]
pub struct OnMassControl<'a> {
    /// Called with the number of finished fits, the number of all of this round, and a description;
    /// from any thread.
    pub progress: &'a (dyn Fn([usize; 2], &str) + Sync),
    /// Ends the work when it is set.
    pub stop: &'a AtomicBool,
}

/// A flag that is never set.
static NEVER: AtomicBool = AtomicBool::new(false);

impl OnMassControl<'static> {
    /// Reports nothing and is never stopped.
    pub const QUIET: Self = Self { progress: &|_, _| {}, stop: &NEVER };
}

impl OnMassControl<'_> {
    /// True once the work is to end.
    pub(super) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

impl std::fmt::Debug for OnMassControl<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("OnMassControl").field("stop", self.stop).finish_non_exhaustive()
    }
}
