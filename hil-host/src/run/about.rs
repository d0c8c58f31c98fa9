//! `run.json`: what a run was asked for, written before its first cycle.

use super::measured_delay::KnownRam;
use super::plan::{BusLoad, Plan};
use crate::BenchError;
use crate::control::Session;
use crate::gateway::GatewayPlan;
use crate::linear_vehicle::Hunting;
use crate::options::{PaceChoice, RunOptions};
use crate::record::ABOUT;
use files::{Limit, ResultFolder, input};
use scenario::run::Run;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What a run was asked for, and which program ran it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunAbout {
    /// Version of this format.
    pub(crate) format: u32,
    /// Name and version of the program.
    pub(crate) program: String,
    /// Start of the log, since 1970 (s).
    pub(crate) started_unix_s: f64,
    pub(crate) title: String,
    pub(crate) bus: String,
    pub(crate) pace: PaceChoice,
    pub(crate) slow_down: u8,
    /// The host's number of the session, in the exchange that arms the rigs; none in a file of an
    /// earlier version.
    pub(crate) session_number: Option<u32>,
    /// The number that the host drew when it started.
    pub(crate) boot_number: Option<u32>,
    /// The vehicle's hunting, where it was computed.
    pub(crate) hunting: Option<Hunting>,
    /// What was accepted to be missing in a rig's own messages; empty where the rigs speak ours.
    #[serde(default)]
    pub(crate) accepted_losses: Vec<String>,
    /// What is known of the rigs by calibration, one line for each part.
    #[serde(default)]
    pub(crate) calibrations: Vec<String>,
    /// How late the rams were before the run, and where the figures are from.
    #[serde(default)]
    pub(crate) rams: Vec<KnownRam>,
    /// Control cycles that were asked for.
    pub(crate) cycles: u64,
    /// Places of the damper slots on the vehicle; none in a file of an earlier version.
    #[serde(default)]
    pub(crate) places: Vec<String>,
    /// Numbers of the damper slots on rigs, from one.
    pub(crate) rig_slots: Vec<usize>,
    /// Worst-case share of the fullest bus.
    pub(crate) bus_load: f64,
    /// The load of every bus, one line each.
    pub(crate) bus_lines: Vec<String>,
    /// The hunting frequency at which the residual delay was judged (Hz); none where it was not.
    #[serde(default)]
    pub(crate) gate_hz: Option<f64>,
    /// Bodies whose accelerations are recorded: carbody, front bogie, first wheelset.
    pub(crate) watched: [Option<usize>; 3],
}

impl RunAbout {
    pub(super) fn new(
        run: &Run,
        options: &RunOptions,
        session: &Session<'_>,
        plan: &Plan,
        load: &BusLoad,
        started_ns: u64,
        rams: Vec<KnownRam>,
    ) -> Self {
        Self {
            format: 1,
            program: Self::this_program(),
            started_unix_s: started_ns as f64 * 1e-9,
            title: run.title.clone(),
            bus: options.bus.to_string(),
            pace: options.pace,
            slow_down: options.slow_down.get(),
            session_number: Some(session.arming.number),
            boot_number: Some(session.arming.boot),
            hunting: options.linear.as_ref().map(|linear| linear.hunting),
            accepted_losses: options
                .gateway
                .iter()
                .flat_map(GatewayPlan::losses)
                .map(|loss| loss.name().to_owned())
                .collect(),
            calibrations: options.calibrations.clone(),
            rams,
            cycles: run.cycles(),
            places: run.slots.iter().map(|slot| slot.place.clone()).collect(),
            rig_slots: plan.rigs.iter().map(|rig| rig.slot + 1).collect(),
            bus_load: load.most,
            bus_lines: load.lines.clone(),
            gate_hz: session.delay_gate.as_ref().map(|gate| gate.hunting_hz),
            watched: session.watched,
        }
    }

    /// Name and version of this program.
    pub(crate) fn this_program() -> String {
        concat!("yawbench ", env!("CARGO_PKG_VERSION")).to_owned()
    }
}

/// What the run in a folder was asked for.
///
/// # Errors
/// The file is not there, or holds something else.
pub(crate) fn read_about(folder: &ResultFolder) -> Result<RunAbout, BenchError> {
    let file = folder.file(ABOUT);
    let about: RunAbout = read_json(&file, "the run.json of a run")?;
    check_format(&file, about.format)?;
    Ok(about)
}

/// Refuses a file of a format that this version does not know.
///
/// # Errors
/// Another format than 1.
pub(crate) fn check_format(file: &Path, format: u32) -> Result<(), BenchError> {
    if format == 1 {
        return Ok(());
    }
    let found = format!("format {format}");
    Err(BenchError::Kept { file: file.to_owned(), found, expected: "format 1" })
}

/// A JSON file of a run.
pub(crate) fn read_json<T: DeserializeOwned>(
    file: &Path,
    expected: &'static str,
) -> Result<T, BenchError> {
    let text = input::read_text(file, Limit::Text)?;
    serde_json::from_str(&text).map_err(|why| BenchError::Kept {
        file: file.to_owned(),
        found: files::quote::message(&why.to_string()),
        expected,
    })
}
