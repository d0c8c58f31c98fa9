//! The release build runs README's first command, and gives the same bits as the build of the
//! tests.

use std::process::Stdio;
use std::time::Instant;

use crate::run::{Outcome, Run};

/// Builds the command in release and compares both builds' trajectory of a few seconds.
pub(crate) fn same_bits(run: &mut Run) -> Outcome {
    let started = Instant::now();
    let mut cargo = run.cargo();
    let built = run.checked(cargo.args(["build", "--release"]));
    if !matches!(built, Outcome::Passed) {
        return built;
    }
    println!("release build: {:.0} s", started.elapsed().as_secs_f64());
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
    let mut command = std::process::Command::new(run.target.join(profile).join("yawbench"));
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
