//! The loop with the threads around it: record, bus log, disk, progress, page.

use super::handshake::{Epoch, Heard};
use super::progress::{self, Progress};
use super::work::Work;
use crate::BenchError;
use crate::bus::{Bus, BusChoice};
use crate::control::{Asker, Buses, End, Notice, Pace, Requests, Session, SessionState};
use crate::counts::Counts;
use crate::live::{AgreedLimits, Feed};
use crate::realtime::{self, RealtimeOptions};
use crate::record::{
    BusEvent, BusLog, Drain, EventLog, InParts, LoggedFrame, Loss, NpyWriter, OpenFiles, Outlet,
    Queues, Row, RunEvent, Storage, by_part,
};
use crossbeam_channel::{Receiver, RecvTimeoutError, bounded};
use std::fmt;
use std::io;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::ScopedJoinHandle;
use std::time::{Duration, Instant};

/// The loop with everything that it changes.
pub(super) struct Task<'a, 's, B, W> {
    pub(super) session: &'a Session<'s>,
    pub(super) work: W,
    pub(super) state: &'a mut SessionState,
    pub(super) buses: &'a mut [B],
    /// The bus as it was given.
    pub(super) bus: &'a BusChoice,
    pub(super) pace: &'a mut Pace,
    /// Cycles that are expected, for the line of progress.
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
    /// Cycles in a row that may be lost before the run ends in order; none: it goes on.
    pub(super) lost_cycles_max: Option<u32>,
    /// Names of the buses in the log.
    pub(super) bus_names: Vec<String>,
    /// Time zero of the log.
    pub(super) epoch: Epoch,
    /// What passed the buses before the rigs were armed.
    pub(super) handshake: Vec<BusEvent>,
    /// What shows the run on a page, if there is one.
    pub(super) feed: Option<Feed>,
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
pub(super) fn record<B: Bus, P: Place, W: Work>(
    task: Task<'_, '_, B, W>,
    realtime_options: &RealtimeOptions,
    output: Output<P>,
    requests: &Requests,
) -> Result<Recording, BenchError> {
    let Task { session, mut work, state, buses, bus, pace, cycles } = task;
    let cycle_ns = session.line.cycle_s * 1e9 * f64::from(session.slow_down.get());
    let cycle_ns = (cycle_ns as u64).max(1);
    let Output { place, part_cycles, lost_cycles_max, bus_names, epoch, handshake, feed } = output;
    let place = &place;
    let longest_ns = lost_cycles_max.map(|cycles| u64::from(cycles) * cycle_ns);
    let no_loss = || Loss::ending_after(longest_ns);
    let open: [OpenFiles<P::File>; 3] = Default::default();
    let failed = |file| move |why| BenchError::File { file: place.path(file), why };
    let lines = InParts::new(|part| {
        let file = place.make(RunFile::Log, part)?;
        let log = BusLog::begin(file, epoch.unix_ns, bus_names.clone());
        open[1].add(log.file());
        Ok(log)
    });
    let mut lines = lines.map_err(failed(RunFile::Log))?;
    let first = lines.part(1).and_then(|log| log.write(&handshake));
    first.map_err(failed(RunFile::Log))?;
    // Begun after the log: whoever finds a record finds the handshake too.
    let record = InParts::new(|part| {
        let writer = NpyWriter::begin(place.make(RunFile::Record, part)?)?;
        open[0].add(writer.file());
        Ok(writer)
    });
    let record = record.map_err(failed(RunFile::Record))?;
    let events = place.make(RunFile::Events, 1).map_err(failed(RunFile::Events))?;
    let happened = EventLog::begin(events);
    open[2].add(happened.file());
    // The headers, before anything moves.
    open[0].hold().map_err(failed(RunFile::Record))?;
    let per_ms = session.cycles(1e-3).max(1) as usize;
    let mut queues = Queues::for_cycles(per_ms, session.ports.len());
    let (mut recorder, drain) = queues.split();
    recorder.rows_lost_at_most = lost_cycles_max.map_or(u64::MAX, u64::from);
    let done = AtomicBool::new(false);
    let agreed = OnceLock::new();
    let (progress, shown) = Progress::new(session.line.speed_m_per_s * 3.6);
    let (running, ended) = bounded::<()>(0);
    std::thread::scope(|scope| {
        let (done, open, agreed) = (&done, &open, &agreed);
        let Drain { rows, events, notices } = drain;
        let record = scope.spawn(move || {
            let loss = no_loss();
            let shown = Shown { progress, feed, agreed };
            let to = RowOutput { record, part_cycles, happened, shown, cycle_ns, loss };
            write_rows(to, (&rows, &notices), done, requests)
        });
        let log = scope.spawn(move || {
            let to = FrameOutput { log: lines, part_cycles, loss: no_loss() };
            write_frames(to, &events, done, requests)
        });
        let held = [no_loss(), no_loss()];
        let sync = scope.spawn(move || hold_on(open, held, &ended, requests));
        scope.spawn(move || progress::show(&shown, cycles));

        // After the other threads have started: they must not inherit the loop's processor.
        if let Pace::Realtime(_) = pace {
            for line in realtime::set_up(realtime_options).lines() {
                files::say!("real-time: {line}");
            }
        }
        let mut heard = Heard::all(buses, epoch);
        // From the first command on a rig waits for no file and no thread.
        let armed = work.arm(session, state, &mut heard, requests);
        for event in Heard::events(heard) {
            recorder.event(event);
        }
        if let Err(why) = armed {
            done.store(true, Ordering::Release);
            drop(running);
            return Err(why.on(bus));
        }
        // For the recorder's thread; with a page and without one.
        let _is_first = agreed.set(session.agreed(state));
        let begin = Instant::now();
        let mut buses = Buses::new(buses, &mut recorder).counted_from(epoch.begin);
        let end = work.run(session, state, &mut buses, pace, requests);
        let wall_s = begin.elapsed().as_secs_f64();
        done.store(true, Ordering::Release);
        drop(running);
        let (record, counts, mut happened) = joined(record)?;
        let (cycle, time_s) = (state.line.cycle, state.line.time_s(session.line.cycle_s));
        // A disk that does not take it is named below or has taken all rows.
        let _ = happened.write(&of_run(cycle, time_s, ended_as(end)));
        let (log, [record_held, log_held]) = (joined(log)?, joined(sync)?);
        let dropped = recorder.dropped_rows + recorder.dropped_events + record.count + log.count;
        let mut slow = no_loss();
        if recorder.is_overrun() {
            slow.finish(Err(io::Error::other("the disk is too slow")));
        }
        let [mut record_last, mut log_last] = [no_loss(), no_loss()];
        record_last.finish(open[0].hold());
        log_last.finish(open[1].hold());
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
        let failure = first_failure(place, losses, dropped);
        Ok(Recording { end, counts, dropped, wall_s, failure })
    })
}

/// The first loss that ended the run.
fn first_failure(
    place: &impl Place,
    losses: impl IntoIterator<Item = (RunFile, Loss)>,
    dropped: u64,
) -> Option<BenchError> {
    let mut ended = losses.into_iter().filter(|(_, loss)| loss.too_long);
    ended.find_map(|(file, loss)| {
        Some(BenchError::Unrecorded { file: place.path(file), why: loss.why?, dropped })
    })
}

/// Where the rows go.
struct RowOutput<'a, S> {
    record: InParts<'a, NpyWriter<S>>,
    part_cycles: u64,
    happened: EventLog<S>,
    shown: Shown<'a>,
    /// Wall time of a cycle.
    cycle_ns: u64,
    loss: Loss,
}

/// Who sees the rows while the run goes on.
struct Shown<'a> {
    progress: Progress,
    /// The page, if there is one.
    feed: Option<Feed>,
    /// Known from the first row on.
    agreed: &'a OnceLock<AgreedLimits>,
}

impl Shown<'_> {
    /// Shows rows that have been counted.
    fn take(&mut self, rows: &[Row], counts: &Counts) {
        if let Some(last) = rows.last() {
            self.progress.take(last, counts);
        }
        if let (Some(feed), Some(agreed)) = (&mut self.feed, self.agreed.get()) {
            for row in rows {
                feed.take(row, agreed);
            }
            feed.push(counts, agreed, Instant::now());
        }
    }

    fn notice(&mut self, notice: &Notice) {
        if let Some(feed) = &mut self.feed {
            feed.notice(notice);
        }
    }

    fn finish(&mut self, counts: &Counts) {
        if let (Some(feed), Some(agreed)) = (&mut self.feed, self.agreed.get()) {
            feed.finish(counts, agreed);
        }
    }
}

/// Where the frames go.
struct FrameOutput<'a, S> {
    log: InParts<'a, BusLog<S>>,
    part_cycles: u64,
    loss: Loss,
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

/// Writes the rows, and what happened no later than the row of its cycle; counts what progress and
/// summary need.
fn write_rows<S: Storage>(
    to: RowOutput<'_, S>,
    (rows, notices): (&Outlet<'_, Row>, &Outlet<'_, Notice>),
    done: &AtomicBool,
    requests: &Requests,
) -> (Loss, Counts, EventLog<S>) {
    let RowOutput { mut record, part_cycles, mut happened, mut shown, cycle_ns, mut loss } = to;
    let mut counts = Counts::default();
    let found = |shown: &mut Shown<'_>| {
        let notice = notices.next().inspect(|notice| shown.notice(notice))?;
        let event = RunEvent::of(&notice);
        if matches!(notice, Notice::DroppedOut { .. }) {
            // The run goes on, and nobody would look.
            files::say!("{}", event.what);
        }
        Some(event)
    };
    let mut next: Option<RunEvent> = None;
    rows.run(done, |rows| {
        for (part, rows) in by_part(rows, part_cycles, |row| row.cycle) {
            let Some(last) = rows.last() else { continue };
            let written = record.part(part).and_then(|record| record.write(rows));
            if loss.take(written, rows.len() as u64, last.cycle * cycle_ns) {
                requests.end(Asker::Record);
            }
            for row in rows {
                counts.take(row);
                // An event that finds no room is also in the rows or in the summary.
                next = next.take().or_else(|| found(&mut shown));
                while let Some(event) = next.take_if(|event| event.cycle <= row.cycle) {
                    let _ = happened.write(&event);
                    next = found(&mut shown);
                }
                let _ = happened.take(row);
            }
            shown.take(rows, &counts);
        }
    });
    for event in next.into_iter().chain(std::iter::from_fn(|| found(&mut shown))) {
        let _ = happened.write(&event);
    }
    shown.finish(&counts);
    loss.finish(record.into_last().finish().map(|_| ()));
    (loss, counts, happened)
}

fn write_frames<S: Storage>(
    to: FrameOutput<'_, S>,
    frames: &Outlet<'_, LoggedFrame>,
    done: &AtomicBool,
    requests: &Requests,
) -> Loss {
    let FrameOutput { mut log, part_cycles, mut loss } = to;
    frames.run(done, |frames| {
        for (part, frames) in by_part(frames, part_cycles, |frame| frame.cycle) {
            let Some(last) = frames.last() else { continue };
            let events = frames.iter().map(|frame| &frame.event);
            let written = log.part(part).and_then(|log| log.write(events));
            if loss.take(written, frames.len() as u64, last.event.time_ns) {
                requests.end(Asker::Record);
            }
        }
    });
    loss.finish(log.into_last().finish());
    loss
}

/// Has the disk hold what has been written, again and again until the run has ended. The threads
/// that write do not wait for it; a slow disk delays it by the time that it takes itself.
fn hold_on<S: Storage>(
    [record, log, events]: &[OpenFiles<S>; 3],
    mut losses: [Loss; 2],
    ended: &Receiver<()>,
    requests: &Requests,
) -> [Loss; 2] {
    let begin = Instant::now();
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
            requests.end(Asker::Record);
        }
        next = (next + HOLD_RECORD).max(Instant::now());
    }
    losses
}

fn joined<T>(thread: ScopedJoinHandle<'_, T>) -> Result<T, BenchError> {
    thread.join().map_err(|_| BenchError::Thread { name: "records the run" })
}

#[cfg(test)]
mod stalled_tests;
#[cfg(test)]
mod tests;
