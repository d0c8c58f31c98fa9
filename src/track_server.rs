//! `yawbench track-server`: the track of a scenario for a locomotive on a board.

use crate::error::CommandError;
use crate::output::{print, warn};
use crate::stop;
use crate::value::number;
use clap::Args;
use hil_host::bus::BusChoice;
use hil_host::track_server::{self, Line, Ways};
use scenario::run::{Overrides, Run};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(crate) struct TrackServerArgs {
    /// The scenario file whose track it is.
    scenario: PathBuf,
    /// Length of the track as run time (s) [default: that of the scenario].
    #[arg(long, value_name = "S",
        value_parser = number("a duration from 0.001 to 86400 s", |s| (1e-3..=86_400.0).contains(&s)))]
    duration: Option<f64>,
    /// Another speed (km/h): the way in that time.
    #[arg(long, value_name = "KMH",
        value_parser = number("a speed over 0 and up to 324 km/h", |kmh| kmh > 0.0 && kmh <= 324.0))]
    speed_kmh: Option<f64>,
    /// The bus that the locomotive is on: socketcan:INTERFACE. It serves until Ctrl-C.
    #[arg(long, conflicts_with = "line")]
    bus: Option<BusChoice>,
    /// In the place of a bus a Unix socket that listens, such as that of an emulated board: frames
    /// in SLIP, until it is closed.
    #[arg(long, value_name = "SOCKET")]
    line: Option<PathBuf>,
    /// Run the track there and back and there again, so that it has no end.
    #[arg(long)]
    there_and_back: bool,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
}

/// Runs the command. Ctrl-C is its usual end.
///
/// # Errors
/// Bad input, or a track that does not travel; the interface or the line cannot be used.
pub(crate) fn command(args: &TrackServerArgs) -> Result<ExitCode, CommandError> {
    let line = match (&args.bus, &args.line) {
        (Some(BusChoice::SocketCan(interface)), _) => Line::Can(interface.clone()),
        (_, Some(line)) => Line::Serial(line.clone()),
        (Some(BusChoice::Memory), None) => {
            return Err(CommandError::option(
                "--bus memory",
                "socketcan:INTERFACE, where a locomotive can hear it",
            ));
        }
        (None, None) => {
            return Err(CommandError::option("--bus", "socketcan:INTERFACE, or --line SOCKET"));
        }
    };
    let overrides =
        Overrides { duration_s: args.duration, speed_kmh: args.speed_kmh, ..Overrides::default() };
    let run = Run::load(&args.scenario, overrides)?;
    warn(&run.warnings);
    let stop = stop::flag();
    let ways = if args.there_and_back { Ways::ThereAndBack } else { Ways::One };
    let summary = track_server::run_on((&args.scenario, &run), ways, &line, stop)?;
    if args.json {
        print(&serde_json::to_string_pretty(&summary)?)?;
    } else {
        print(&track_server::summary_text(&summary))?;
    }
    Ok(ExitCode::SUCCESS)
}
