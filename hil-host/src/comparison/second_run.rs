//! The second run of a comparison: on the memory bus, as fast as possible, in a thread of its own.

use crate::BenchError;
use crate::bus::{BusChoice, MemoryBus};
use crate::clock::Tick;
use crate::columns::{Columns, ROWS_MAX};
use crate::control::{Buses, NoAnswer};
use crate::record::{NpyWriter, Queues, ROWS, Row};
use crate::rig::RigNode;
use crate::run::{Plan, Terms, bar, session};
use can_protocol::Profile;
use indicatif::ProgressDrawTarget;
use scenario::run::Run;
use std::fs::File;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// The second run, done.
#[derive(Debug, Clone)]
pub(crate) struct SecondRun {
    /// What statistics and plots need.
    pub(crate) columns: Columns,
    /// Bodies whose accelerations were recorded: carbody, front bogie, first wheelset.
    pub(crate) watched: [Option<usize>; 3],
    /// Cycles done.
    pub(crate) cycles: u64,
    /// The trajectory hash.
    pub(crate) hash: u64,
    /// Whether the model left its track.
    pub(crate) safe: bool,
}

/// A run that takes longer shows its progress.
const SILENT: Duration = Duration::from_secs(2);

impl SecondRun {
    /// Runs through a scenario, at most as far as statistics reach, and writes its record; none,
    /// and no record, where it was stopped.
    ///
    /// # Errors
    /// The record cannot be written.
    pub(crate) fn through(
        run: &Run,
        profile: Profile,
        cycles: u64,
        record: (PathBuf, File),
        stop: &AtomicBool,
    ) -> Result<Option<Self>, BenchError> {
        // The thread of a control loop has precedence over the rest of the machine; one that it
        // starts is an ordinary one again.
        std::thread::scope(|scope| {
            let thread = scope.spawn(|| through(run, profile, cycles, record, stop));
            let name = "runs the comparison";
            thread.join().map_err(|_| BenchError::Thread { name })?
        })
    }
}

fn through(
    run: &Run,
    profile: Profile,
    cycles: u64,
    (path, file): (PathBuf, File),
    stop: &AtomicBool,
) -> Result<Option<SecondRun>, BenchError> {
    let failed = |why| BenchError::File { file: path.clone(), why };
    let cycles = cycles.min(ROWS_MAX as u64);
    let plan = Plan::new(run, &BusChoice::Memory)?;
    let track = run.track.view();
    let session = session(run, &track, &plan.rigs, Terms::in_memory(profile))?;
    let rigs = plan.rigs.iter().map(|rig| RigNode::new(&run.rig, rig.node, profile));
    let mut buses = vec![MemoryBus::new(rigs)];
    let mut state = session.start(session.line.start(run.start.state.clone()));
    session.greet(&state, &mut buses, SILENT, &AtomicBool::new(false)).map_err(|why| {
        let NoAnswer::Silent(nodes) = why else { return BenchError::Interrupted };
        BenchError::SilentRigs { nodes, bus: BusChoice::Memory.to_string() }
    })?;
    let mut queues = Queues::default();
    // The frames of this bus are not kept.
    let (mut recorder, _frames) = queues.split();
    let mut buses = Buses::new(&mut buses, &mut recorder);
    let mut record = NpyWriter::begin(file).map_err(failed)?;
    let mut columns = Columns::default();
    let mut rows: Vec<Row> = Vec::with_capacity(ROWS);
    let bar = bar(cycles, ProgressDrawTarget::hidden());
    bar.set_message("the same with the other damper");
    let begin = Instant::now();
    while state.line.cycle < cycles && !state.line.safe {
        if stop.load(Ordering::Relaxed) {
            drop(record);
            std::fs::remove_file(&path).map_err(failed)?;
            return Ok(None);
        }
        let row = session.cycle(&mut state, &mut buses, Tick::default());
        columns.push(&row);
        rows.push(row);
        if rows.len() == ROWS {
            record.write(&rows).map_err(failed)?;
            rows.clear();
            if bar.is_hidden() && begin.elapsed() > SILENT {
                bar.set_draw_target(ProgressDrawTarget::stderr_with_hz(10));
            }
            bar.set_position(state.line.cycle);
        }
    }
    record.write(&rows).map_err(failed)?;
    record.finish().map_err(failed)?;
    bar.finish_and_clear();
    Ok(Some(SecondRun {
        columns,
        watched: session.watched,
        cycles: state.line.cycle,
        hash: state.hash,
        safe: state.line.safe,
    }))
}
