//! Measuring: the loop's thread, bus and page in threads of their own, and a bar of progress.

use super::answer::{AnswerTimes, AnsweredBy, find_rig, hear_host, time_answers};
use super::beside_page::{self, BesidePage};
use super::distribution::empty;
use super::ticks::Ticks;
use crate::BenchError;
use crate::bus::{Bus, BusChoice, SocketCanBus};
use crate::clock::{Pacer, now_ns};
use crate::control::Course;
use crate::live::LivePage;
use crate::progress_bar::LateBar;
use crate::realtime::{self, RealtimeOptions, RealtimeReport};
use crate::record::{Drain, Queues, Recorder};
use crate::run::line;
use can_protocol::{MessageId, Profile};
use firmware_core::guard::ForceInput;
use firmware_core::line::{Line, Slot};
use firmware_core::vehicle::DAMPER_SLOTS;
use hdrhistogram::Histogram;
use scenario::run::{Rate, Run};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::ScopedJoinHandle;
use std::time::Duration;

/// How often progress is looked at.
const GLANCE: Duration = Duration::from_millis(50);

/// What is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Ticks to measure.
    pub ticks: u64,
    /// Their rate.
    pub rate: Rate,
    /// Real-time set-up of the loop's thread.
    pub realtime: RealtimeOptions,
    /// The bus whose answer time is measured; none in memory.
    pub bus: BusChoice,
    /// The profile that rigs are asked for.
    pub profile: Profile,
}

/// What was measured.
#[derive(Debug, Clone)]
pub struct Measured {
    /// What the system granted.
    pub realtime: RealtimeReport,
    /// Ticks that were to come; fewer than asked for where the user ended it.
    pub expected: u64,
    /// Ticks on which a cycle was run.
    pub met: u64,
    /// Ticks that were skipped.
    pub skipped: u64,
    /// Whether the user ended it.
    pub is_interrupted: bool,
    /// How late the thread woke up (ns).
    pub lateness_ns: Histogram<u64>,
    /// Time of a vehicle step (ns); empty without a scenario.
    pub step_ns: Histogram<u64>,
    /// The answers of a bus.
    pub answers: Option<AnswerTimes>,
    /// The same times with a page that is fed and without; none without a page.
    pub beside_page: Option<BesidePage>,
}

impl Measured {
    fn new(expected: u64) -> Self {
        Self {
            realtime: RealtimeReport::default(),
            expected,
            met: 0,
            skipped: 0,
            is_interrupted: false,
            lateness_ns: empty(),
            step_ns: empty(),
            answers: None,
            beside_page: None,
        }
    }
}

/// Measures until all ticks have come or `stop` is set. A `page` shows every other second.
///
/// # Errors
/// The bus cannot be used or a host is on it; real time is required and was not granted.
pub fn measure(
    run: Option<&Run>,
    options: &Options,
    page: Option<&LivePage>,
    stop: &AtomicBool,
) -> Result<Measured, BenchError> {
    let sockets = match &options.bus {
        BusChoice::Memory => None,
        BusChoice::SocketCan(interface) => Some(Sockets::open(interface, options.profile)?),
    };
    let (done, ended) = (AtomicU64::new(0), AtomicBool::new(false));
    let mut queues = Queues::for_rigs(0);
    let (mut recorder, drain) = queues.split();
    let recorder = page.is_some().then_some(&mut recorder);
    std::thread::scope(|scope| {
        if let Some(page) = page {
            let (feed, ended) = (beside_page::begin(page, run, options.ticks), &ended);
            let Drain { rows, .. } = drain;
            scope.spawn(move || beside_page::take(&rows, feed, ended));
            scope.spawn(move || beside_page::read(page.address(), ended));
        }
        // Before the loop, whose processor it would inherit otherwise.
        let answers = sockets.map(|mut sockets| {
            let ended = &ended;
            scope.spawn(move || {
                realtime::set_up(&of_bus_thread(&options.realtime));
                sockets.time(options.profile, ended)
            })
        });
        let paced = scope.spawn(|| paced(run, options, recorder, stop, &done));
        show(&paced, &done, options.ticks);
        ended.store(true, Ordering::Relaxed);
        let mut measured =
            paced.join().map_err(|_| BenchError::Thread { name: "keeps the pace" })??;
        if let Some(answers) = answers {
            let answers = answers.join();
            measured.answers =
                Some(answers.map_err(|_| BenchError::Thread { name: "times the bus" })?);
        }
        Ok(measured)
    })
}

/// Shows how far it is, until the loop has ended.
fn show<T>(paced: &ScopedJoinHandle<'_, T>, done: &AtomicU64, ticks: u64) {
    let mut bar = LateBar::new("ticks", ticks);
    while !paced.is_finished() {
        std::thread::sleep(GLANCE);
        bar.at(done.load(Ordering::Relaxed));
    }
    bar.finish();
}

/// The set-up of the thread of the bus: below its priority and not on its processor.
fn of_bus_thread(realtime: &RealtimeOptions) -> RealtimeOptions {
    let fifo_priority = realtime.fifo_priority.map(|priority| priority.saturating_sub(1).max(1));
    RealtimeOptions { fifo_priority, ..RealtimeOptions::NONE }
}

/// The loop's thread.
fn paced(
    run: Option<&Run>,
    options: &Options,
    mut recorder: Option<&mut Recorder<'_>>,
    stop: &AtomicBool,
    done: &AtomicU64,
) -> Result<Measured, BenchError> {
    let mut measured = Measured::new(options.ticks);
    measured.beside_page = recorder.is_some().then(BesidePage::default);
    let mut ticks = Ticks::new(options.ticks);
    let track = run.map(|run| run.track.view());
    let vehicle = run.zip(track.as_ref()).map(|(run, track)| (modelled(line(run, track)), run));
    let mut course = run.zip(track.as_ref()).map(|(run, track)| Course::new(run, track));
    let mut state = vehicle.as_ref().map(|(line, run)| line.start(run.start.state.clone()));
    let inputs = [ForceInput::Missing; DAMPER_SLOTS];
    measured.realtime = realtime::set_up(&options.realtime);
    if options.realtime.require && !measured.realtime.complete() {
        for line in measured.realtime.lines() {
            files::say!("real-time: {line}");
        }
        return Err(BenchError::RealtimeRefused);
    }
    let mut pacer = Pacer::new(options.rate.cycle_ns(), 1);
    'stretches: loop {
        let track = course.as_ref().map(Course::track);
        while !ticks.are_over() {
            if stop.load(Ordering::Relaxed) {
                measured.is_interrupted = true;
                measured.expected = ticks.met + ticks.skipped;
                break 'stretches;
            }
            let tick = pacer.wait();
            if !ticks.take(tick.skipped) {
                break 'stretches;
            }
            measured.lateness_ns.saturating_record(tick.lateness_ns);
            let number = ticks.met + ticks.skipped;
            done.store(number, Ordering::Relaxed);
            let mut step_ns = 0;
            if let (Some((line, _)), Some(state), Some(track)) = (&vehicle, &mut state, &track) {
                let begin_ns = now_ns();
                line.step_on(track, state, &inputs, &[None; DAMPER_SLOTS]);
                step_ns = now_ns().saturating_sub(begin_ns);
                measured.step_ns.saturating_record(step_ns);
            }
            if let Some(recorder) = &mut recorder {
                recorder.row(beside_page::row(number, tick.lateness_ns, step_ns, state.as_ref()));
            }
            let part = measured.beside_page.as_mut().and_then(|beside| beside.part(number));
            if let Some(part) = part {
                part.lateness_ns.saturating_record(tick.lateness_ns);
                part.step_ns.saturating_record(step_ns);
            }
            let Some(state) = &state else { continue };
            if course.as_ref().is_some_and(|course| course.is_passed(state)) {
                break;
            }
        }
        if ticks.are_over() {
            break;
        }
        drop(track);
        if let Some(course) = &mut course {
            course.change()?;
        }
    }
    (measured.met, measured.skipped) = (ticks.met, ticks.skipped);
    debug_assert_eq!(measured.met + measured.skipped, measured.expected, "a tick is missing");
    Ok(measured)
}

/// The line with the model of each rig in its place.
fn modelled(mut line: Line<'_>) -> Line<'_> {
    line.slots.iter_mut().for_each(Slot::use_model);
    line
}

/// The sockets on an interface.
struct Sockets {
    bus: SocketCanBus,
    echo: SocketCanBus,
}

impl Sockets {
    /// Opens them, and makes sure that no host is on the bus.
    fn open(interface: &str, profile: Profile) -> Result<Self, BenchError> {
        let all: Vec<MessageId> = MessageId::all().collect();
        let mut bus = SocketCanBus::open(interface, &all, profile)?;
        let echo = SocketCanBus::open(interface, &[MessageId::Sync], profile)?;
        match hear_host(&mut bus) {
            Some(id) => {
                let bus = BusChoice::SocketCan(interface.to_owned()).to_string();
                Err(BenchError::OtherHost { bus, id })
            }
            None => Ok(Self { bus, echo }),
        }
    }

    /// Times the answers of a rig, or of the second socket.
    fn time(&mut self, profile: Profile, ended: &AtomicBool) -> AnswerTimes {
        if let Some(node) = find_rig(&mut self.bus, profile) {
            return time_answers(&mut self.bus, None, AnsweredBy::Rig(node), profile, ended);
        }
        // What went out in search of a rig is no answer.
        while self.echo.receive().is_some() {}
        let by = AnsweredBy::Loopback;
        time_answers(&mut self.bus, Some(&mut self.echo), by, profile, ended)
    }
}
