//! The second run of a comparison: on the memory bus, as fast as possible, in a thread of its own.

use crate::BenchError;
use crate::bus::{BusChoice, MemoryBus};
use crate::clock::Tick;
use crate::columns::{Columns, ROWS_MAX};
use crate::control::{Buses, End, Ending, Requests};
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
    /// Cycles of RUN.
    pub(crate) run_cycles: u64,
    /// The trajectory hash.
    pub(crate) hash: u64,
    /// How it ended: in the safe state where the model left its track.
    pub(crate) end: End,
}

/// How long the main run was.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cycles {
    /// Cycles before RUN.
    pub(crate) ramp_in: u32,
    /// Cycles of RUN.
    pub(crate) run: u64,
}

/// A run that takes longer shows its progress.
const SILENT: Duration = Duration::from_secs(2);

impl SecondRun {
    /// Runs through a scenario with as many cycles before and in RUN as the main run had, at most
    /// as far as statistics reach, and writes its record; none, and no record, where it was
    /// stopped.
    ///
    /// # Errors
    /// The record cannot be written.
    pub(crate) fn through(
        run: &Run,
        profile: Profile,
        cycles: Cycles,
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
    Cycles { ramp_in, run: cycles }: Cycles,
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
    session
        .greet(&mut state, &mut buses, SILENT, &Requests::armed())
        .map_err(|why| why.on(&BusChoice::Memory))?;
    state.line.delay_run(ramp_in);
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
    let mut ending = Ending::default();
    let end = loop {
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
            bar.set_position(columns.run_cycles);
        }
        if let Some(end) = ending.take(&session, &mut state, cycles, false) {
            break end;
        }
    };
    record.write(&rows).map_err(failed)?;
    record.finish().map_err(failed)?;
    bar.finish_and_clear();
    Ok(Some(SecondRun {
        watched: session.watched,
        run_cycles: columns.run_cycles,
        columns,
        hash: state.hash,
        end,
    }))
}
