//! `yawbench rig-delay`: by how much is a critical speed wrong that is measured with a rig that is
//! late?

use crate::error::CommandError;
use crate::study::{self, StudyArgs};
use crate::value::number;
use clap::Args;
use scenario::setting::Change;
use std::process::ExitCode;
use vehicle_studies::critical_speed::Procedure;
use vehicle_studies::grid::Axis;
use vehicle_studies::rig_delay::{OWN_KEY, Question};

/// Delays unless others are given (ms).
const DELAYS_MS: &str = "-2,0,1,2,3,5,8";
/// Time over which the delay is measured (s): as many blocks as an interval needs, and some more.
const MEASURED_S: f64 = 8.0;

/// The options of `rig-delay`.
#[derive(Debug, Args)]
pub(crate) struct RigDelayArgs {
    #[command(flatten)]
    study: StudyArgs,
    /// Delays of the force that compensation has left (ms), negative for a force that is early.
    #[arg(long, value_name = "MS,MS", value_delimiter = ',', default_value = DELAYS_MS,
        value_parser = number("delays from -20 to 60 ms", |ms| (-20.0..=60.0).contains(&ms)))]
    delay_ms: Vec<f64>,
    /// Ask for the speed too from which irregular track leads to hunting, on the tracks of --seeds;
    /// it takes as long again for each of them.
    #[arg(long)]
    hunts_from: bool,
    /// Lowest speed tried (km/h).
    #[arg(long, value_name = "KMH", default_value_t = 100.0)]
    from_kmh: f64,
    /// Highest speed tried, from which the hunting is followed down (km/h).
    #[arg(long, value_name = "KMH", default_value_t = 300.0)]
    to_kmh: f64,
    /// Stroke of the dampers for eigenvalues, half the travel (mm).
    #[arg(long, value_name = "MM", default_value = "2",
        value_parser = number("a stroke from 0.001 to 500 mm", |mm| (1e-3..=500.0).contains(&mm)))]
    stroke_mm: f64,
}

/// Runs the command.
///
/// # Errors
/// Bad input, before anything is written; points of another study; a disk that fails.
pub(crate) fn command(args: &RigDelayArgs) -> Result<ExitCode, CommandError> {
    let RigDelayArgs { from_kmh, to_kmh, stroke_mm, .. } = *args;
    if !(from_kmh > 0.0 && from_kmh < to_kmh && to_kmh <= 600.0) {
        let speeds = [from_kmh, to_kmh].map(files::number);
        let options = format!("--from-kmh {} --to-kmh {}", speeds[0], speeds[1]);
        return Err(CommandError::option(options, "0 < from < to <= 600"));
    }
    if args.study.varies("speed_kmh") {
        let expected = "--from-kmh and --to-kmh, since the speed is the unknown";
        return Err(CommandError::option("--vary speed_kmh", expected));
    }
    let mut sorted = args.delay_ms.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        let found = format!("--delay-ms with {} twice", files::number(pair[0]));
        return Err(CommandError::option(found, "each once"));
    }
    let delays = args.delay_ms.iter().map(|ms| Change::Value(*ms));
    let own = Axis { key: OWN_KEY.to_owned(), changes: delays.collect() };
    let question = Question {
        procedure: Procedure {
            from_kmh,
            to_kmh,
            seeds: args.study.seeds()?,
            ..Procedure::default()
        },
        hunts_from: args.hunts_from,
        stroke_m: 1e-3 * stroke_mm,
        measured_s: MEASURED_S,
    };
    study::command_over(&args.study, Some(own), question)
}
