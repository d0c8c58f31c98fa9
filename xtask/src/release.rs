//! The release build runs README's first command, and gives the same bits as the build of the
//! tests.

use std::fs::{self, File};
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use crate::run::{Outcome, Run};
use crate::stream::shown;

/// A release build that goes on beside the steps before its own, with what they leave of the
/// processors. Its output is shown where it fails.
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
                println!("release build, beside other steps: {:.0} s", took.as_secs_f64());
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
    let mut nice = run.cargo_niced("19");
    nice.args(["build", "--release"]);
    let place = log(run);
    let kept =
        place.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| File::create(&place));
    let kept = kept.map_err(|error| format!("{}: {error}", place.display()))?;
    nice.stdout(Stdio::null()).stderr(kept);
    nice.spawn().map_err(|error| format!("{}: {error}", shown(&nice)))
}

/// Waits for the build and compares the trajectory of a few seconds with that of the debug build.
pub(crate) fn same_bits(run: &mut Run, build: Build) -> Outcome {
    let built = build.end(run);
    if !matches!(built, Outcome::Passed) {
        return built;
    }
    let mut hashes = Vec::new();
    for profile in ["debug", "release"] {
        match hash(run, profile) {
            Ok(hash) => hashes.push(hash),
            Err(reason) => return Outcome::Failed(reason),
        }
    }
    println!("trajectory: debug {}, release {}", hashes[0], hashes[1]);
    if hashes[0] == hashes[1] {
        Outcome::Passed
    } else {
        Outcome::Failed("debug and release do not give the same trajectory".to_owned())
    }
}

/// The trajectory hash of three seconds at 160 km/h.
fn hash(run: &Run, profile: &str) -> Result<String, String> {
    let out = run.target.join("xtask-run").join(profile);
    let mut command = Command::new(run.target.join(profile).join("yawbench"));
    command.args(["run", "scenarios/ss9-160kmh.toml", "--pace", "fast", "--duration", "3"]);
    command
        .args(["--json", "--overwrite", "--out"])
        .arg(&out)
        .current_dir(&run.root)
        .stderr(Stdio::inherit());
    let output = command.output().map_err(|error| format!("yawbench ({profile}): {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let line = text.lines().find(|line| line.contains("\"trajectory_hash\""));
    let hash = line.and_then(|line| line.split('"').nth(3));
    hash.map(str::to_owned).ok_or_else(|| format!("yawbench ({profile}) gave no hash"))
}
