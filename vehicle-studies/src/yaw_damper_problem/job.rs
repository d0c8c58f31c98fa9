//! The runs that a question asks for, each of which can be done on a core of its own.

use super::candidate::Candidate;
use super::errors::Errors;
use super::from_below::{Climb, FromBelow};
use super::question::Question;
use super::regime::{REGIMES, Regime};
use crate::critical_speed::Critical;

/// One run, or the runs of one critical speed. Cases and candidates are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Job {
    /// The errors on a rig: 0 for the nominal one.
    Errors { case: usize, candidate: usize, dead_time_ms: u16, rig: u64, regime: Regime },
    /// The critical speed on the nominal rig.
    Critical { case: usize, candidate: usize, dead_time_ms: u16 },
    /// The critical speed with all dampers modelled.
    Modelled { case: usize },
    /// The same with more damping.
    MoreDamping { case: usize },
    /// The same with less damping.
    LessDamping { case: usize },
    /// The critical speed from below, behind rigs or with modelled dampers.
    FromBelow { case: usize, on_rigs: bool, climb: Climb },
}

/// What a job finds.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Outcome {
    /// None where the motion was lost.
    Errors(Option<Errors>),
    Critical(Critical),
    FromBelow(FromBelow),
}

/// A case, a candidate and a dead time (ms).
type Cell = (usize, usize, u16);

impl Job {
    /// The errors of a cell on a rig.
    pub(super) const fn errors(cell: Cell, rig: u64, regime: Regime) -> Self {
        let (case, candidate, dead_time_ms) = cell;
        Self::Errors { case, candidate, dead_time_ms, rig, regime }
    }

    /// The critical speed of a cell.
    pub(super) const fn critical(cell: Cell) -> Self {
        let (case, candidate, dead_time_ms) = cell;
        Self::Critical { case, candidate, dead_time_ms }
    }

    /// Its case.
    pub(super) const fn case(self) -> usize {
        match self {
            Self::Errors { case, .. }
            | Self::Critical { case, .. }
            | Self::Modelled { case }
            | Self::MoreDamping { case }
            | Self::LessDamping { case }
            | Self::FromBelow { case, .. } => case,
        }
    }

    /// All jobs of a question, the long ones first.
    pub(super) fn all(question: &Question, candidates: &[Candidate]) -> Vec<Self> {
        let Question { dampers, dead_times_ms, critical_speeds, long_at_ms, climb, .. } = question;
        let cases = dampers.len();
        let cells = || -> Vec<Cell> {
            let of_case = |case| {
                (0..candidates.len()).flat_map(move |candidate| {
                    dead_times_ms.iter().map(move |dead| (case, candidate, *dead))
                })
            };
            (0..cases).flat_map(of_case).collect()
        };
        let mut jobs = Vec::new();
        for case in 0..cases {
            if *critical_speeds {
                jobs.extend([
                    Self::Modelled { case },
                    Self::MoreDamping { case },
                    Self::LessDamping { case },
                ]);
            }
            if let Some(climb) = climb {
                let of = |on_rigs| Self::FromBelow { case, on_rigs, climb: *climb };
                jobs.extend([false, true].map(of));
            }
        }
        if *critical_speeds {
            let cells = cells().into_iter().filter(|(.., dead)| long_at_ms.contains(dead));
            jobs.extend(cells.map(Self::critical));
        }
        for cell in cells() {
            let (case, candidate, _) = cell;
            let compensates = candidates[candidate].compensates();
            let rigs = if compensates { question.rigs(dampers[case]) } else { 0 };
            for rig in 0..=rigs {
                jobs.extend(REGIMES.map(|regime| Self::errors(cell, rig, regime)));
            }
        }
        jobs
    }
}
