//! `yawbench critical-speed`: from which speed on does the vehicle of a scenario hunt?

use crate::error::CommandError;
use crate::study::{self, StudyArgs};
use clap::{Args, ValueEnum};
use files::number;
use std::process::ExitCode;
use vehicle_studies::critical_speed::STROKES_M;
use vehicle_studies::critical_speed::{Criterion, Procedure, Question};

/// The options of `critical-speed`.
#[derive(Debug, Args)]
pub(crate) struct CriticalSpeedArgs {
    #[command(flatten)]
    study: StudyArgs,
    /// How: over irregular track and down the limit cycle, by eigenvalues, or both; the limit cycle
    /// alone is the quickest.
    #[arg(long, value_enum, default_value_t = Method::Both)]
    method: Method,
    /// What counts as hunting over irregular track.
    #[arg(long, value_enum, default_value_t = CriterionChoice::LimitCycle)]
    criterion: CriterionChoice,
    /// Lowest speed tried (km/h).
    #[arg(long, value_name = "KMH", default_value_t = 100.0, allow_negative_numbers = true)]
    from_kmh: f64,
    /// Highest speed tried (km/h).
    #[arg(long, value_name = "KMH", default_value_t = 400.0, allow_negative_numbers = true)]
    to_kmh: f64,
    /// Lateral motion of a wheelset that counts as hunting (mm).
    #[arg(long, value_name = "MM", default_value_t = 3.0, allow_negative_numbers = true)]
    threshold_mm: f64,
    /// Strokes of the dampers for eigenvalues, half the travel (mm); at zero a clearance would mean
    /// that there is no damper.
    #[arg(long, value_name = "MM,MM", value_delimiter = ',', allow_negative_numbers = true)]
    stroke_mm: Vec<f64>,
}

/// What counts as hunting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum CriterionChoice {
    /// A motion that stays on perfect track behind the irregular one.
    LimitCycle,
    /// Guiding forces on irregular track above EN 14363's limit.
    En14363,
}

/// How critical speeds are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Method {
    /// Over irregular track, and down the limit cycle.
    Nonlinear,
    /// Down the limit cycle alone.
    Fold,
    /// By eigenvalues.
    Linear,
    /// All of them.
    Both,
}

/// Runs the command.
///
/// # Errors
/// Bad input, before anything is written; points of another study; a disk that fails.
pub(crate) fn command(args: &CriticalSpeedArgs) -> Result<ExitCode, CommandError> {
    study::command(&args.study, question(args)?)
}

fn question(args: &CriticalSpeedArgs) -> Result<Question, CommandError> {
    let CriticalSpeedArgs { from_kmh, to_kmh, threshold_mm, .. } = *args;
    if !(from_kmh > 0.0 && from_kmh < to_kmh && to_kmh <= 600.0) {
        let options = format!("--from-kmh {} --to-kmh {}", number(from_kmh), number(to_kmh));
        return Err(CommandError::option(options, "0 < from < to <= 600"));
    }
    if !(threshold_mm > 0.0 && threshold_mm < 100.0) {
        let option = format!("--threshold-mm {}", number(threshold_mm));
        return Err(CommandError::option(option, "more than 0 and less than 100"));
    }
    if let Some(stroke) = args.stroke_mm.iter().find(|mm| !(1e-3..=500.0).contains(*mm)) {
        let expected = "0.001 to 500: at zero stroke a damper with clearance has no force";
        return Err(CommandError::option(format!("--stroke-mm {}", number(*stroke)), expected));
    }
    let linear = matches!(args.method, Method::Linear | Method::Both);
    if !(linear || args.stroke_mm.is_empty()) {
        return Err(CommandError::option(
            "--stroke-mm",
            "--method linear or both, which compute eigenvalues",
        ));
    }
    let rough = matches!(args.method, Method::Nonlinear | Method::Both);
    if args.criterion == CriterionChoice::En14363 && !rough {
        let expected = "--method nonlinear or both, which run over irregular track";
        return Err(CommandError::option("--criterion en14363", expected));
    }
    if args.study.varies("speed_kmh") {
        let expected = "--from-kmh and --to-kmh, since the speed is the unknown";
        return Err(CommandError::option("--vary speed_kmh", expected));
    }
    let strokes_m = match args.stroke_mm.as_slice() {
        [] => STROKES_M.to_vec(),
        given => given.iter().map(|mm| 1e-3 * mm).collect(),
    };
    Ok(Question {
        procedure: Procedure {
            criterion: match args.criterion {
                CriterionChoice::LimitCycle => Criterion::LimitCycle,
                CriterionChoice::En14363 => Criterion::En14363,
            },
            from_kmh,
            to_kmh,
            threshold_m: 1e-3 * threshold_mm,
            seeds: args.study.seeds()?,
            ..Procedure::default()
        },
        ascent: rough,
        fold: args.method != Method::Linear,
        strokes_m: if linear { strokes_m } else { Vec::new() },
    })
}
