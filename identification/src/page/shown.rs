//! The tests that are drawn, and the stretch of each.

use crate::fit::Fit;
use crate::identify::Identification;
use crate::result::Models;
use crate::test_set::{Test, TestSet};
use std::ops::Range;

/// A stretch without cycles, s.
const STRETCH_S: f64 = 1.5;
/// Two cycles are drawn where they are shorter than this together, else one, s.
const TWO_CYCLES_S: f64 = 2.5;

/// A test with the forces of the three models.
#[derive(Debug, Clone)]
pub(super) struct Shown<'a> {
    /// The test.
    pub(super) test: &'a Test,
    /// It was held out.
    pub(super) held_out: bool,
    /// Simulated force, run-in included, N.
    pub(super) force_n: Models<Option<&'a [f64]>>,
}

/// All tests: those fitted, then those held out.
pub(super) fn all(identification: &Identification) -> Vec<Shown<'_>> {
    let mut all = with_forces(&identification.train, &identification.on_train, false);
    all.extend(with_forces(&identification.holdout, &identification.on_holdout, true));
    all
}

fn with_forces<'a>(
    tests: &'a TestSet,
    models: &'a Models<Option<Fit>>,
    held_out: bool,
) -> Vec<Shown<'a>> {
    let each = tests.tests.iter().enumerate().map(|(index, test)| {
        let force_n = models.map(|fit| fit.as_ref()?.force_n.get(index).map(Vec::as_slice));
        Shown { test, held_out, force_n }
    });
    each.collect()
}

/// A test without cycles must have an error this much larger to be shown: loops are easier to read.
const TANGLE: f64 = 1.5;

/// The test with the largest error of the refitted model.
pub(super) fn worst<'a, 'b>(tests: &'b [Shown<'a>]) -> Option<&'b Shown<'a>> {
    tests.iter().max_by(|a, b| a.weighted_rms_n().total_cmp(&b.weighted_rms_n()))
}

impl Shown<'_> {
    /// Name and role, as in a title.
    pub(super) fn title(&self) -> String {
        let role = if self.held_out { "held out" } else { "fitted" };
        format!("{} ({role})", self.test.record.name)
    }

    /// The stretch with the largest error of the refitted model: whole cycles where there are any.
    pub(super) fn stretch(&self) -> Range<usize> {
        let Some(refitted) = self.force_n.refitted else { return self.test.counted() };
        worst_stretch(self.test, refitted)
    }

    /// rms error of the refitted model over the counted samples, N; more for a test with cycles.
    fn weighted_rms_n(&self) -> f64 {
        let counted = self.test.counted();
        let Some(refitted) = self.force_n.refitted else { return 0.0 };
        let samples = counted.len().max(1) as f64;
        let rms_n = (self.test.squares_n2(refitted, counted) / samples).sqrt();
        if self.test.record.cycles.len() > 2 { TANGLE * rms_n } else { rms_n }
    }
}

/// The stretch of a test with the largest error of a simulated force.
pub(super) fn worst_stretch(test: &Test, force_n: &[f64]) -> Range<usize> {
    let counted = test.counted();
    let starts: Vec<usize> =
        test.record.cycles.iter().copied().filter(|at| counted.contains(at)).collect();
    let candidates: Vec<Range<usize>> = if starts.len() >= 2 {
        let cycle_s = (starts[1] - starts[0]) as f64 * test.record.step_s;
        let count = if 2.0 * cycle_s <= TWO_CYCLES_S && starts.len() > 2 { 2 } else { 1 };
        starts.windows(count + 1).map(|pair| pair[0]..pair[count] + 1).collect()
    } else {
        let length = (STRETCH_S / test.record.step_s) as usize;
        if counted.len() <= 2 * length.max(8) {
            return counted;
        }
        let last = counted.end - length;
        (counted.start..=last).step_by(length.div_ceil(4)).map(|at| at..at + length).collect()
    };
    let end = test.record.force_n.len();
    let mut found = (0.0, counted);
    for range in candidates.into_iter().map(|range| range.start..range.end.min(end)) {
        let off = test.squares_n2(force_n, range.clone()) / range.len().max(1) as f64;
        if off > found.0 {
            found = (off, range);
        }
    }
    found.1
}
