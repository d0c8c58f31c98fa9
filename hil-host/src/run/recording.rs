//! The loop with the threads around it: record, bus log, disk, progress.

use super::handshake::{Epoch, Heard};
use super::progress::{self, Progress};
use crate::BenchError;
use crate::bus::{Bus, BusChoice};
use crate::control::{Buses, Course, End, Pace, Requests, Session, SessionState};
use crate::counts::Counts;
use crate::realtime::{self, RealtimeOptions};
use crate::record::{
    BusEvent, BusLog, Drain, EventLog, InParts, LoggedFrame, Loss, NpyWriter, OpenFiles, Outlet,
    Queues, Row, RunEvent, Storage, by_part,
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
    /// Its thread has begun: it must not inherit what the loop asks of the kernel.
    pub(super) course: Course<'s>,
    pub(super) state: &'a mut SessionState,
    pub(super) buses: &'a mut [B],
    /// The bus as it was given.
    pub(super) bus: &'a BusChoice,
    pub(super) pace: &'a mut Pace,
    pub(super) cycles: u64,
}

/// Files that a run writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RunFile {
    Record,
    Log,
    Events,
}

/// Where the files of a run are made.
pub(super) trait Place: Sync {
    type File: Storage + fmt::Debug;

    /// Makes a part, from one, of a file.
    fn make(&self, file: RunFile, part: u64) -> io::Result<Self::File>;

    /// The path of its first part, for messages.
    fn path(&self, file: RunFile) -> PathBuf;
}

/// What the loop writes while it runs.
#[derive(Debug)]
pub(super) struct Output<P> {
    pub(super) place: P,
    /// Cycles in a part of the record and of the log.
    pub(super) part_cycles: u64,
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
    pub(super) counts: Counts,
    /// Rows and frames that the recorder had no room for, or the disk.
    pub(super) dropped: u64,
    pub(super) wall_s: f64,
    /// Why the record could not be kept and the run was ended.
    pub(super) failure: Option<BenchError>,
}

/// Time after which the disk is asked again to hold the rows: their number in the header follows,
/// and a program that is killed leaves a header that is hardly older.
const HOLD_RECORD: Duration = Duration::from_millis(50);

/// The same for bus log and events, which have no number: with the write of a batch, a power cut
/// loses well below two seconds.
const HOLD_LOG: Duration = Duration::from_millis(500);

/// Arms the rigs, runs the loop on this thread and records it.
///
/// # Errors
/// A rig that cannot be armed, with nothing recorded; a file that cannot be written.
pub(super) fn record<B: Bus, P: Place>(
    task: Task<'_, '_, B>,
    realtime_options: &RealtimeOptions,
    output: &Output<P>,
    requests: &Requests,
) -> Result<Recording, BenchError> {
    let Task { session, mut course, state, buses, bus, pace, cycles } = task;
    let cycle_ns = session.line.cycle_s * 1e9 * f64::from(session.slow_down.get());
    let cycle_ns = (cycle_ns as u64).max(1);
    let Output { place, part_cycles, epoch, .. } = output;
    let (epoch, part_cycles) = (*epoch, *part_cycles);
    let open: [OpenFiles<P::File>; 3] = Default::default();
    let failed = |file| move |why| BenchError::File { file: place.path(file), why };
    let lines = InParts::new(|part| {
        let file = place.make(RunFile::Log, part)?;
        let log = BusLog::begin(file, epoch.unix_ns, output.bus_names.clone());
        open[1].add(log.file());
        Ok(log)
    });
    let mut lines = lines.map_err(failed(RunFile::Log))?;
    let first = lines.part(1).and_then(|log| log.write(&output.handshake));
    first.map_err(failed(RunFile::Log))?;
    // Begun after the log: whoever finds a record finds the handshake too.
    let record = InParts::new(|part| {
        let writer = NpyWriter::begin(place.make(RunFile::Record, part)?)?;
        open[0].add(writer.file());
        Ok(writer)
    });
    let record = record.map_err(failed(RunFile::Record))?;
    let of_events = failed(RunFile::Events);
    let mut happened = EventLog::begin(place.make(RunFile::Events, 1).map_err(&of_events)?);
    open[2].add(happened.file());
    happened
        .write(&of_run(0, state.line.time_s(session.line.cycle_s), "run begun"))
        .map_err(&of_events)?;
    // The headers, before anything moves.
    open[0].hold().map_err(failed(RunFile::Record))?;
    let mut queues = Queues::for_rigs(session.ports.len());
    let (mut recorder, drain) = queues.split();
    recorder.rows_lost_at_most = 1_000_000_000 / cycle_ns;
    let done = AtomicBool::new(false);
    let (progress, shown) = Progress::new(session.line.speed_m_per_s * 3.6);
    let (running, ended) = bounded::<()>(0);
    std::thread::scope(|scope| {
        let (done, open, Drain { rows, events }) = (&done, &open, drain);
        let record = scope.spawn(move || {
            let to = RowOutput { record, part_cycles, happened, progress, cycle_ns };
            write_rows(to, &rows, done, requests)
        });
        let log = scope.spawn(move || write_frames(lines, part_cycles, &events, done, requests));
        let sync = scope.spawn(move || hold_on(open, &ended, requests));
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
        let end = session.run(&mut course, state, &mut buses, pace, cycles, requests);
        let wall_s = begin.elapsed().as_secs_f64();
        done.store(true, Ordering::Release);
        drop(running);
        let (record, counts, mut happened) = joined(record)?;
        let (cycle, time_s) = (state.line.cycle, state.line.time_s(session.line.cycle_s));
        // A disk that does not take it is named below or has taken all rows.
        if let Some(stop) = &state.stop {
            let _ = happened.write(&RunEvent::cause(&stop.summary()));
        }
        let _ = happened.write(&of_run(cycle, time_s, ended_as(end)));
        let (log, [record_held, log_held]) = (joined(log)?, joined(sync)?);
        let dropped = recorder.dropped_rows + recorder.dropped_events + record.count + log.count;
        let mut slow = Loss::default();
        if recorder.is_overrun() {
            finish(&mut slow, Err(io::Error::other("the disk is too slow")));
        }
        let [record_last, log_last] = hold_last(open);
        let _ = happened.finish();
        let losses = [
            (RunFile::Record, record),
            (RunFile::Record, slow),
            (RunFile::Record, record_held),
            (RunFile::Record, record_last),
            (RunFile::Log, log),
            (RunFile::Log, log_held),
            (RunFile::Log, log_last),
        ];
        let mut failure = None;
        for (file, loss) in losses {
            let Some(why) = loss.why.filter(|_| loss.too_long && failure.is_none()) else {
                continue;
            };
            failure = Some(BenchError::Unrecorded { file: place.path(file), why, dropped });
        }
        Ok(Recording { end, counts, dropped, wall_s, failure })
    })
}

/// Where the rows go.
struct RowOutput<'a, S> {
    record: InParts<'a, NpyWriter<S>>,
    part_cycles: u64,
    happened: EventLog<S>,
    progress: Progress,
    /// Wall time of a cycle.
    cycle_ns: u64,
}

/// An event of the whole run.
fn of_run(cycle: u64, time_s: f64, what: &'static str) -> RunEvent {
    RunEvent { time_s, cycle, what: what.into(), ..RunEvent::default() }
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
    to: RowOutput<'_, S>,
    rows: &Outlet<'_, Row>,
    done: &AtomicBool,
    requests: &Requests,
) -> (Loss, Counts, EventLog<S>) {
    let RowOutput { mut record, part_cycles, mut happened, mut progress, cycle_ns } = to;
    let (mut loss, mut counts) = (Loss::default(), Counts::default());
    rows.run(done, |rows| {
        for (part, rows) in by_part(rows, part_cycles, |row| row.cycle) {
            let Some(last) = rows.last() else { continue };
            let written = record.part(part).and_then(|record| record.write(rows));
            if loss.take(written, rows.len() as u64, last.cycle * cycle_ns) {
                requests.end();
            }
            for row in rows {
                counts.take(row);
                // An event that finds no room is also in the rows.
                let _ = happened.take(row);
            }
            progress.take(last, &counts);
        }
    });
    finish(&mut loss, record.into_last().finish().map(|_| ()));
    (loss, counts, happened)
}

fn write_frames<S: Storage>(
    mut log: InParts<'_, BusLog<S>>,
    part_cycles: u64,
    frames: &Outlet<'_, LoggedFrame>,
    done: &AtomicBool,
    requests: &Requests,
) -> Loss {
    let mut loss = Loss::default();
    frames.run(done, |frames| {
        for (part, frames) in by_part(frames, part_cycles, |frame| frame.cycle) {
            let Some(last) = frames.last() else { continue };
            let events = frames.iter().map(|frame| &frame.event);
            let written = log.part(part).and_then(|log| log.write(events));
            if loss.take(written, frames.len() as u64, last.event.time_ns) {
                requests.end();
            }
        }
    });
    finish(&mut loss, log.into_last().finish());
    loss
}

/// What is not on the disk at the end is lost, however short.
fn finish(loss: &mut Loss, finished: io::Result<()>) {
    if let (Err(why), false) = (finished, loss.too_long) {
        loss.why = Some(why);
        loss.too_long = true;
    }
}

/// Has the disk hold what has been written, again and again until the run has ended. The threads
/// that write do not wait for it; a slow disk delays it by the time that it takes itself.
fn hold_on<S: Storage>(
    [record, log, events]: &[OpenFiles<S>; 3],
    ended: &Receiver<()>,
    requests: &Requests,
) -> [Loss; 2] {
    let (begin, mut losses) = (Instant::now(), [Loss::default(), Loss::default()]);
    let (mut next, mut next_log) = (begin + HOLD_RECORD, begin + HOLD_LOG);
    while ended.recv_deadline(next) == Err(RecvTimeoutError::Timeout) {
        let now = Instant::now();
        let [of_record, of_log] = &mut losses;
        let since_begin = |time: Instant| (time - begin).as_nanos() as u64;
        let mut ends = of_record.take(record.hold(), 0, since_begin(now));
        if now >= next_log {
            next_log = now + HOLD_LOG;
            // An event that is lost is also in the rows.
            let _ = events.hold();
            ends |= of_log.take(log.hold(), 0, since_begin(now));
        }
        if ends {
            requests.end();
        }
        next = (next + HOLD_RECORD).max(Instant::now());
    }
    losses
}

/// Has the disk hold record and log at the end.
fn hold_last<S: Storage>([record, log, _]: &[OpenFiles<S>; 3]) -> [Loss; 2] {
    [record, log].map(|open| {
        let mut loss = Loss::default();
        finish(&mut loss, open.hold());
        loss
    })
}

fn joined<T>(thread: ScopedJoinHandle<'_, T>) -> Result<T, BenchError> {
    thread.join().map_err(|_| BenchError::Thread { name: "records the run" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::MemoryBus;
    use crate::record::measured::{read_bus_log, read_record};
    use crate::record::{PART_CYCLES, part_name};
    use crate::rig::RigNode;
    use crate::run::{Plan, Terms, session};
    use crate::statistics::Statistics;
    use can_protocol::{Node, Profile};
    use scenario::run::{Overrides, Run};
    use std::fs::File;
    use std::os::unix::fs::FileExt as _;
    use std::path::Path;
    use std::sync::atomic::AtomicU64;

    /// Files that are there: record, log and events.
    struct Given<'a, S>([S; 3], &'a Path);

    impl<'a, S: Storage + fmt::Debug> Place for &'a Given<'_, S> {
        type File = &'a S;

        fn make(&self, file: RunFile, part: u64) -> io::Result<&'a S> {
            assert_eq!(part, 1);
            Ok(&self.0[file as usize])
        }
        fn path(&self, file: RunFile) -> PathBuf {
            match file {
                RunFile::Record => self.1.to_owned(),
                RunFile::Log => PathBuf::from("bus.log"),
                RunFile::Events => PathBuf::from("events.jsonl"),
            }
        }
    }

    /// Records so many seconds of a scenario, as fast as possible; gives the cycles done too.
    fn recorded<S: Storage + fmt::Debug>(
        seconds: f64,
        files: [S; 3],
        path: &Path,
    ) -> (Recording, u64) {
        recorded_in(seconds, &Given(files, path), PART_CYCLES)
    }

    /// The same with parts of so many cycles.
    fn recorded_in<P: Place>(seconds: f64, place: P, part_cycles: u64) -> (Recording, u64) {
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
            place,
            part_cycles,
            bus_names: vec!["memory".to_owned()],
            epoch: Epoch::now(),
            handshake: Vec::new(),
        };
        let task = Task {
            session: &session,
            course: Course::new(&run, &track),
            state: &mut state,
            buses: &mut buses,
            bus: &BusChoice::Memory,
            pace: &mut Pace::Fast,
            cycles: run.cycles(),
        };
        let recording = record(task, &RealtimeOptions::NONE, &output, &stop).unwrap();
        assert_eq!(recording.counts.last.0, state.line.cycle);
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

    /// A folder in which every part is a file.
    struct Folder(PathBuf);

    impl Folder {
        fn file(&self, file: RunFile, part: u64) -> PathBuf {
            let name = match file {
                RunFile::Record => "record.npy",
                RunFile::Log => "bus.log",
                RunFile::Events => "events.jsonl",
            };
            self.0.join(part_name(name, part))
        }
    }

    impl Place for &Folder {
        type File = File;

        fn make(&self, file: RunFile, part: u64) -> io::Result<File> {
            File::create(self.file(file, part))
        }
        fn path(&self, file: RunFile) -> PathBuf {
            self.file(file, 1)
        }
    }

    #[test]
    fn a_run_in_parts_is_read_like_a_run_in_one_file() {
        let folders = ["parts", "whole"].map(|name| Folder(place(name).with_extension("")));
        let mut read = Vec::new();
        for (folder, part_cycles) in folders.iter().zip([1500, PART_CYCLES]) {
            std::fs::create_dir_all(&folder.0).unwrap();
            let (recording, cycles) = recorded_in(3.0, folder, part_cycles);
            assert!(recording.failure.is_none() && cycles == 5000, "{recording:?}");
            let record = folder.file(RunFile::Record, 1);
            let series = read_record(&record, 1).unwrap();
            assert_eq!(series.lines.len(), 5000);
            let node = Node::new(1).unwrap();
            let log = read_bus_log(&folder.file(RunFile::Log, 1), node, None).unwrap();
            let mut counts = Counts::default();
            let statistics = Statistics::of(&record, 0.5, |row| counts.take(row)).unwrap();
            assert_eq!((counts.rows(), statistics.shown.rows), (5000, 2500));
            read.push((
                (series.time_s, series.force_n),
                (log.time_s, log.force_n),
                statistics.traces.force.map(|force| force.value),
            ));
        }
        assert!(read[0] == read[1], "parts are read differently");
        // Every file has its cycles, and a header of its own.
        for (part, rows) in [(1, 1500), (2, 1500), (3, 1500), (4, 500)] {
            let bytes = std::fs::read(folders[0].file(RunFile::Record, part)).unwrap();
            let header = String::from_utf8_lossy(&bytes[..4096]);
            assert!(header.contains(&format!("'shape': ({rows} ")), "part {part}");
            assert!(folders[0].file(RunFile::Log, part).is_file());
        }
        assert!(!folders[0].file(RunFile::Record, 5).exists());
        for folder in folders {
            std::fs::remove_dir_all(folder.0).unwrap();
        }
    }
}
