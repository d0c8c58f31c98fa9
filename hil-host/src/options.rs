//! What a run is given in addition to its scenario.

use crate::bus::BusChoice;
use crate::gateway::GatewayPlan;
use crate::linear_vehicle::LinearVehicle;
use crate::measured_ram::MeasuredRams;
use crate::realtime::RealtimeOptions;
use can_protocol::Profile;
use serde::{Deserialize, Serialize};
use std::num::NonZeroU8;
use std::path::PathBuf;

/// Who sets the pace.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PaceChoice {
    /// Absolute deadlines of a monotonic clock.
    Realtime,
    /// The next cycle comes when every rig has answered this one.
    Lockstep,
    /// As fast as possible, on the memory bus only.
    Fast,
}

impl PaceChoice {
    /// The word for it, on the command line and in `summary.json`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Realtime => "realtime",
            Self::Lockstep => "lockstep",
            Self::Fast => "fast",
        }
    }
}

/// The options of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunOptions {
    /// The bus of all slots that do not name their own.
    pub bus: BusChoice,
    /// How the rig on that bus is driven by its own messages, if it is.
    pub gateway: Option<GatewayPlan>,
    /// The pace.
    pub pace: PaceChoice,
    /// The profile on the wire.
    pub profile: Profile,
    /// Bit rates, nominal and data (bit/s).
    pub bit_rates: (f64, f64),
    /// How many times longer a cycle takes than in the model.
    pub slow_down: NonZeroU8,
    /// The result folder; without one, the next free `runs/<name>-<n>`.
    pub out: Option<PathBuf>,
    /// Whether an earlier result in `out` is replaced.
    pub overwrite: bool,
    /// Files that were read for the run: a result that holds one of them is not replaced.
    pub inputs: Vec<PathBuf>,
    /// Name for the default folder.
    pub name: String,
    /// What is known of the rigs by calibration, one line for each part.
    pub calibrations: Vec<String>,
    /// How late the rams were in an open loop or an earlier run; none where that is not known.
    pub measured: Option<MeasuredRams>,
    /// The vehicle about steady running; without it no delay is judged.
    pub linear: Option<LinearVehicle>,
    /// Real-time set-up.
    pub realtime: RealtimeOptions,
}
