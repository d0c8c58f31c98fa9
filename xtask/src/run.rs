//! A run of named steps: what each came to, how long it took, what was skipped, and the summary.

use std::ffi::OsString;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use crate::stream::{self, Ended};

/// What a step came to.
pub(crate) enum Outcome {
    Passed,
    /// Could not run here, and was not required; the reason.
    Skipped(String),
    /// The reason in one line.
    Failed(String),
}

impl Outcome {
    /// This one unless it passed, else the other.
    pub(crate) fn and(self, other: Self) -> Self {
        if matches!(self, Outcome::Passed) { other } else { self }
    }

    /// Skipped, or failed where the environment has `variable=1`.
    pub(crate) fn skipped_unless_required(variable: &str, reason: String) -> Self {
        if required(variable) {
            Outcome::Failed(format!("{reason}, and {variable}=1"))
        } else {
            Outcome::Skipped(reason)
        }
    }
}

/// True where the environment has `variable=1`.
pub(crate) fn required(variable: &str) -> bool {
    std::env::var_os(variable).is_some_and(|value| value == "1")
}

fn cargo() -> OsString {
    std::env::var_os("CARGO").unwrap_or("cargo".into())
}

struct Finished {
    name: &'static str,
    outcome: Outcome,
    took: Duration,
}

/// The steps so far, and what they share.
pub(crate) struct Run {
    /// The repository's root.
    pub(crate) root: PathBuf,
    /// Cargo's target folder; what is downloaded is kept below it.
    pub(crate) target: PathBuf,
    /// Environment for the tests, from the steps that fetched something for them.
    pub(crate) equipment: Vec<(String, OsString)>,
    finished: Vec<Finished>,
    tests: stream::Tests,
    notes: Vec<String>,
    /// True where the output is a terminal that shows colours.
    pub(crate) colour: bool,
    started: Instant,
}

impl Run {
    pub(crate) fn new() -> Self {
        let xtask = Path::new(env!("CARGO_MANIFEST_DIR"));
        let root = xtask.parent().unwrap_or(xtask).to_path_buf();
        let target = std::env::var_os("CARGO_TARGET_DIR").map_or("target".into(), PathBuf::from);
        Self {
            target: root.join(target),
            root,
            equipment: Vec::new(),
            finished: Vec::new(),
            tests: stream::Tests::default(),
            notes: Vec::new(),
            colour: std::io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none(),
            started: Instant::now(),
        }
    }

    /// Runs one step and keeps what it came to.
    pub(crate) fn step(&mut self, name: &'static str, work: impl FnOnce(&mut Self) -> Outcome) {
        println!("\n{}", self.paint("1;36", &format!("== {name}")));
        let start = Instant::now();
        let outcome = work(self);
        let took = start.elapsed();
        let finished = Finished { name, outcome, took };
        println!("{}", self.line(&finished));
        self.finished.push(finished);
    }

    /// Says something now and once more in the summary.
    pub(crate) fn note(&mut self, line: impl Into<String>) {
        let line = line.into();
        println!("{}", self.paint("33", &line));
        if !self.notes.contains(&line) {
            self.notes.push(line);
        }
    }

    /// Puts a folder of programs before the tests' search path.
    pub(crate) fn search_first(&mut self, folder: PathBuf) {
        let set = self.equipment.iter().position(|(name, _)| name == "PATH");
        let rest = set.map(|at| self.equipment.remove(at).1).or_else(|| std::env::var_os("PATH"));
        let rest = rest.unwrap_or_default();
        let paths = std::iter::once(folder).chain(std::env::split_paths(&rest));
        // A folder with a colon in its name cannot be on the path: it is left out.
        let path = std::env::join_paths(paths).unwrap_or(rest.clone());
        self.equipment.push(("PATH".into(), path));
    }

    /// Cargo in the repository's root.
    pub(crate) fn cargo(&self) -> Command {
        self.in_root(Command::new(cargo()))
    }

    /// The same with the least claim to the processors.
    pub(crate) fn cargo_niced(&self) -> Command {
        let mut nice = Command::new("nice");
        nice.args(["-n", "19"]).arg(cargo());
        self.in_root(nice)
    }

    fn in_root(&self, mut cargo: Command) -> Command {
        cargo.current_dir(&self.root).stdin(Stdio::null());
        if self.colour {
            cargo.env("CARGO_TERM_COLOR", "always");
        }
        cargo
    }

    /// An empty folder for what a step writes, which an earlier one cannot have used.
    ///
    /// # Errors
    ///
    /// It could not be emptied or made.
    pub(crate) fn temporary(&self) -> std::io::Result<PathBuf> {
        let folder = self.target.join("xtask-run/tmp");
        if folder.exists() {
            std::fs::remove_dir_all(&folder)?;
        }
        std::fs::create_dir_all(&folder)?;
        Ok(folder)
    }

    /// Runs a command, shows and reads its output; anything but exit status 0 is a failure.
    pub(crate) fn checked(&mut self, command: &mut Command) -> Outcome {
        match self.watched(command, None, |_| {}) {
            Ok(Ended::Status(0)) => Outcome::Passed,
            Ok(ended) => Outcome::Failed(format!("{}: {ended}", stream::shown(command))),
            Err(error) => Outcome::Failed(format!("{}: {error}", stream::shown(command))),
        }
    }

    /// Runs a command under a time limit, shows its lines and gives each to `see`.
    pub(crate) fn watched(
        &mut self,
        command: &mut Command,
        limit: Option<Duration>,
        mut see: impl FnMut(&str),
    ) -> std::io::Result<Ended> {
        let tests = &mut self.tests;
        let notes = &mut self.notes;
        stream::lines(command, limit, |line, is_stderr| {
            if is_stderr {
                eprintln!("{line}");
            } else {
                println!("{line}");
            }
            tests.read(line);
            if line.starts_with("SKIPPED") && !notes.iter().any(|note| note == line) {
                notes.push(line.to_owned());
            }
            see(line);
        })
    }

    /// Prints the summary; exit status 1 when a step failed.
    pub(crate) fn finish(self) -> ExitCode {
        println!("\n{}", self.paint("1;36", "== summary"));
        for finished in &self.finished {
            println!("{}", self.line(finished));
        }
        let total = self.started.elapsed().as_secs_f64();
        println!("{:<10} {total:>7.1} s", "total");
        for note in &self.notes {
            println!("{}", self.paint("33", &format!("note: {note}")));
        }
        let failed = self.finished.iter().any(|f| matches!(f.outcome, Outcome::Failed(_)));
        if self.tests.any() {
            println!("{}", self.tests);
        }
        if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
    }

    fn line(&self, finished: &Finished) -> String {
        let (code, word, reason) = match &finished.outcome {
            Outcome::Passed => ("32", "ok", ""),
            Outcome::Skipped(reason) => ("1;33", "SKIPPED", reason.as_str()),
            Outcome::Failed(reason) => ("1;31", "FAILED", reason.as_str()),
        };
        let word = self.paint(code, &format!("{word:<8}"));
        let line = format!(
            "{:<10} {:>7.1} s  {word} {reason}",
            finished.name,
            finished.took.as_secs_f64()
        );
        line.trim_end().to_owned()
    }

    fn paint(&self, code: &str, text: &str) -> String {
        if self.colour { format!("\x1b[{code}m{text}\x1b[0m") } else { text.to_owned() }
    }
}
