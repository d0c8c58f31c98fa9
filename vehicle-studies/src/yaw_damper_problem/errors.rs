//! How far a run is off the all-model run.

use super::recording::Observed;
use serde::Serialize;

/// The errors in one regime.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Errors {
    /// Of the work of all dampers per cycle (%).
    pub work_percent: f64,
    /// Of the stroke of the dampers (%).
    pub stroke_percent: f64,
    /// Of the phase at the frequency of hunting, negative where the rig is late (degrees).
    pub phase_deg: f64,
}

/// The most that is aimed at, in size.
pub const AIMS: Errors = Errors { work_percent: 2.0, stroke_percent: 2.0, phase_deg: 0.5 };

impl Errors {
    /// Those of a run.
    pub(super) fn of(run: &Observed, reference: &Observed) -> Self {
        let percent = |found: f64, of: f64| 100.0 * (found / of - 1.0);
        Self {
            work_percent: percent(run.work_j, reference.work_j),
            stroke_percent: percent(run.stroke_m, reference.stroke_m),
            phase_deg: run.phase_deg - reference.phase_deg,
        }
    }

    /// Work (%), stroke (%), phase (degrees).
    pub const fn all(&self) -> [f64; 3] {
        [self.work_percent, self.stroke_percent, self.phase_deg]
    }

    /// Whether all of them are within the aims; what is no number is not.
    pub fn meet_aims(&self) -> bool {
        self.all().into_iter().zip(AIMS.all()).all(|(found, most)| found.abs() <= most)
    }
}
