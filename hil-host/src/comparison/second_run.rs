//! The second run of a comparison: on the memory bus, as fast as possible, in a thread of its own.

use crate::BenchError;
use crate::bus::{BusChoice, MemoryBus};
use crate::clock::Tick;
use crate::control::{Buses, Course, End, Ending, Requests};
use crate::counts::Counts;
use crate::progress_bar::LateBar;
use crate::record::{
    InParts, NpyWriter, OpenFiles, PART_CYCLES, Queues, ROWS, Row, by_part, parts,
};
use crate::rig::RigNode;
use crate::run::{Plan, Terms, session};
use crate::statistics::Statistics;
use can_protocol::Profile;
use scenario::run::Run;
use std::fs::File;
use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The second run, done.
#[derive(Debug, Clone)]
pub(crate) struct SecondRun {
    /// Counts of its rows.
    pub(crate) counts: Counts,
    /// Its figures.
    pub(crate) statistics: Statistics,
    /// Bodies whose accelerations were recorded: carbody, front bogie, first wheelset.
    pub(crate) watched: [Option<usize>; 3],
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

/// How long the rigs in memory may take to answer.
const PATIENCE: Duration = Duration::from_secs(2);

impl SecondRun {
    /// Runs through a scenario with as many cycles before and in RUN as the main run had, and
    /// writes its record; none, and no record, where it was stopped. `record` is the path of its
    /// first part, and what makes a part.
    ///
    /// # Errors
    /// The record cannot be written.
    pub(crate) fn through(
        run: &Run,
        profile: Profile,
        cycles: Cycles,
        record: (PathBuf, impl Fn(u64) -> io::Result<File> + Send + Sync),
        stop: &AtomicBool,
    ) -> Result<Option<Self>, BenchError> {
        // The thread of a control loop has precedence over the rest of the machine; one that it
        // starts is an ordinary one again.
        std::thread::scope(|scope| {
            let thread = scope.spawn(move || through(run, profile, cycles, record, stop));
            let name = "runs the comparison";
            thread.join().map_err(|_| BenchError::Thread { name })?
        })
    }
}

fn through(
    run: &Run,
    profile: Profile,
    Cycles { ramp_in, run: cycles }: Cycles,
    (path, make): (PathBuf, impl Fn(u64) -> io::Result<File> + Send + Sync),
    stop: &AtomicBool,
) -> Result<Option<SecondRun>, BenchError> {
    let failed = |why| BenchError::File { file: path.clone(), why };
    let plan = Plan::new(run, &BusChoice::Memory)?;
    let track = run.track.view();
    let mut course = Course::new(run, &track);
    let session = session(run, &track, &plan.rigs, Terms::in_memory(profile))?;
    let rigs = plan.rigs.iter().map(|rig| RigNode::new(&run.rig, rig.node, profile));
    let mut buses = vec![MemoryBus::new(rigs)];
    let mut state = session.start(session.line.start(run.start.state.clone()));
    session
        .greet(&mut state, &mut buses, PATIENCE, &Requests::armed())
        .map_err(|why| why.on(&BusChoice::Memory))?;
    state.line.delay_run(ramp_in);
    let mut queues = Queues::default();
    // The frames of this bus are not kept.
    let (mut recorder, _frames) = queues.split();
    let mut buses = Buses::new(&mut buses, &mut recorder);
    let open = OpenFiles::default();
    let record = InParts::new(|part| {
        let writer = NpyWriter::begin(make(part)?)?;
        open.add(writer.file());
        Ok(writer)
    });
    let mut record = record.map_err(failed)?;
    let mut write = |rows: &[Row]| -> io::Result<()> {
        for (part, rows) in by_part(rows, PART_CYCLES, |row| row.cycle) {
            record.part(part)?.write(rows)?;
        }
        Ok(())
    };
    let mut counts = Counts::default();
    let mut rows: Vec<Row> = Vec::with_capacity(ROWS);
    let mut bar = LateBar::new("the same with the other damper", cycles);
    let mut ending = Ending::default();
    let end = 'run: loop {
        let track = course.track();
        while !course.is_passed(&state.line) {
            if stop.load(Ordering::Relaxed) {
                for part in parts(&path) {
                    std::fs::remove_file(part).map_err(failed)?;
                }
                return Ok(None);
            }
            let row = session.cycle_on(&track, &mut state, &mut buses, Tick::default());
            counts.take(&row);
            rows.push(row);
            if rows.len() == ROWS {
                write(&rows).map_err(failed)?;
                rows.clear();
                bar.at(counts.run_cycles);
            }
            if let Some(end) = ending.take(&session, &mut state, cycles, false) {
                break 'run end;
            }
        }
        course.change()?;
    };
    write(&rows).map_err(failed)?;
    record.into_last().finish().and_then(|_| open.hold()).map_err(failed)?;
    bar.finish();
    let statistics = Statistics::of(&path, run.run_in_s, |_| {})?;
    Ok(Some(SecondRun { counts, statistics, watched: session.watched, hash: state.hash, end }))
}
