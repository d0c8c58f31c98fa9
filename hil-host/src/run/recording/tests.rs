//! A disk that fails, parts of a long run, and events as they happen.

use super::*;
use crate::bus::MemoryBus;
use crate::control::Course;
use crate::record::measured::{read_bus_log, read_record};
use crate::record::{PART_CYCLES, part_name};
use crate::rig::RigNode;
use crate::run::work::Coupled;
use crate::run::{Plan, Terms, session};
use crate::statistics::Statistics;
use can_protocol::{Node, Profile};
use scenario::run::{Overrides, Run};
use scenario::source::Source;
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
fn recorded<S: Storage + fmt::Debug>(seconds: f64, files: [S; 3], path: &Path) -> (Recording, u64) {
    recorded_in(seconds, &Given(files, path), PART_CYCLES, Some(1000))
}

/// The same with parts of so many cycles, and so many that may be lost in a row.
fn recorded_in<P: Place>(
    seconds: f64,
    place: P,
    part_cycles: u64,
    lost_cycles_max: Option<u32>,
) -> (Recording, u64) {
    let (recording, state) = recorded_with("", seconds, place, part_cycles, lost_cycles_max);
    (recording, state.line.cycle)
}

/// The same of a scenario with further tables in its file.
fn recorded_with<P: Place>(
    tables: &str,
    seconds: f64,
    place: P,
    part_cycles: u64,
    lost_cycles_max: Option<u32>,
) -> (Recording, SessionState) {
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
    let overrides = Overrides { duration_s: Some(seconds), ..Overrides::default() };
    let text = std::fs::read_to_string(&scenario).unwrap();
    let source = Source::from_text(&scenario, &format!("{text}\n{tables}"));
    let run = Run::from_source(&source, overrides).unwrap();
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
        lost_cycles_max,
        bus_names: vec!["memory".to_owned()],
        epoch: Epoch::now(),
        handshake: Vec::new(),
        feed: None,
    };
    let task = Task {
        session: &session,
        work: Coupled { course: Course::new(&run, &track), cycles: run.cycles() },
        state: &mut state,
        buses: &mut buses,
        bus: &BusChoice::Memory,
        pace: &mut Pace::Fast,
        cycles: run.cycles(),
    };
    let recording = record(task, &RealtimeOptions::NONE, output, &stop).unwrap();
    assert_eq!(recording.counts.last.0, state.line.cycle);
    (recording, state)
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

#[test]
fn a_run_that_may_lose_its_rows_goes_on_without_them() {
    let path = place("lost-disk");
    let disk = |file, every| Flaky { file, every, writes: AtomicU64::new(0) };
    let files = [disk(File::create(&path).unwrap(), 1), disk(nowhere(), 0), disk(nowhere(), 0)];
    let (recording, cycles) = recorded_in(5.0, &Given(files, &path), PART_CYCLES, None);
    assert_eq!((recording.end, cycles), (End::Completed, 7000));
    assert!(recording.failure.is_none(), "{:?}", recording.failure);
    assert_eq!(recording.dropped, 7000);
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

/// The events that a run of three seconds with these tables has written, line by line.
fn events_of(name: &str, tables: &str) -> (Vec<RunEvent>, Recording, SessionState) {
    let folder = Folder(place(name).with_extension(""));
    std::fs::create_dir_all(&folder.0).unwrap();
    let (recording, state) = recorded_with(tables, 3.0, &folder, PART_CYCLES, Some(1000));
    let text = std::fs::read_to_string(folder.file(RunFile::Events, 1)).unwrap();
    std::fs::remove_dir_all(folder.0).unwrap();
    let events = text.lines().map(|line| serde_json::from_str(line).unwrap());
    (events.collect(), recording, state)
}

#[test]
fn a_run_begins_with_the_time_of_its_first_row() {
    // It was -0.001 s, without the fades.
    let (events, ..) = events_of("begun", "");
    assert_eq!((&*events[0].what, events[0].time_s, events[0].cycle), ("run begun", -1.0, 1));
    assert_eq!((&*events[1].what, events[1].time_s), ("state RAMP_IN", -1.0));
    assert!(events.is_sorted_by_key(|event| event.cycle), "{events:?}");
}

#[test]
fn what_a_check_only_logs_was_no_event() {
    let table = "[plausibility]\nforce = { limit_n = 2e3, action = \"log\" }\n";
    let (events, recording, state) = events_of("noted", table);
    assert_eq!((recording.end, state.stop), (End::Completed, None));
    let noted = |event: &&RunEvent| event.signal.as_deref() == Some("force");
    let noted: Vec<&RunEvent> = events.iter().filter(noted).collect();
    let [first] = *noted else { panic!("{events:?}") };
    assert!(first.what.starts_with("noted: at ") && first.what.contains("measured force"));
    assert_eq!((first.limit, first.node), (Some(2e3), Some(1)));
    // In its place, long before the end.
    let last = state.ports[0].belief.noted().next().unwrap();
    assert_eq!((first.cycle, first.value), (last.first_cycle, Some(last.first.value)));
    assert!(events.is_sorted_by_key(|event| event.cycle), "{events:?}");
}

#[test]
fn a_cause_is_an_event_before_the_run_has_faded_out() {
    let table = "[plausibility]\nresidual = { limit_n = 100.0, action = \"ramp out\" }\n";
    let (events, recording, state) = events_of("cause", table);
    let stop = state.stop.unwrap();
    assert_eq!(recording.end, End::RampedOut);
    let what: Vec<&str> = events.iter().map(|event| &*event.what).collect();
    let at = |begin: &str| what.iter().position(|what| what.starts_with(begin)).unwrap();
    let (cause, ramp_out) = (at("cause: "), at("state RAMP_OUT"));
    assert!(cause < ramp_out && ramp_out < at("run ended: ramped out"), "{what:?}");
    assert_eq!(what[cause], format!("cause: {stop}"));
    let event = &events[cause];
    assert_eq!((event.cycle, event.time_s, event.node), (stop.cycle, stop.time_s, Some(1)));
    assert!(state.line.cycle > stop.cycle + 500, "{stop}");
    assert_eq!(what.iter().filter(|what| what.starts_with("cause")).count(), 1);
}

#[test]
fn a_run_in_parts_is_read_like_a_run_in_one_file() {
    let folders = ["parts", "whole"].map(|name| Folder(place(name).with_extension("")));
    let mut read = Vec::new();
    for (folder, part_cycles) in folders.iter().zip([1500, PART_CYCLES]) {
        std::fs::create_dir_all(&folder.0).unwrap();
        let (recording, cycles) = recorded_in(3.0, folder, part_cycles, Some(1000));
        assert!(recording.failure.is_none() && cycles == 5000, "{recording:?}");
        let record = folder.file(RunFile::Record, 1);
        let series = read_record(&record, 1).unwrap();
        assert_eq!(series.lines.len(), 5000);
        let node = Node::new(1).unwrap();
        let log = read_bus_log(&folder.file(RunFile::Log, 1), node, None).unwrap();
        let mut counts = Counts::default();
        let statistics = Statistics::of(&record, 0.5, 1e-3, |row| counts.take(row)).unwrap();
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
