//! Fuzzing guided by coverage: `cargo xtask fuzz [TARGET] [--seconds N]`.
//!
//! Cargo-fuzz needs a nightly compiler, since coverage is measured by a sanitizer. Both are fetched
//! where they are missing. New inputs go to a folder below the target folder; at the end the corpus
//! of the repository is replaced by the smallest set of inputs that reaches the same code, so that
//! it stays small.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::debian;
use crate::run::{Outcome, Run};
use crate::stream::quiet;

/// Largest input, bytes: the vehicle of the repository fits.
const LONGEST: u32 = 12_288;

/// Fuzzes one target, or all of them one after the other, each for so many seconds.
pub(crate) fn fuzz(run: &mut Run, arguments: &[&str]) -> Outcome {
    let (target, seconds) = match arguments {
        [] => (None, "60"),
        ["--seconds", seconds] => (None, *seconds),
        [target] => (Some(*target), "60"),
        [target, "--seconds", seconds] => (Some(*target), *seconds),
        _ => return Outcome::Failed("usage: cargo xtask fuzz [TARGET] [--seconds N]".into()),
    };
    let targets = targets(run);
    if let Some(unknown) = target.filter(|name| !targets.iter().any(|target| target == name)) {
        return Outcome::Failed(format!("no target {unknown}; there are {}", targets.join(", ")));
    }
    let program = match cargo_fuzz(run) {
        Ok(program) => program,
        Err(reason) => return Outcome::skipped_unless_required("REQUIRE_FUZZ", reason),
    };
    let mut all = Outcome::Passed;
    for name in targets.iter().filter(|name| target.is_none_or(|target| target == name.as_str())) {
        all = all.and(fuzz_one(run, &program, name, seconds));
    }
    all
}

/// The targets: each has a program of its own.
fn targets(run: &Run) -> Vec<String> {
    let programs = crate::rust_files(&run.root.join("fuzz/libfuzzer"));
    let names = programs.iter().filter_map(|path| path.file_stem());
    let mut names: Vec<_> = names.map(|name| name.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Cargo-fuzz, and the compiler that it needs.
fn cargo_fuzz(run: &Run) -> Result<PathBuf, String> {
    let nightly = || quiet(Command::new("rustup").args(["run", "nightly", "rustc", "--version"]));
    if nightly().is_err() {
        quiet(Command::new("rustup").args(["toolchain", "install", "nightly"]))?;
        nightly()?;
    }
    let folder = run.target.join("cargo-fuzz");
    let ours = folder.join("bin/cargo-fuzz");
    if let Some(program) = debian::program("cargo-fuzz") {
        return Ok(program);
    }
    if !ours.is_file() {
        let mut cargo = run.cargo();
        cargo.args(["install", "cargo-fuzz", "--locked", "--quiet", "--root"]).arg(&folder);
        quiet(&mut cargo)?;
    }
    Ok(ours)
}

fn fuzz_one(run: &mut Run, program: &Path, name: &str, seconds: &str) -> Outcome {
    let kept = run.root.join("fuzz/corpus").join(name);
    let grown = run.target.join("fuzz").join(name);
    if let Err(why) = fs::create_dir_all(&grown).and_then(|()| fs::create_dir_all(&kept)) {
        return Outcome::Failed(format!("{}: {why}", grown.display()));
    }
    let limits = [format!("-max_total_time={seconds}"), format!("-max_len={LONGEST}")];
    let fuzzed = {
        let mut command = cargo_fuzz_command(run, program, "run", name);
        command.arg(&grown).arg(&kept).arg("--").args(&limits);
        // A loader that takes ten seconds for so few bytes hangs.
        command.args(["-timeout=10", "-rss_limit_mb=4096", "-print_final_stats=1"]);
        run.checked(&mut command)
    };
    if !matches!(fuzzed, Outcome::Passed) {
        return fuzzed;
    }
    smallest(run, program, name, &grown, &kept)
}

/// Replaces the corpus by the fewest inputs that reach the same code.
fn smallest(run: &mut Run, program: &Path, name: &str, grown: &Path, kept: &Path) -> Outcome {
    let merged = run.target.join("fuzz").join(format!("{name}-merged"));
    let _ = fs::remove_dir_all(&merged);
    if let Err(why) = fs::create_dir_all(&merged) {
        return Outcome::Failed(format!("{}: {why}", merged.display()));
    }
    let mut command = cargo_fuzz_command(run, program, "run", name);
    command.arg(&merged).arg(kept).arg(grown).args(["--", "-set_cover_merge=1"]);
    let done = run.checked(&mut command);
    if !matches!(done, Outcome::Passed) {
        return done;
    }
    match replaced(&merged, kept) {
        Ok(count) => {
            run.note(format!("{name}: {count} inputs in its corpus"));
            Outcome::Passed
        }
        Err(why) => Outcome::Failed(format!("{}: {why}", kept.display())),
    }
}

/// Moves the new corpus to its place; what once broke a target keeps its name and stays.
fn replaced(merged: &Path, kept: &Path) -> std::io::Result<usize> {
    for entry in fs::read_dir(kept)? {
        let entry = entry?;
        if !entry.file_name().to_string_lossy().starts_with("broke-") {
            fs::remove_file(entry.path())?;
        }
    }
    let mut count = 0;
    for entry in fs::read_dir(merged)? {
        let entry = entry?;
        fs::copy(entry.path(), kept.join(entry.file_name()))?;
        count += 1;
    }
    Ok(count)
}

fn cargo_fuzz_command(run: &Run, program: &Path, verb: &str, name: &str) -> Command {
    let mut command = Command::new(program);
    command.current_dir(&run.root).env("RUSTUP_TOOLCHAIN", "nightly");
    command.args(["fuzz", verb, "--fuzz-dir", "fuzz/libfuzzer", "--target-dir"]);
    command.arg(run.target.join("fuzz/build")).arg(name);
    command
}
