//! What the commands on studies of a vehicle share: a grid of keys, shards, merging, files, the table.
//!
//! One point, or a grid of them with `--vary`, in shards where there are many. A folder that has some of
//! the points goes on.

use crate::exit::FAILED;
use crate::output::print;
use crate::progress;
use anyhow::bail;
use clap::Args;
use hil_host::record::RunFolder;
use report::Report;
use scenario::run::{Overrides, Run};
use serde::Serialize;
use signal::shards::{self, Item, Shard, Work};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use vehicle_studies::study::{Asked, Point, Study, Varied};
use vehicle_studies::sweep::{Axis, Grid};

/// What every study of a vehicle is told.
#[derive(Debug, Args)]
pub(crate) struct StudyArgs {
    /// The scenario.
    scenario: PathBuf,
    /// A key of the scenario, or of its vehicle behind "vehicle.", and the values it takes: KEY=FROM:TO:N or
    /// KEY=A,B,C; with *= instead of = they multiply what stands there.
    #[arg(long, value_name = "KEY=VALUES")]
    vary: Vec<Axis>,
    /// Tracks: seeds 1 to N.
    #[arg(long, value_name = "N", default_value_t = 5)]
    seeds: u64,
    /// The part of the points to find, such as 1/4.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// No work: the answer from points that shards have found.
    #[arg(long, value_name = "JSONL", num_args = 1.., conflicts_with = "shard")]
    merge: Vec<PathBuf>,
    /// Folder for the files [default: runs/SCENARIO-COMMAND].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the JSON file instead of a table.
    #[arg(long)]
    json: bool,
}

impl StudyArgs {
    /// True where a key is varied.
    pub(crate) fn varies(&self, key: &str) -> bool {
        self.vary.iter().any(|axis| axis.key == key)
    }

    /// The seeds of the tracks.
    ///
    /// # Errors
    /// None, or more than a thousand.
    pub(crate) fn seeds(&self) -> anyhow::Result<Vec<u64>> {
        if !(1..=1000).contains(&self.seeds) {
            bail!("--seeds {}: expected 1 to 1000", self.seeds);
        }
        Ok((1..=self.seeds).collect())
    }
}

/// The JSON file of a study.
#[derive(Debug, Serialize)]
struct StudyFile<'a, P, F> {
    format: u32,
    scenario: String,
    procedure: &'a P,
    points: &'a [Point<F>],
}

/// Puts a question to every point, or merges the answers that shards have found, and tells them. Exit code 1
/// says that a point has no answer; the files are there all the same.
///
/// # Errors
/// Bad input, before anything is written; points of another study; a disk that fails.
pub(crate) fn command<S: Study>(args: &StudyArgs, study: S) -> anyhow::Result<ExitCode> {
    let grid = Grid::new(args.vary.clone()).map_err(|why| anyhow::anyhow!("--vary: {why}"))?;
    let asked = Asked { varied: Varied { scenario: args.scenario.clone(), grid }, study };
    let usual =
        || PathBuf::from(format!("runs/{}-{}", crate::output::stem(&args.scenario), S::CALLED));
    let folder = RunFolder::at(args.out.clone().unwrap_or_else(usual));
    let name = asked.check()?;
    let files = if args.merge.is_empty() {
        folder.create()?;
        vec![find(&asked, &name, args.shard.unwrap_or(Shard::WHOLE), folder.path())?]
    } else {
        args.merge.clone()
    };
    let points: Vec<Point<S::Found>> = shards::merge(&files)?;
    if let Some(other) = points.first().filter(|point| point.study != name) {
        bail!("{}: {}, expected {name}", files[0].display(), other.study);
    }
    let of = asked.varied.grid.len();
    if !args.merge.is_empty() && points.len() < of {
        // Merged points stand in order, each once.
        let found = |index: &usize| points.binary_search_by_key(index, |point| point.index).is_ok();
        let missing = (0..of).filter(|index| !found(index)).map(|index| (index + 1).to_string());
        let missing = missing.collect::<Vec<_>>().join(", ");
        bail!("--merge: point {missing} of {of} not found, expected all");
    }
    leave(args, &asked.study, &folder, &points)?;
    let failed = points.iter().any(|point| point.failure.is_some());
    Ok(if failed { ExitCode::from(FAILED) } else { ExitCode::SUCCESS })
}

fn find<S: Study>(
    asked: &Asked<S>,
    name: &str,
    shard: Shard,
    folder: &Path,
) -> anyhow::Result<PathBuf> {
    let bar = progress::bar("the first points");
    let items = asked.varied.grid.len();
    let work = Work { items, name: name.to_owned() };
    let point = |index| asked.point(name, index);
    let show = |point: &Point<S::Found>, done, of| {
        progress::show(&bar, [done, of], format!("point {} of {items}", point.index + 1));
    };
    let path = shards::run(&work, shard, folder, &point, &show)?;
    bar.finish_and_clear();
    Ok(path)
}

/// Writes the files and prints the table.
fn leave<S: Study>(
    args: &StudyArgs,
    study: &S,
    folder: &RunFolder,
    points: &[Point<S::Found>],
) -> anyhow::Result<()> {
    let lasting: Vec<_> = points.iter().map(Item::lasting).collect();
    let scenario = args.scenario.display().to_string();
    let file = StudyFile { format: 1, scenario, procedure: study, points: &lasting };
    let json = format!("{}\n", serde_json::to_string_pretty(&file)?);
    let run = Run::load(&args.scenario, Overrides { duration_s: Some(1.0), speed_kmh: None })?;
    let titled = Report::new(&run.title);
    let titled = run.about.iter().fold(titled, |report, line| report.fact("vehicle", line));
    let html = study.page(&lasting, titled).to_html()?;
    folder.create()?;
    let name = format!("{}.json", S::CALLED);
    folder.write(&name, &json)?;
    folder.write("report.html", &html)?;
    if args.json {
        print(&json)?;
    } else {
        let (text, place) = (study.text(points), folder.path().display());
        print(&format!("{text}\n\nfiles in {place}: report.html, {name}"))?;
    }
    Ok(())
}
