//! What is scored: a compensator of ours, or a filter of somebody else's.

use super::case::ALL;
use super::compensators::Ours;
use super::data_sheet::DataSheet;
use crate::trip::{DiscreteFilter, Rigs};
use scenario::rig::RigSetup;

/// A compensator that can close the loop.
#[derive(Debug, Clone, PartialEq)]
pub enum Candidate {
    /// One of ours.
    Ours(Ours),
    /// A linear filter at 1 kHz.
    Filter(DiscreteFilter),
}

impl Candidate {
    /// Its name.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Ours(ours) => ours.name(),
            Self::Filter(_) => "filter",
        }
    }

    /// Whether it compensates at all: without that there is nothing that could suit one rig better
    /// than another.
    pub(super) const fn compensates(&self) -> bool {
        !matches!(self, Self::Ours(Ours::None))
    }

    /// Rigs with a dead time (ms) in all slots, with this compensator. It knows the data sheet of
    /// the nominal rig and the frequency of hunting (Hz), whatever rig it is put on.
    pub(super) fn rigs(
        &self,
        rig: &RigSetup,
        dead_time_ms: u16,
        (sheet, hunting_hz): (&DataSheet, f64),
    ) -> Rigs {
        let rig = RigSetup { delay_cycles: dead_time_ms, ..rig.clone() };
        match self {
            Self::Ours(ours) => {
                let dead_time_s = 1e-3 * f64::from(dead_time_ms);
                Rigs::compensated(&rig, ours.compensator(sheet, dead_time_s, hunting_hz), ALL)
            }
            Self::Filter(filter) => Rigs::filtered(&rig, filter.clone(), ALL),
        }
    }
}
