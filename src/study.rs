//! What the commands on studies of a vehicle share: a grid of keys, shards, merging, files, the
//! table.
//!
//! One point, or a grid of them with `--vary`, in shards where there are many. A folder that holds
//! some of the points of the same study is continued.

use crate::error::CommandError;
use crate::exit::{FAILED, INTERRUPTED};
use crate::output::{print, warn};
use crate::{output, progress, stop};
use clap::Args;
use files::{Identity, ResultFolder};
use report::Report;
use scenario::run::{Overrides, Run};
use serde::Serialize;
use signal::shards::{self, Computed, Item, Shard, Work};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use vehicle_studies::GridPoint;
use vehicle_studies::grid::{Axis, Grid};
use vehicle_studies::study::{Study, Varied, VariedStudy};
use vehicle_studies::trip::Together;

/// Most points that one command computes: a point takes seconds.
const POINTS_MAX: usize = 20_000;

/// The options of every study of a vehicle.
#[derive(Debug, Args)]
pub(crate) struct StudyArgs {
    /// The scenario.
    scenario: PathBuf,
    /// A key of the scenario, or of its vehicle after "vehicle.", and its values: KEY=FROM:TO:N or
    /// KEY=A,B,C; with *= instead of = they multiply the number in the file.
    #[arg(long, value_name = "KEY=VALUES")]
    vary: Vec<Axis>,
    /// Tracks: seeds 1 to N.
    #[arg(long, value_name = "N", default_value_t = 5)]
    seeds: u64,
    /// The part of the points to compute, such as 1/4.
    #[arg(long, value_name = "I/N", allow_hyphen_values = true)]
    shard: Option<Shard>,
    /// Compute nothing: make the answer from points that shards have computed.
    #[arg(long, value_name = "JSONL", num_args = 1.., conflicts_with = "shard")]
    merge: Vec<PathBuf>,
    /// Folder for the files [default: runs/SCENARIO-COMMAND, with -2, -3, ... for another study].
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
    pub(crate) fn seeds(&self) -> Result<Vec<u64>, CommandError> {
        if !(1..=1000).contains(&self.seeds) {
            return Err(CommandError::option(format!("--seeds {}", self.seeds), "1 to 1000"));
        }
        Ok((1..=self.seeds).collect())
    }
}

/// The JSON file of a study.
#[derive(Debug, Serialize)]
struct StudyFile<'a, P, A> {
    format: u32,
    scenario: String,
    procedure: &'a P,
    points: &'a [GridPoint<A>],
}

/// Asks a question at every point, or merges the answers that shards have computed, and shows them.
/// Exit code 1 means that a point has no answer; the files are written all the same.
///
/// # Errors
/// Bad input, before anything is written; points of another study; files that change while the
/// study runs; a disk that fails.
pub(crate) fn command<S: Study>(args: &StudyArgs, study: S) -> Result<ExitCode, CommandError> {
    command_over(args, None, study)
}

/// The same over an axis of the question's own, which changes slowest.
///
/// # Errors
/// As for [`command`].
pub(crate) fn command_over<S: Study>(
    args: &StudyArgs,
    own: Option<Axis>,
    study: S,
) -> Result<ExitCode, CommandError> {
    let grid = Grid::new(own.into_iter().chain(args.vary.clone()).collect())?;
    let shard = args.shard.unwrap_or(Shard::WHOLE);
    if args.merge.is_empty() {
        check_size(&grid, shard, args.seeds)?;
    }
    let varied = Varied { scenario: args.scenario.clone(), grid };
    let asked = VariedStudy { varied, study };
    let identity = asked.identity()?;
    let run = Run::load_at_usual_rate(
        &args.scenario,
        Overrides { duration_s: Some(1.0), ..Overrides::default() },
    )?;
    let name = format!("{}-{}", output::stem(&args.scenario), S::NAME);
    let (mut folder, changed) =
        ResultFolder::for_identity(args.out.as_deref(), &name, S::NAME, &identity)?;
    folder.check(&[&format!("{}.json", S::NAME), "report.html"])?;
    if !args.merge.is_empty() {
        let points = merged(args, &asked, &identity)?;
        note(changed);
        warn(&run.warnings);
        folder.create()?;
        return finish(args, &asked.study, &run, &folder, &points);
    }
    note(changed);
    warn(&run.warnings);
    folder.create()?;
    let computed = compute(&asked, &identity, shard, &folder)?;
    output::note_cut_off(&computed, "point");
    if computed.is_stopped() {
        let Computed { path, done, of, .. } = computed;
        files::say!(
            "interrupted: {} holds {done} of {of} points; the same command continues",
            path.display()
        );
        return Ok(ExitCode::from(INTERRUPTED));
    }
    let points = shards::merge(&[computed.path], Some(&identity))?;
    finish(args, &asked.study, &run, &folder, &points)
}

/// Refuses more points than one command computes in a reasonable time.
fn check_size(grid: &Grid, shard: Shard, seeds: u64) -> Result<(), CommandError> {
    let points = grid.len().div_ceil(shard.of);
    if points <= POINTS_MAX {
        return Ok(());
    }
    let shards = grid.len().div_ceil(POINTS_MAX);
    let tracks = if seeds == 1 { "1 track".to_owned() } else { format!("{seeds} tracks") };
    Err(CommandError::option(
        format!("--vary: {points} points of {tracks} each"),
        format!("at most {POINTS_MAX} in one command; --shard 1/{shards} computes a part of them"),
    ))
}

/// Says why another folder than the usual one is used.
fn note(changed: Option<String>) {
    if let Some(changed) = changed {
        files::say!("note: {changed}");
    }
}

/// The points of every file, all of this study and none missing.
fn merged<S: Study>(
    args: &StudyArgs,
    asked: &VariedStudy<S>,
    identity: &Identity,
) -> Result<Vec<GridPoint<S::Answer>>, CommandError> {
    let points: Vec<GridPoint<S::Answer>> = shards::merge(&args.merge, Some(identity))?;
    let of = asked.varied.grid.len();
    // Merged points are in order, each once.
    let found = |index: &usize| points.binary_search_by_key(index, |point| point.index).is_ok();
    let missing = (0..of).filter(|index| !found(index)).map(|index| (index + 1).to_string());
    let missing: Vec<String> = missing.collect();
    if !missing.is_empty() {
        let found = format!("no point {} of {of}", missing.join(", "));
        let file = "--merge".into();
        return Err(CommandError::Input { file, found, expected: "all of them".into() });
    }
    Ok(points)
}

fn compute<S: Study>(
    asked: &VariedStudy<S>,
    identity: &Identity,
    shard: Shard,
    folder: &ResultFolder,
) -> Result<Computed, CommandError> {
    let items = asked.varied.grid.len();
    let work = Work { items, name: asked.name(identity), identity };
    let bar = progress::bar("the first points");
    let stop = stop::flag();
    let together = Arc::new(Together::on_all_cores());
    let point = |index| asked.point_among_others(identity, index, stop, &together);
    let show = |point: &GridPoint<S::Answer>, done, of| {
        progress::show(&bar, [done, of], format!("point {} of {items}", point.index + 1));
    };
    let computed = together.install(|| shards::run(&work, shard, folder, stop, &point, &show));
    bar.finish_and_clear();
    Ok(computed?)
}

/// Writes the files and prints the table.
fn finish<S: Study>(
    args: &StudyArgs,
    study: &S,
    run: &Run,
    folder: &ResultFolder,
    points: &[GridPoint<S::Answer>],
) -> Result<ExitCode, CommandError> {
    let lasting: Vec<_> = points.iter().map(Item::lasting).collect();
    let scenario = args.scenario.display().to_string();
    let file = StudyFile { format: 1, scenario, procedure: study, points: &lasting };
    let json = format!("{}\n", serde_json::to_string_pretty(&file)?);
    let titled = Report::new(&run.title);
    let titled = run.about.iter().fold(titled, |report, line| report.fact("vehicle", line));
    let html = study.page(&lasting, titled).to_html()?;
    let name = format!("{}.json", S::NAME);
    // The files are written whole.
    let _ = stop::flag();
    folder.write(&name, &json)?;
    folder.write("report.html", &html)?;
    if args.json {
        print(&json)?;
    } else {
        let (text, place) = (study.text(points), folder.path().display());
        print(&format!("{text}\n\nfiles in {place}: report.html, {name}"))?;
    }
    let failed = points.iter().any(|point| point.failure.is_some());
    Ok(if failed { ExitCode::from(FAILED) } else { ExitCode::SUCCESS })
}
