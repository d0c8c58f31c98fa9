//! `yawbench ride`: how does the vehicle of a scenario ride on straight track?

use crate::error::CommandError;
use crate::study::{self, StudyArgs};
use clap::{Args, ValueEnum};
use files::number;
use std::process::ExitCode;
use vehicle_studies::ride::Kind;
use vehicle_studies::ride::Procedure;
use vehicle_studies::ride::sperling::WINDOW_1985_S;

/// The options of `ride`.
#[derive(Debug, Args)]
pub(crate) struct RideArgs {
    #[command(flatten)]
    study: StudyArgs,
    /// Whose grades are reported.
    #[arg(long, value_enum, default_value_t = GradesOf::Locomotive)]
    grades: GradesOf,
    /// Time on each track that counts (s); a minute on five tracks are the sixty blocks of EN
    /// 12299.
    #[arg(long, value_name = "S", default_value_t = 60.0, allow_negative_numbers = true)]
    section_s: f64,
    /// Time at the beginning of each track that does not count (s).
    #[arg(long, value_name = "S", default_value_t = 5.0, allow_negative_numbers = true)]
    run_in_s: f64,
    /// Height of the floor above the rails (m).
    #[arg(long, value_name = "M", default_value_t = 1.25, allow_negative_numbers = true)]
    floor_m: f64,
}

/// Whose grades.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum GradesOf {
    /// TB/T 2360-93.
    Locomotive,
    /// GB 5599-85, passenger coaches.
    Coach,
}

/// Runs the command.
///
/// # Errors
/// Bad input, before anything is written; points of another study; a disk that fails.
pub(crate) fn command(args: &RideArgs) -> Result<ExitCode, CommandError> {
    study::command(&args.study, procedure(args)?)
}

fn procedure(args: &RideArgs) -> Result<Procedure, CommandError> {
    let RideArgs { section_s, run_in_s, floor_m, .. } = *args;
    if !(WINDOW_1985_S..=3600.0).contains(&section_s) {
        let expected = format!("{WINDOW_1985_S} (one window of the index) to 3600");
        return Err(CommandError::option(format!("--section-s {}", number(section_s)), expected));
    }
    if !(0.0..=600.0).contains(&run_in_s) {
        return Err(CommandError::option(format!("--run-in-s {}", number(run_in_s)), "0 to 600"));
    }
    if !(0.0..=6.0).contains(&floor_m) {
        return Err(CommandError::option(format!("--floor-m {}", number(floor_m)), "0 to 6"));
    }
    Ok(Procedure {
        kind: match args.grades {
            GradesOf::Locomotive => Kind::Locomotive,
            GradesOf::Coach => Kind::Coach,
        },
        seeds: args.study.seeds()?,
        run_in_s,
        section_s,
        floor_height_m: floor_m,
    })
}
