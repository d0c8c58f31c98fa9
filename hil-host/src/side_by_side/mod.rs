//! Runs side by side: how large is a difference against the spread of repeats?
//!
//! ```text
//! run = condition + repeat        difference = mean(repeats of B) - mean(repeats of A)
//! ```
//! A repeat is a run of its own under one condition, at best with the damper mounted anew. Runs are
//! grouped by what they recorded, or by the user where that is not enough: two dampers that stand
//! on one rig after each other leave the same files. Each group is compared with the first one, in
//! every quantity, by [`signal::repeats`]; a difference is claimed only where repeats do not
//! explain it. Where runs of one group were made before and after the other (an ABA test), what
//! they differ by is the drift of the bench, and stands beside the difference.
//!
//! Figures come from the records, so that runs of two versions of the program are counted alike.
//!
//! Limits: runs are taken as independent. What differs together with the condition (another day,
//! another oil temperature) is in the difference, and no statistics take it out.

mod aba;
mod condition;
mod finished;
mod groups;
mod notes;
mod page;
mod result;
mod text;
mod trust;

pub use aba::Aba;
pub use condition::Differing;
pub use groups::RunGroups;
pub use result::{
    ComparedGroup, ComparedRun, Difference, GroupComparison, QuantityRepeats, SideBySide, Spread,
};
pub use trust::Trust;

use crate::BenchError;
use crate::comparison::Figure;
use finished::FinishedRun;
use std::sync::atomic::{AtomicBool, Ordering};

/// Sets runs side by side; none where `stop` was set.
///
/// # Errors
/// A folder that holds no run, a run that was not completed or whose record is not whole, a run
/// that cannot stand beside another one.
pub fn side_by_side(
    asked: &RunGroups,
    stop: &AtomicBool,
) -> Result<Option<SideBySide>, BenchError> {
    let runs = asked.paths().into_iter().map(|path| FinishedRun::read(path));
    let groups = asked.of(runs.collect::<Result<_, _>>()?)?;
    let mut figures: Vec<Vec<Vec<Figure>>> = Vec::new();
    for group in &groups {
        let mut of_group = Vec::new();
        for run in &group.runs {
            if stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
            of_group.push(run.figures()?);
        }
        figures.push(of_group);
    }
    Ok(Some(SideBySide::of(&groups, &figures).worded()))
}
