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
    let (summary, path) = (&report.summary, report.path.display());
    let (cycles, ending) = if report.has_ended {
        (summary.steps, summary.state.name())
    } else {
        (summary.cycles, "no end recorded: the program was killed, or the power failed")
    };
    print(&format!("{cycles} cycles, {ending}\nreport: {path}"))?;
    Ok(())
}
