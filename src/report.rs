//! `yawbench report`: the report of a run from the files in its folder.

use crate::error::CommandError;
use crate::exit::FAILED;
use crate::output::print;
use clap::Args;
use hil_host::run;
use hil_host::run::Ending;
use std::path::PathBuf;
use std::process::ExitCode;

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
pub(crate) fn command(args: &ReportArgs) -> Result<ExitCode, CommandError> {
    let report = run::report(&args.run)?;
    let (summary, path) = (&report.summary, report.path.display().to_string());
    let path = files::quoted(&path);
    let steps = summary.steps;
    let (ending, code) = match report.ending {
        Ending::Known => (summary.state.name().to_owned(), ExitCode::SUCCESS),
        Ending::Unknown { .. } => {
            let killed = "no end recorded: the program was killed, or the power failed";
            (killed.to_owned(), ExitCode::SUCCESS)
        }
        Ending::Contradicted { counted_cycles } => {
            let found = summary.cycles;
            let unknown = format!(
                "end unknown: summary.json counts {counted_cycles} cycles with the ramps, the \
                 record ends with cycle {found} or is another one"
            );
            (unknown, ExitCode::from(FAILED))
        }
    };
    print(&format!("{steps} cycles of RUN, {ending}\nreport: {path}"))?;
    Ok(code)
}
