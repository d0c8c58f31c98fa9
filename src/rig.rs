//! `yawbench rig`: the other end of the bus as a process of its own.

use crate::bench_options::{RealtimeArgs, WireArgs};
use crate::error::CommandError;
use crate::exit::{INTERRUPTED, SAFE_STATE};
use crate::output::{print, warn};
use crate::stop;
use can_protocol::Node;
use clap::Args;
use hil_host::bus::BusChoice;
use hil_host::rig::process::{self, Options};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::Ordering;

#[derive(Debug, Args)]
pub(crate) struct RigArgs {
    /// The rig file; without one, a laboratory rig with a new SS9 yaw damper.
    rig: Option<PathBuf>,
    /// The bus: socketcan:INTERFACE.
    #[arg(long)]
    bus: BusChoice,
    /// Node number, 1 to 4.
    #[arg(long, default_value_t = 1)]
    node: u8,
    #[command(flatten)]
    wire: WireArgs,
    /// Exit when the host has ended its run.
    #[arg(long)]
    exit_after_run: bool,
    /// Let the host's frames in this bus.log arm and move the rig again, as canplayer plays them;
    /// on a virtual interface only.
    #[arg(long, value_name = "LOG")]
    accept_replay: Option<PathBuf>,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    realtime: RealtimeArgs,
}

/// Runs the command.
///
/// # Errors
/// Bad input; the interface cannot be used; real time is required and was not granted.
pub(crate) fn command(args: &RigArgs) -> Result<ExitCode, CommandError> {
    let BusChoice::SocketCan(interface) = &args.bus else {
        return Err(CommandError::option(
            "--bus memory",
            "socketcan:INTERFACE, which a rig of its own needs",
        ));
    };
    let refused = |_| CommandError::option(format!("--node {}", args.node), "1 to 4");
    let node = Node::new(args.node).map_err(refused)?;
    let setup = match &args.rig {
        Some(path) => scenario::rig::RigFile::load(path)?,
        None => scenario::rig::RigFile::default_setup()?,
    };
    warn(&setup.warnings());
    let stop = stop::flag();
    let options = Options {
        accept_replay: args.accept_replay.clone(),
        exit_after_run: args.exit_after_run,
        realtime: args.realtime.options(),
    };
    let summary = process::run_on(&setup, interface, node, args.wire.profile(), &options, stop)?;
    if args.json {
        print(&serde_json::to_string_pretty(&summary)?)?;
    } else {
        print(&process::summary_text(&summary))?;
    }
    Ok(match () {
        () if summary.is_safe() => ExitCode::from(SAFE_STATE),
        () if stop.load(Ordering::Relaxed) => ExitCode::from(INTERRUPTED),
        () => ExitCode::SUCCESS,
    })
}
