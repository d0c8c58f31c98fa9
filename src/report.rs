//! `yawbench report`: the report of a run from the files in its folder.

use crate::error::CommandError;
use crate::output::print;
use clap::Args;
use hil_host::run;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct ReportArgs {
    /// The folder of the run.
    #[arg(value_name = "RUN")]
    run: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// A folder without a run, a file of it that cannot be read, a disk that fails.
pub(crate) fn command(args: &ReportArgs) -> Result<(), CommandError> {
    let report = run::report(&args.run)?;
    let (cycles, path) = (report.summary.steps, report.path.display());
    let ending = if report.has_ended {
        report.summary.state.name()
    } else {
        "no end recorded: the program was killed, or the power failed"
    };
    print(&format!("{cycles} cycles, {ending}\nreport: {path}"))?;
    Ok(())
}
