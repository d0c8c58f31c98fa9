//! `yawbench track-server`: the track of a scenario for a locomotive on a board.

use crate::bench_options::OverrideArgs;
use crate::error::CommandError;
use crate::output::{print, warn};
use crate::stop;
use clap::Args;
use hil_host::bus::BusChoice;
use hil_host::track_server::{self, Line, Ways};
use scenario::run::Run;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(crate) struct TrackServerArgs {
    /// The scenario file whose track it is.
    scenario: PathBuf,
    #[command(flatten)]
    overrides: OverrideArgs,
    /// The bus that the locomotive is on: socketcan:INTERFACE.
    #[arg(long, required_unless_present = "line", conflicts_with = "line")]
    bus: Option<BusChoice>,
    /// A serial line to it, by its Unix socket: what an emulated board has in the place of a bus.
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
        (Some(BusChoice::Memory) | None, None) => {
            return Err(CommandError::option(
                "--bus memory",
                "socketcan:INTERFACE, where a locomotive can hear it",
            ));
        }
    };
    let run = Run::load(&args.scenario, args.overrides.overrides())?;
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
