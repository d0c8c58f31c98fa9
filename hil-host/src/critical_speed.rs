//! `yawbench critical-speed`: from which speed on does the vehicle of a scenario hunt?
//!
//! One point, or a grid of them with `--vary`, in shards where there are many. A folder that has some of the
//! points goes on.

use crate::progress;
use crate::record::RunFolder;
use anyhow::bail;
use clap::{Args, ValueEnum};
use scenario::run::{Overrides, Run};
use serde::Serialize;
use std::path::PathBuf;
use studies::critical_speed::linear::STROKES_M;
use studies::critical_speed::{Point, Procedure, Question, page, text};
use studies::shards::{self, Shard, Work};
use studies::sweep::{Axis, Grid};

/// What `critical-speed` is told.
#[derive(Debug, Args)]
pub struct CriticalSpeedArgs {
    /// The scenario; its speed, track and duration do not matter.
    scenario: PathBuf,
    /// A key of the scenario, or of its vehicle behind "vehicle.", and the values it takes.
    #[arg(long, value_name = "KEY=FROM:TO:N")]
    vary: Vec<Axis>,
    /// How: over irregular track and down the limit cycle, by eigenvalues, or both; the limit cycle
    /// alone is the quickest.
    #[arg(long, value_enum, default_value_t = Method::Both)]
    method: Method,
    /// Lowest speed tried (km/h).
    #[arg(long, value_name = "KMH", default_value_t = 100.0)]
    from_kmh: f64,
    /// Highest speed tried (km/h).
    #[arg(long, value_name = "KMH", default_value_t = 400.0)]
    to_kmh: f64,
    /// Tracks: seeds 1 to N.
    #[arg(long, value_name = "N", default_value_t = 5)]
    seeds: u64,
    /// Lateral motion of a wheelset that counts as hunting (mm).
    #[arg(long, value_name = "MM", default_value_t = 3.0)]
    threshold_mm: f64,
    /// Strokes of the dampers for eigenvalues, half the travel (mm); at zero a clearance would mean that
    /// there is no damper.
    #[arg(long, value_name = "MM,MM", value_delimiter = ',')]
    stroke_mm: Vec<f64>,
    /// The part of the points to find, such as 1/4.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// No work: the answer from points that shards have found.
    #[arg(long, value_name = "JSONL", num_args = 1.., conflicts_with = "shard")]
    merge: Vec<PathBuf>,
    /// Folder for the files [default: runs/SCENARIO-critical-speed].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print critical-speed.json instead of a table.
    #[arg(long)]
    json: bool,
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

/// `critical-speed.json`.
#[derive(Debug, Serialize)]
struct CriticalSpeedFile<'a> {
    format: u32,
    scenario: String,
    procedure: &'a Procedure,
    points: &'a [Point],
}

/// Runs the command.
///
/// # Errors
/// Bad input, before anything is written; points of another study; a disk that fails.
pub fn command(args: &CriticalSpeedArgs) -> anyhow::Result<()> {
    let question = question(args)?;
    let usual =
        || PathBuf::from(format!("runs/{}-critical-speed", crate::cli::stem(&args.scenario)));
    let folder = RunFolder::at(args.out.clone().unwrap_or_else(usual));
    let name = question.check()?;
    let files = if args.merge.is_empty() {
        folder.create()?;
        let bar = progress::bar("the first points");
        let shard = args.shard.unwrap_or(Shard::WHOLE);
        let work = Work { items: question.grid.len(), name: name.clone() };
        let point = |index| question.point(&name, index);
        let path = shards::run(&work, shard, folder.path(), &point, &|point: &Point, done, of| {
            let message = format!("point {} of {}", point.index + 1, question.grid.len());
            progress::show(&bar, [done, of], message);
        })?;
        bar.finish_and_clear();
        vec![path]
    } else {
        args.merge.clone()
    };
    let points: Vec<Point> = shards::merge(&files)?;
    if let Some(other) = points.first().filter(|point| point.study != name) {
        bail!("{}: {}, expected {name}", files[0].display(), other.study);
    }
    leave(args, &question, &folder, &points)
}

fn question(args: &CriticalSpeedArgs) -> anyhow::Result<Question> {
    let CriticalSpeedArgs { from_kmh, to_kmh, threshold_mm, .. } = *args;
    if !(from_kmh > 0.0 && from_kmh < to_kmh && to_kmh <= 600.0) {
        bail!("--from-kmh {from_kmh} --to-kmh {to_kmh}: expected 0 < from < to <= 600");
    }
    if !(threshold_mm > 0.0 && threshold_mm < 100.0) {
        bail!("--threshold-mm {threshold_mm}: expected more than 0 and less than 100");
    }
    if !(1..=1000).contains(&args.seeds) {
        bail!("--seeds {}: expected 1 to 1000", args.seeds);
    }
    if let Some(stroke) = args.stroke_mm.iter().find(|mm| !(**mm > 0.0 && **mm <= 500.0)) {
        bail!(
            "--stroke-mm {stroke}: expected more than 0 (a clearance leaves no damper there) up to 500"
        );
    }
    let strokes_m = match args.stroke_mm.as_slice() {
        [] => STROKES_M.to_vec(),
        given => given.iter().map(|mm| 1e-3 * mm).collect(),
    };
    let linear = matches!(args.method, Method::Linear | Method::Both);
    Ok(Question {
        scenario: args.scenario.clone(),
        grid: Grid::new(args.vary.clone()).map_err(|why| anyhow::anyhow!("--vary: {why}"))?,
        procedure: Procedure {
            from_kmh,
            to_kmh,
            threshold_m: 1e-3 * threshold_mm,
            seeds: (1..=args.seeds).collect(),
            ..Procedure::default()
        },
        ascent: matches!(args.method, Method::Nonlinear | Method::Both),
        fold: args.method != Method::Linear,
        strokes_m: if linear { strokes_m } else { Vec::new() },
    })
}

/// Writes the files and prints the table.
fn leave(
    args: &CriticalSpeedArgs,
    question: &Question,
    folder: &RunFolder,
    points: &[Point],
) -> anyhow::Result<()> {
    let scenario = args.scenario.display().to_string();
    let procedure = &question.procedure;
    let file = CriticalSpeedFile { format: 1, scenario, procedure, points };
    let json = format!("{}\n", serde_json::to_string_pretty(&file)?);
    let run = Run::load(&args.scenario, Overrides { duration_s: Some(1.0), speed_kmh: None })?;
    let html = page::page(points, procedure, &run.title, &run.about).to_html()?;
    folder.create()?;
    folder.write("critical-speed.json", &json)?;
    folder.write("report.html", &html)?;
    if args.json {
        print!("{json}");
    } else {
        println!("{}", text::text(points, procedure));
        println!("\nfiles in {}: report.html, critical-speed.json", folder.path().display());
    }
    Ok(())
}
