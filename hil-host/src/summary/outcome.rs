//! What is known of a run in addition to its columns.

use crate::bus::BusCounters;
use crate::control::{Asker, End, NotedSummary, Port, SessionState};
use crate::linear_vehicle::Hunting;
use crate::options::PaceChoice;
use crate::record::RunEvent;
use firmware_core::line::Line;
use scenario::run::Run;

/// What the summary needs in addition to the columns.
#[derive(Debug)]
pub(crate) struct Outcome<'a> {
    pub(crate) run: &'a Run,
    pub(crate) bus: String,
    pub(crate) pace: PaceChoice,
    pub(crate) end: End,
    /// Who asked for it; none where nobody did.
    pub(crate) asker: Option<Asker>,
    pub(crate) state: &'a SessionState,
    pub(crate) line: &'a Line<'a>,
    pub(crate) ports: &'a [Port],
    pub(crate) counters: BusCounters,
    pub(crate) record_dropped: u64,
    pub(crate) wall_s: f64,
    /// Why a run ended that was to go on; none where the user ended it.
    pub(crate) record_fault: Option<String>,
    pub(crate) events: Vec<RunEvent>,
    pub(crate) bus_load: f64,
    pub(crate) watched: [Option<usize>; 3],
    /// The vehicle's hunting.
    pub(crate) hunting: Option<Hunting>,
    /// What is known of the rigs by calibration.
    pub(crate) calibrations: Vec<String>,
    /// What was beyond a limit and ended nothing.
    pub(crate) noted: Vec<NotedSummary>,
}
