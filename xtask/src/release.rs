//! The release build runs every scenario, README's first command among them, and gives the same
//! bits as the build of the tests.

use std::fs::{self, File};
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use crate::run::{Outcome, Run};
use crate::stream::shown;

/// A release build that goes on beside the step before its own, on all processors but one. Its
/// output is shown where it fails.
pub(crate) struct Build {
    child: Result<Child, String>,
    started: Instant,
}

impl Build {
    /// Begins it.
    pub(crate) fn begin(run: &Run) -> Self {
        let started = Instant::now();
        Self { child: spawned(run), started }
    }

    fn end(self, run: &Run) -> Outcome {
        let status = match self.child {
            Ok(mut child) => child.wait().map_err(|error| error.to_string()),
            Err(error) => Err(error),
        };
        match status {
            Ok(status) if status.success() => {
                // The log is written last when the build ends.
                let ended = fs::metadata(log(run)).and_then(|log| log.modified()).ok();
                let since = ended.and_then(|ended| ended.elapsed().ok()).unwrap_or_default();
                let took = self.started.elapsed().saturating_sub(since);
                println!("release build, beside another step: {:.0} s", took.as_secs_f64());
                Outcome::Passed
            }
            Ok(status) => {
                print!("{}", fs::read_to_string(log(run)).unwrap_or_default());
                Outcome::Failed(format!("release build: {status}"))
            }
            Err(error) => Outcome::Failed(format!("release build: {error}")),
        }
    }
}

fn log(run: &Run) -> std::path::PathBuf {
    run.target.join("xtask-run").join("release.log")
}

fn spawned(run: &Run) -> Result<Child, String> {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let mut nice = run.cargo_niced();
    nice.args(["build", "--release", "--jobs", &(processors - 1).max(1).to_string()]);
    let place = log(run);
    let kept =
        place.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| File::create(&place));
    let kept = kept.map_err(|error| format!("{}: {error}", place.display()))?;
    nice.stdout(Stdio::null()).stderr(kept);
    nice.spawn().map_err(|error| format!("{}: {error}", shown(&nice)))
}

/// Waits for the build and compares the golden hashes of whole scenarios, as a user runs them;
/// `bits::in_release` has those of what needs no bench.
pub(crate) fn same_bits(run: &mut Run, build: Build) -> Outcome {
    let built = build.end(run);
    if !matches!(built, Outcome::Passed) {
        return built;
    }
    scenarios(run)
}

/// Compares the trajectories of the scenarios of `tests/golden.toml`.
fn scenarios(run: &Run) -> Outcome {
    let place = run.root.join("tests/golden.toml");
    let text = match fs::read_to_string(&place) {
        Ok(text) => text,
        Err(error) => return Outcome::Failed(format!("{}: {error}", place.display())),
    };
    let golden = group(&text, "scenario");
    let mut all = Outcome::Passed;
    for (name, known) in &golden {
        match hash(run, name) {
            Ok(hash) if hash == *known => {}
            Ok(hash) => {
                let why = format!("{name} in release: {hash}, in {} {known}", place.display());
                all = all.and(Outcome::Failed(why));
            }
            Err(reason) => return Outcome::Failed(reason),
        }
    }
    if golden.is_empty() {
        return Outcome::Failed(format!("{} holds no scenario", place.display()));
    }
    println!("{} whole scenarios in release, against their golden hashes", golden.len());
    all
}

/// Names and hashes in a group of the file: `name = "hash"`, a line each.
fn group<'t>(text: &'t str, group: &str) -> Vec<(&'t str, &'t str)> {
    let head = format!("[{group}]");
    let lines = text.lines().skip_while(|line| *line != head).skip(1);
    let entries = lines.take_while(|line| !line.starts_with('['));
    entries
        .filter_map(|line| line.split_once(" = "))
        .map(|(n, h)| (n, h.trim_matches('"')))
        .collect()
}

/// The trajectory hash of a whole scenario in the release build.
fn hash(run: &Run, scenario: &str) -> Result<String, String> {
    let out = run.target.join("xtask-run").join("release");
    let mut command = Command::new(run.target.join("release/yawbench"));
    command.arg("run").arg(format!("scenarios/{scenario}.toml")).args(["--pace", "fast"]);
    command
        .args(["--json", "--overwrite", "--out"])
        .arg(&out)
        .current_dir(&run.root)
        .stderr(Stdio::inherit());
    let output = command.output().map_err(|error| format!("yawbench {scenario}: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    // Of the run itself, not of another that it names.
    let line = text.lines().find(|line| line.starts_with("  \"trajectory_hash\""));
    let hash = line.and_then(|line| line.split('"').nth(3));
    hash.map(str::to_owned).ok_or_else(|| format!("yawbench {scenario} gave no hash"))
}
