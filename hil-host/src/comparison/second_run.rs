//! The second run of a comparison: on the memory bus, as fast as possible, in a thread of its own.

use crate::BenchError;
use crate::control::{End, Session, SessionState};
use crate::counts::Counts;
use crate::progress_bar::LateBar;
use crate::record::{InParts, NpyWriter, OpenFiles, PART_CYCLES, ROWS, Row, by_part, parts};
use crate::run::{Terms, in_memory};
use crate::statistics::Statistics;
use can_protocol::Profile;
use scenario::run::Run;
use std::fs::File;
use std::io;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

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
    let take = |row: &Row| -> Result<ControlFlow<()>, BenchError> {
        if stop.load(Ordering::Relaxed) {
            return Ok(ControlFlow::Break(()));
        }
        counts.take(row);
        rows.push(*row);
        if rows.len() == ROWS {
            write(&rows).map_err(failed)?;
            rows.clear();
            bar.at(counts.run_cycles);
        }
        Ok(ControlFlow::Continue(()))
    };
    let begin = |state: &mut SessionState| state.line.delay_run(ramp_in);
    let close =
        |session: &Session<'_>, state: &SessionState, end| (session.watched, state.hash, end);
    let found = in_memory(run, Terms::in_memory(profile), begin, cycles, take, close)?;
    let Some((watched, hash, end)) = found else {
        for part in parts(&path) {
            std::fs::remove_file(part).map_err(failed)?;
        }
        return Ok(None);
    };
    write(&rows).map_err(failed)?;
    record.into_last().finish().and_then(|_| open.hold()).map_err(failed)?;
    bar.finish();
    let statistics = Statistics::of(&path, run.run_in_s, run.cycle_s(), |_| {})?;
    Ok(Some(SecondRun { counts, statistics, watched, hash, end }))
}
