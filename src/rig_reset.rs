//! `yawbench rig-reset`: a latched rig, released by an operator.

use crate::error::CommandError;
use crate::output::print;
use can_protocol::Node;
use clap::Args;
use hil_host::bus::BusChoice;
use hil_host::reset_rig;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(crate) struct RigResetArgs {
    /// The bus: socketcan:INTERFACE.
    #[arg(long)]
    bus: BusChoice,
    /// Node number, 1 to 4.
    #[arg(long, default_value_t = 1)]
    node: u8,
}

/// Runs the command.
///
/// # Errors
/// Bad input; the interface cannot be used; the rig does not answer or refuses.
pub(crate) fn command(args: &RigResetArgs) -> Result<ExitCode, CommandError> {
    let BusChoice::SocketCan(interface) = &args.bus else {
        return Err(CommandError::option(
            "--bus memory",
            "socketcan:INTERFACE: rigs in memory begin anew with every run",
        ));
    };
    let refused = |_| CommandError::option(format!("--node {}", args.node), "1 to 4");
    let node = Node::new(args.node).map_err(refused)?;
    reset_rig(interface, node)?;
    print(&format!("rig node {node} on {} is reset; it is in INIT and not armed", args.bus))?;
    Ok(ExitCode::SUCCESS)
}
