//! The loop with the threads around it: record, bus log, progress.

use super::progress;
use crate::BenchError;
use crate::bus::Bus;
use crate::columns::Columns;
use crate::control::{Buses, End, Pace, Session, SessionState};
use crate::realtime::{self, RealtimeOptions};
use crate::record::{Batch, BusEvent, BusLog, NpyWriter, Queues};
use crossbeam_channel::{Receiver, bounded};
use std::fs::File;
use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::ScopedJoinHandle;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Batches that may wait for a thread that writes.
const WAITING: usize = 64;

/// The loop with everything that it changes.
pub(super) struct Task<'a, 's, B> {
    pub(super) session: &'a Session<'s>,
    pub(super) state: &'a mut SessionState,
    pub(super) buses: &'a mut [B],
    pub(super) pace: &'a mut Pace,
    pub(super) cycles: u64,
}

/// What the loop writes while it runs: opened files and their names for messages.
#[derive(Debug)]
pub(super) struct Output {
    pub(super) record: (PathBuf, File),
    pub(super) log: (PathBuf, File),
    /// Names of the buses in the log.
    pub(super) bus_names: Vec<String>,
}

/// What is known when the loop has ended.
#[derive(Debug)]
pub(super) struct Recording {
    pub(super) end: End,
    pub(super) columns: Columns,
    /// Rows and frames that the recorder had no room for.
    pub(super) dropped: u64,
    pub(super) wall_s: f64,
}

/// Runs the loop on this thread and records it.
pub(super) fn record<B: Bus>(
    task: Task<'_, '_, B>,
    realtime_options: &RealtimeOptions,
    output: Output,
    stop: &AtomicBool,
) -> Result<Recording, BenchError> {
    let Task { session, state, buses, pace, cycles } = task;
    let now_ns = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_nanos() as u64);
    let Output { record: (record_path, record), log: (log_path, log), bus_names } = output;
    let log = BusLog::begin(log, now_ns, bus_names);
    let mut queues = Queues::default();
    let (mut recorder, drain) = queues.split();
    let done = AtomicBool::new(false);
    let begin = Instant::now();
    let speed_kmh = session.line.speed_m_per_s * 3.6;
    std::thread::scope(|scope| {
        let (to_file, file_rows) = bounded::<Batch>(WAITING);
        let (to_progress, progress_rows) = bounded::<Batch>(WAITING);
        let (to_log, log_events) = bounded::<Vec<BusEvent>>(WAITING);
        let rows = [to_file, to_progress];
        let done = &done;
        scope.spawn(move || drain.run(done, &rows, &to_log));
        let record = scope.spawn(move || or_stop(write_rows(record, &file_rows), stop));
        let log = scope.spawn(move || or_stop(write_events(log, &log_events), stop));
        let columns = scope.spawn(move || progress::collect(&progress_rows, cycles, speed_kmh));

        // After the other threads have started: they must not inherit the loop's processor.
        if let Pace::Realtime(_) = pace {
            for line in realtime::set_up(realtime_options).lines() {
                eprintln!("real-time: {line}");
            }
        }
        let end = session.run(state, &mut Buses::new(buses, &mut recorder), pace, cycles, stop);
        let wall_s = begin.elapsed().as_secs_f64();
        let dropped = recorder.dropped_rows + recorder.dropped_events;
        done.store(true, Ordering::Release);
        let written = [(record, record_path), (log, log_path)];
        for (thread, file) in written {
            joined(thread)?.map_err(|why| BenchError::File { file, why })?;
        }
        Ok(Recording { end, columns: joined(columns)?, dropped, wall_s })
    })
}

/// A file that cannot be written ends the run: a bench is not driven without its record.
fn or_stop(written: io::Result<()>, stop: &AtomicBool) -> io::Result<()> {
    if written.is_err() {
        stop.store(true, Ordering::Relaxed);
    }
    written
}

fn write_rows(file: File, rows: &Receiver<Batch>) -> io::Result<()> {
    let mut record = NpyWriter::begin(file)?;
    for batch in rows {
        record.write(&batch)?;
    }
    record.finish().map(|_| ())
}

fn write_events(mut log: BusLog, events: &Receiver<Vec<BusEvent>>) -> io::Result<()> {
    for events in events {
        log.write(&events)?;
    }
    log.finish()
}

fn joined<T>(thread: ScopedJoinHandle<'_, T>) -> Result<T, BenchError> {
    thread.join().map_err(|_| BenchError::Thread { name: "records the run" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::{BusChoice, MemoryBus};
    use crate::record::measured::read_record;
    use crate::rig::RigNode;
    use crate::run::{Plan, Terms, session};
    use can_protocol::Profile;
    use scenario::run::{Overrides, Run};
    use std::path::Path;
    use std::time::Duration;

    #[test]
    fn a_full_disk_ends_the_run_and_what_was_recorded_can_be_read() {
        let Ok(full) = File::options().write(true).open("/dev/full") else { return };
        let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
        let overrides = Overrides { duration_s: Some(600.0), speed_kmh: None };
        let run = Run::load(&scenario, overrides).unwrap();
        let plan = Plan::new(&run, &BusChoice::Memory).unwrap();
        let track = run.track.view();
        let terms = Terms::in_memory(Profile::Classical);
        let session = session(&run, &track, &plan.rigs, terms).unwrap();
        let rigs = plan.rigs.iter().map(|rig| RigNode::new(&run.rig, rig.node, session.profile));
        let mut buses = vec![MemoryBus::new(rigs)];
        let mut state = session.start(session.line.start(run.start.state.clone()));
        let stop = AtomicBool::new(false);
        session.greet(&state, &mut buses, Duration::from_secs(10), &stop).unwrap();
        let name = format!("hil-host-full-disk-{}.npy", std::process::id());
        let path = std::env::temp_dir().join(name);
        let output = Output {
            record: (path.clone(), File::create(&path).unwrap()),
            log: (PathBuf::from("bus.log"), full),
            bus_names: vec!["memory".to_owned()],
        };
        let task = Task {
            session: &session,
            state: &mut state,
            buses: &mut buses,
            pace: &mut Pace::Fast,
            cycles: run.cycles(),
        };
        let error = record(task, &RealtimeOptions::NONE, output, &stop).unwrap_err();
        assert!(!error.is_bad_input() && !error.is_safe_state(), "{error:?}");
        let text = error.to_string();
        assert!(text.starts_with("bus.log: No space left"), "{text}");
        // It stopped long before its 600 s.
        let rows = read_record(&path, 1).unwrap().lines.len();
        assert!(rows > 1000 && rows < 500_000, "{rows} rows");
        assert_eq!(rows as u64, state.line.cycle);
        std::fs::remove_file(path).unwrap();
    }
}
