//! `yawbench curve`: how does the vehicle of a scenario go through its curve?

use crate::error::CommandError;
use crate::study::{self, StudyArgs};
use clap::Args;
use files::number;
use std::process::ExitCode;
use vehicle_studies::curve::Procedure;

/// The options of `curve`.
#[derive(Debug, Args)]
pub(crate) struct CurveArgs {
    #[command(flatten)]
    study: StudyArgs,
    /// Prud'homme's factor: 1 for locomotives and coaches, 0.85 for freight wagons.
    #[arg(long, value_name = "K1", default_value_t = 1.0, allow_negative_numbers = true)]
    k1: f64,
}

/// Runs the command.
///
/// # Errors
/// Bad input, before anything is written; points of another study; a disk that fails.
pub(crate) fn command(args: &CurveArgs) -> Result<ExitCode, CommandError> {
    if !(args.k1 > 0.0 && args.k1 <= 1.0) {
        let option = format!("--k1 {}", number(args.k1));
        return Err(CommandError::option(option, "more than 0 and at most 1"));
    }
    study::command(&args.study, Procedure { seeds: args.study.seeds()?, k1: args.k1 })
}
