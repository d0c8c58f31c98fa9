//! The limit of work of a search.

use super::test_set::TestSet;

/// Work, in passes of a model over all tests, past which no pair is tried.
pub(crate) const MOST_PASSES: f64 = 7000.0;

/// Multiple of it past which no round begins.
const FAR: f64 = 3.0;

/// The work that a search may do.
pub(crate) struct Budget<'a> {
    tests: &'a TestSet,
    most_passes: f64,
    exceeded: bool,
}

impl<'a> Budget<'a> {
    /// A budget in passes of a model over all tests.
    pub(crate) fn new(tests: &'a TestSet, most_passes: f64) -> Self {
        debug_assert!(most_passes > 0.0, "a search needs some work");
        Self { tests, most_passes, exceeded: false }
    }

    /// Checks the work done so far; once spent, a budget stays spent.
    pub(crate) fn is_spent(&mut self) -> bool {
        self.exceeded |= self.tests.passes() > self.most_passes;
        self.exceeded
    }

    /// The same for the work that no search may exceed.
    pub(crate) fn is_far_exceeded(&mut self) -> bool {
        let far = self.tests.passes() > FAR * self.most_passes;
        self.exceeded |= far;
        far
    }

    /// True when a check has found it spent, so that something was left out.
    pub(crate) const fn has_cut_short(&self) -> bool {
        self.exceeded
    }
}
