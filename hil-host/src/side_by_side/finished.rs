//! A run that is over, from its folder: what it was asked for, and its figures.

use super::condition::Condition;
use crate::BenchError;
use crate::comparison::{Figure, figures};
use crate::control::End;
use crate::counts::Counts;
use crate::run::{RECORD, SCENARIO, VEHICLE, kept_summary, read_about};
use crate::statistics::Statistics;
use crate::summary::{accelerations, dampers};
use files::{Limit, ResultFolder, input};
use scenario::run::{Overrides, Run};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// The bus of emulated rigs.
const MEMORY: &str = "memory";

/// A run that was completed, without its record.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FinishedRun {
    /// Its folder, as it was named.
    pub(super) path: PathBuf,
    /// The same folder, whatever it is called.
    pub(super) place: PathBuf,
    pub(super) title: String,
    /// Name and version of the program that ran it.
    pub(super) program: String,
    /// When it began, since 1970 (s).
    pub(super) started_unix_s: f64,
    pub(super) trajectory_hash: String,
    pub(super) condition: Condition,
    /// Its rigs are emulated.
    pub(super) on_memory: bool,
    /// One measured force acted on several bogies.
    pub(super) has_other_bogie: bool,
    /// Why it is not held; empty where it is.
    pub(super) not_held: Vec<String>,
    /// Bodies whose accelerations are recorded.
    watched: [Option<usize>; 3],
    cycles: u64,
}

impl FinishedRun {
    /// Reads everything but the record.
    ///
    /// # Errors
    /// The folder holds no run, or one that was not completed with its rigs and its whole record.
    pub(super) fn read(path: &Path) -> Result<Self, BenchError> {
        let folder = ResultFolder::existing(path, "run")?;
        let about = read_about(&folder)?;
        let refused = |found: String, expected: &str| BenchError::Incomparable {
            run: path.to_owned(),
            found,
            expected: expected.to_owned(),
        };
        let Some(kept) = kept_summary(&folder)? else {
            let found = "no end recorded: the program was killed, or the power failed".to_owned();
            return Err(refused(found, "a run that was completed"));
        };
        if kept.state != End::Completed {
            let found = format!("a run that ended {}", kept.state.name());
            return Err(refused(found, "a run that was completed"));
        }
        if let Some(lost) = kept.drop_outs.first() {
            let found = format!("a run that went on without the rig of {}", lost.place);
            return Err(refused(found, "a run with its rigs to the end"));
        }
        if kept.record_dropped > 0 {
            let found = format!("a record without {} rows or frames", kept.record_dropped);
            return Err(refused(found, "a whole record"));
        }
        let [scenario, vehicle] = [SCENARIO, VEHICLE].map(|name| table(&folder.file(name)));
        let (scenario, vehicle) = (scenario?, vehicle?);
        let slots = scenario.get("slot").and_then(Value::as_array);
        let mut buses = slots.into_iter().flatten().filter_map(|slot| slot.get("bus")?.as_str());
        let on_memory = about.bus == MEMORY && buses.all(|bus| bus == MEMORY);
        let mut more = vec![("bus", about.bus.clone())];
        if !on_memory {
            more.push(("pace", about.pace.name().to_owned()));
            more.push(("slow_down", about.slow_down.to_string()));
        }
        let is_other_bogie =
            |slot: &Value| slot.get("on").and_then(Value::as_str) == Some("other_bogie");
        Ok(Self {
            path: path.to_owned(),
            place: path.canonicalize().unwrap_or_else(|_| path.to_owned()),
            title: about.title,
            program: about.program,
            started_unix_s: about.started_unix_s,
            trajectory_hash: kept.trajectory_hash,
            condition: Condition::of(&scenario, &vehicle, on_memory, &more),
            on_memory,
            has_other_bogie: slots.is_some_and(|slots| slots.iter().any(is_other_bogie)),
            not_held: kept.not_held,
            watched: about.watched,
            cycles: kept.cycles,
        })
    }

    /// Its figures, from its record.
    ///
    /// # Errors
    /// The record cannot be read, or is not that of the run, as a whole.
    pub(super) fn figures(&self) -> Result<Vec<Figure>, BenchError> {
        let folder = ResultFolder::existing(&self.path, "run")?;
        let run = Run::load(&folder.file(SCENARIO), Overrides::default())?;
        let mut counts = Counts::default();
        let record = folder.file(RECORD);
        let statistics =
            Statistics::of(&record, run.run_in_s, run.cycle_s(), |row| counts.take(row))?;
        let (last_cycle, hash) = counts.last;
        let is_whole = counts.rows() == self.cycles && last_cycle == self.cycles;
        if !is_whole || format!("{hash:016x}") != self.trajectory_hash {
            return Err(BenchError::Incomparable {
                run: self.path.clone(),
                found: format!("a record of {} cycles, or another one", counts.rows()),
                expected: format!("the {} cycles that summary.json counts", self.cycles),
            });
        }
        let sums = statistics.after_run_in();
        let dampers = dampers(&run, &counts, sums, None);
        Ok(figures(&run, &dampers, &accelerations(self.watched, sums), sums))
    }
}

/// A TOML file of a run.
fn table(file: &Path) -> Result<Table, BenchError> {
    let text = input::read_text(file, Limit::Text)?;
    text.parse().map_err(|why: toml::de::Error| BenchError::Kept {
        file: file.to_owned(),
        found: files::quote::message(why.message()),
        expected: "the TOML file of a run",
    })
}
