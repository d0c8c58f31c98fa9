//! The loop with the threads around it: record, bus log, disk, progress.

use super::handshake::{Epoch, Heard};
use super::progress::{self, Progress};
use crate::BenchError;
use crate::bus::{Bus, BusChoice};
use crate::columns::Columns;
use crate::control::{Buses, End, Pace, Requests, Session, SessionState};
use crate::realtime::{self, RealtimeOptions};
use crate::record::{
    BusEvent, BusLog, Drain, Event, EventLog, Loss, NpyWriter, Outlet, Queues, Row, Storage,
};
use crossbeam_channel::{Receiver, RecvTimeoutError, bounded};
use std::fmt;
use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::ScopedJoinHandle;
use std::time::{Duration, Instant};

/// The loop with everything that it changes.
pub(super) struct Task<'a, 's, B> {
    pub(super) session: &'a Session<'s>,
    pub(super) state: &'a mut SessionState,
    pub(super) buses: &'a mut [B],
    /// The bus as it was given.
    pub(super) bus: &'a BusChoice,
    pub(super) pace: &'a mut Pace,
    pub(super) cycles: u64,
}

/// What the loop writes while it runs: opened files and their names for messages.
#[derive(Debug)]
pub(super) struct Output<S> {
    pub(super) record: (PathBuf, S),
    pub(super) log: (PathBuf, S),
    pub(super) events: (PathBuf, S),
    /// Names of the buses in the log.
    pub(super) bus_names: Vec<String>,
    /// Time zero of the log.
    pub(super) epoch: Epoch,
    /// What passed the buses before the rigs were armed.
    pub(super) handshake: Vec<BusEvent>,
}

/// What is known when the loop has ended.
#[derive(Debug)]
pub(super) struct Recording {
    pub(super) end: End,
    pub(super) columns: Columns,
    /// Rows and frames that the recorder had no room for, or the disk.
    pub(super) dropped: u64,
    pub(super) wall_s: f64,
    /// Why the record could not be kept and the run was ended.
    pub(super) failure: Option<BenchError>,
}

/// Time between two synchronisations of the disk: with the write of a batch, a power cut loses at
/// most two seconds.
const SYNC: Duration = Duration::from_secs(1);

/// Arms the rigs, runs the loop on this thread and records it.
///
/// # Errors
/// A rig that cannot be armed, with nothing recorded; a file that cannot be written.
pub(super) fn record<B: Bus, S: Storage + fmt::Debug>(
    task: Task<'_, '_, B>,
    realtime_options: &RealtimeOptions,
    output: &Output<S>,
    requests: &Requests,
) -> Result<Recording, BenchError> {
    let Task { session, state, buses, bus, pace, cycles } = task;
    let cycle_ns = session.line.cycle_s * 1e9 * f64::from(session.slow_down.get());
    let cycle_ns = (cycle_ns as u64).max(1);
    let (files, epoch) = ([&output.record, &output.log], output.epoch);
    let [record, log] = files.map(|(_, storage)| storage);
    let failed = |(path, _): &(PathBuf, S), why| BenchError::File { file: path.clone(), why };
    let begun = NpyWriter::begin(record).map_err(|why| failed(&output.record, why))?;
    let mut lines = BusLog::begin(log, epoch.unix_ns, output.bus_names.clone());
    lines.write(&output.handshake).map_err(|why| failed(&output.log, why))?;
    let mut happened = EventLog::begin(&output.events.1);
    happened
        .write(&of_run(0, state.line.time_s(session.line.cycle_s), "run begun"))
        .map_err(|why| failed(&output.events, why))?;
    let mut queues = Queues::for_rigs(session.ports.len());
    let (mut recorder, drain) = queues.split();
    recorder.rows_lost_at_most = 1_000_000_000 / cycle_ns;
    let done = AtomicBool::new(false);
    let (progress, shown) = Progress::new(session.line.speed_m_per_s * 3.6);
    let (running, ended) = bounded::<()>(0);
    std::thread::scope(|scope| {
        let (done, Drain { rows, events }) = (&done, drain);
        let record = scope.spawn(move || {
            let to = RowOutput { record: begun, events: happened, progress, cycle_ns };
            write_rows(to, &rows, done, requests)
        });
        let log = scope.spawn(move || write_events(lines, &events, done, requests));
        let storages = files.map(|(_, storage)| storage);
        let sync = scope.spawn(move || synchronise(storages, &ended, requests));
        scope.spawn(move || progress::show(&shown, cycles));

        // After the other threads have started: they must not inherit the loop's processor.
        if let Pace::Realtime(_) = pace {
            for line in realtime::set_up(realtime_options).lines() {
                eprintln!("real-time: {line}");
            }
        }
        let mut heard = Heard::all(buses, epoch);
        // From the first command on a rig waits for no file and no thread.
        let armed = session.arm(state, &mut heard, requests);
        for event in Heard::events(heard) {
            recorder.event(event);
        }
        if let Err(why) = armed {
            done.store(true, Ordering::Release);
            drop(running);
            return Err(why.on(bus));
        }
        let begin = Instant::now();
        let mut buses = Buses::new(buses, &mut recorder).counted_from(epoch.begin);
        let end = session.run(state, &mut buses, pace, cycles, requests);
        let wall_s = begin.elapsed().as_secs_f64();
        done.store(true, Ordering::Release);
        drop(running);
        let (record, columns, mut happened) = joined(record)?;
        let (cycle, time_s) = (state.line.cycle, state.line.time_s(session.line.cycle_s));
        // A disk that does not take it is named below or has taken all rows.
        let _ = happened.write(&of_run(cycle, time_s, ended_as(end)));
        let (log, [record_sync, log_sync]) = (joined(log)?, joined(sync)?);
        let dropped = recorder.dropped_rows + recorder.dropped_events + record.count + log.count;
        let mut slow = Loss::default();
        if recorder.is_overrun() {
            finish(&mut slow, Err(io::Error::other("the disk is too slow")));
        }
        let [of_record, of_log] = files;
        let losses = [
            (of_record, record),
            (of_record, slow),
            (of_record, record_sync),
            (of_log, log),
            (of_log, log_sync),
        ];
        let mut failure = None;
        for ((path, _), loss) in losses {
            let Some(why) = loss.why.filter(|_| loss.too_long && failure.is_none()) else {
                continue;
            };
            failure = Some(BenchError::Unrecorded { file: path.clone(), why, dropped });
        }
        Ok(Recording { end, columns, dropped, wall_s, failure })
    })
}

/// Where the rows go.
struct RowOutput<S> {
    record: NpyWriter<S>,
    events: EventLog<S>,
    progress: Progress,
    /// Wall time of a cycle.
    cycle_ns: u64,
}

/// An event of the whole run.
const fn of_run(cycle: u64, time_s: f64, what: &'static str) -> Event {
    Event { time_s, cycle, what, slot: None, value: None, limit: None }
}

/// How a run ended, as an event.
const fn ended_as(end: End) -> &'static str {
    match end {
        End::Completed => "run ended: completed",
        End::Stopped => "run ended: stopped",
        End::RampedOut => "run ended: ramped out",
        End::Safe => "run ended: safe",
    }
}

/// Writes the rows, and counts what progress and summary need.
fn write_rows<S: Storage>(
    to: RowOutput<S>,
    rows: &Outlet<'_, Row>,
    done: &AtomicBool,
    requests: &Requests,
) -> (Loss, Columns, EventLog<S>) {
    let RowOutput { mut record, mut events, mut progress, cycle_ns } = to;
    let (mut loss, mut columns) = (Loss::default(), Columns::default());
    rows.run(done, |rows| {
        let Some(last) = rows.last() else { return };
        if loss.take(record.write(rows), rows.len() as u64, last.cycle * cycle_ns) {
            requests.end();
        }
        for row in rows {
            columns.count(row);
            // An event that finds no room is also in the rows.
            let _ = events.take(row);
        }
        progress.take(last, &columns);
    });
    finish(&mut loss, record.finish().map(|_| ()));
    (loss, columns, events)
}

fn write_events<S: Storage>(
    mut log: BusLog<S>,
    events: &Outlet<'_, BusEvent>,
    done: &AtomicBool,
    requests: &Requests,
) -> Loss {
    let mut loss = Loss::default();
    events.run(done, |events| {
        let Some(last) = events.last() else { return };
        if loss.take(log.write(events), events.len() as u64, last.time_ns) {
            requests.end();
        }
    });
    finish(&mut loss, log.finish());
    loss
}

/// What is not on the disk at the end is lost, however short.
fn finish(loss: &mut Loss, finished: io::Result<()>) {
    if let (Err(why), false) = (finished, loss.too_long) {
        loss.why = Some(why);
        loss.too_long = true;
    }
}

/// Has the disk synchronised from time to time, until the run has ended. The writing threads do not
/// wait for it.
fn synchronise<S: Storage>(files: [&S; 2], ended: &Receiver<()>, requests: &Requests) -> [Loss; 2] {
    let (begin, mut losses) = (Instant::now(), [Loss::default(), Loss::default()]);
    while ended.recv_timeout(SYNC) == Err(RecvTimeoutError::Timeout) {
        for (file, loss) in files.iter().zip(&mut losses) {
            if loss.take(file.sync(), 0, begin.elapsed().as_nanos() as u64) {
                requests.end();
            }
        }
    }
    losses
}

fn joined<T>(thread: ScopedJoinHandle<'_, T>) -> Result<T, BenchError> {
    thread.join().map_err(|_| BenchError::Thread { name: "records the run" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::MemoryBus;
    use crate::record::measured::read_record;
    use crate::rig::RigNode;
    use crate::run::{Plan, Terms, session};
    use can_protocol::Profile;
    use scenario::run::{Overrides, Run};
    use std::fs::File;
    use std::os::unix::fs::FileExt as _;
    use std::path::Path;
    use std::sync::atomic::AtomicU64;

    /// Records so many seconds of a scenario, as fast as possible; gives the cycles done too.
    fn recorded<S: Storage + fmt::Debug>(
        seconds: f64,
        [record_file, log, events]: [S; 3],
        path: &Path,
    ) -> (Recording, u64) {
        let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
        let overrides = Overrides { duration_s: Some(seconds), speed_kmh: None };
        let run = Run::load(&scenario, overrides).unwrap();
        let plan = Plan::new(&run, &BusChoice::Memory).unwrap();
        let track = run.track.view();
        let terms = Terms::in_memory(Profile::Classical);
        let session = session(&run, &track, &plan.rigs, terms).unwrap();
        let rigs = plan.rigs.iter().map(|rig| RigNode::new(&run.rig, rig.node, session.profile));
        let mut buses = vec![MemoryBus::new(rigs)];
        let mut state = session.start(session.line.start(run.start.state.clone()));
        let stop = Requests::armed();
        session.meet(&mut state, &mut buses, Duration::from_secs(10), &stop).unwrap();
        let output = Output {
            record: (path.to_owned(), record_file),
            log: (PathBuf::from("bus.log"), log),
            events: (PathBuf::from("events.jsonl"), events),
            bus_names: vec!["memory".to_owned()],
            epoch: Epoch::now(),
            handshake: Vec::new(),
        };
        let task = Task {
            session: &session,
            state: &mut state,
            buses: &mut buses,
            bus: &BusChoice::Memory,
            pace: &mut Pace::Fast,
            cycles: run.cycles(),
        };
        let recording = record(task, &RealtimeOptions::NONE, &output, &stop).unwrap();
        // Nothing that grows is kept while a run goes on.
        assert_eq!((recording.columns.rows(), recording.columns.last.0), (0, state.line.cycle));
        (recording, state.line.cycle)
    }

    fn place(name: &str) -> PathBuf {
        std::env::temp_dir().join(format!("hil-host-{}-{name}.npy", std::process::id()))
    }

    fn nowhere() -> File {
        File::options().write(true).open("/dev/null").unwrap()
    }

    #[test]
    fn a_full_disk_ends_the_run_and_what_was_recorded_can_be_read() {
        let Ok(full) = File::options().write(true).open("/dev/full") else { return };
        let path = place("full-disk");
        let files = [File::create(&path).unwrap(), full, nowhere()];
        let (recording, cycles) = recorded(600.0, files, &path);
        assert_eq!(recording.end, End::Stopped);
        assert!(recording.dropped > 2000, "{}", recording.dropped);
        let error = recording.failure.unwrap();
        assert!(!error.is_bad_input() && !error.is_safe_state(), "{error:?}");
        let text = error.to_string();
        assert!(text.starts_with("bus.log: No space left"), "{text}");
        // It stopped long before its 600 s.
        let rows = read_record(&path, 1).unwrap().lines.len();
        assert!(rows > 1000 && rows < 500_000, "{rows} rows");
        assert_eq!(rows as u64, cycles);
        std::fs::remove_file(path).unwrap();
    }

    /// A disk on which every so many writes of rows fail halfway; zero: none.
    #[derive(Debug)]
    struct Flaky {
        file: File,
        every: u64,
        writes: AtomicU64,
    }

    impl Storage for Flaky {
        fn write_at(&self, bytes: &[u8], at: u64) -> io::Result<()> {
            let is_rows = at > 0 && bytes.len() >= Row::size();
            if is_rows && self.every > 0 {
                let number = self.writes.fetch_add(1, Ordering::Relaxed) + 1;
                if number.is_multiple_of(self.every) {
                    self.file.write_all_at(&bytes[..=bytes.len() / 2], at)?;
                    return Err(io::ErrorKind::StorageFull.into());
                }
            }
            Storage::write_at(&self.file, bytes, at)
        }
        fn cut(&self, length: u64) -> io::Result<()> {
            self.file.cut(length)
        }
        fn sync(&self) -> io::Result<()> {
            // As on a device that keeps nothing.
            Ok(())
        }
    }

    #[test]
    fn a_disk_that_fails_now_and_then_loses_counted_rows_and_the_run_goes_on() {
        let path = place("flaky-disk");
        let disk = |file, every| Flaky { file, every, writes: AtomicU64::new(0) };
        let files = [disk(File::create(&path).unwrap(), 3), disk(nowhere(), 0), disk(nowhere(), 0)];
        let (recording, cycles) = recorded(12.0, files, &path);
        // 12 s, and four fades of half a second.
        assert_eq!((recording.end, cycles), (End::Completed, 14_000));
        assert!(recording.failure.is_none(), "{:?}", recording.failure);
        let series = read_record(&path, 1).unwrap();
        assert!(recording.dropped > 0, "no write failed");
        assert_eq!(series.lines.len() as u64 + recording.dropped, cycles);
        // Whole rows in order, with gaps.
        let all = series.time_s.is_sorted_by(|a, b| a < b);
        assert!(all && *series.time_s.last().unwrap() < 13.0);
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn a_disk_that_takes_no_more_rows_ends_the_run_after_a_second() {
        let path = place("dead-disk");
        let disk = |file, every| Flaky { file, every, writes: AtomicU64::new(0) };
        let files = [disk(File::create(&path).unwrap(), 1), disk(nowhere(), 0), disk(nowhere(), 0)];
        let (recording, cycles) = recorded(60.0, files, &path);
        // A second, the batch in which it ends, and what the queue holds by then.
        assert_eq!(recording.end, End::Stopped);
        assert!(cycles > 1000 && cycles < 20_000, "{cycles}");
        assert_eq!(recording.dropped, cycles);
        let text = recording.failure.unwrap().to_string();
        assert!(text.contains("dead-disk.npy: no storage space: the run was ended"), "{text}");
        assert_eq!(read_record(&path, 1).unwrap().lines.len(), 0);
        std::fs::remove_file(path).unwrap();
    }
}
