//! `yawbench run`: from a scenario file to a folder with record, bus log, summary and report.

use crate::bus::{Bus, BusCounters, MemoryBus, Sent, SocketCanBus, WireFrame};
use crate::clock::Pacer;
use crate::columns::{Columns, Watched};
use crate::comparison::{self, Comparison, SecondRun};
use crate::control::watch::Watch;
use crate::control::{End, Pace, Port, Session, SessionState};
use crate::page::page;
use crate::realtime::{self, RealtimeOptions};
use crate::record::{Batch, BusEvent, BusLog, NpyWriter, Queues, RunFolder};
use crate::rig::RigNode;
use crate::summary::{Outcome, Summary};
use anyhow::{Context, bail};
use can_protocol::{BusPlan, Frame, MessageId, Node, Profile, Sender, Verdict};
use crossbeam_channel::{Receiver, bounded};
use firmware_core::compensation::VirtualWear;
use firmware_core::guard::Guard;
use firmware_core::line::{Line, Slot};
use firmware_core::track::Track;
use firmware_core::vehicle::DAMPER_SLOTS;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use scenario::run::{CYCLE_S, Run, SlotForce};
use std::fmt::Write as _;
use std::num::NonZeroU8;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Where the rigs are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BusChoice {
    /// Emulated rigs in this process.
    Memory,
    /// A CAN interface.
    SocketCan(String),
}

impl std::str::FromStr for BusChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            None if text == "memory" => Ok(Self::Memory),
            Some(("socketcan", name)) if !name.is_empty() => Ok(Self::SocketCan(name.to_owned())),
            _ => Err(format!("found \"{text}\", expected memory or socketcan:INTERFACE")),
        }
    }
}

impl std::fmt::Display for BusChoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Memory => f.write_str("memory"),
            Self::SocketCan(name) => write!(f, "socketcan:{name}"),
        }
    }
}

/// Who sets the pace.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum PaceChoice {
    /// Absolute deadlines of a monotonic clock.
    Realtime,
    /// The next cycle comes when every rig has answered this one.
    Lockstep,
    /// As fast as possible, on the memory bus only.
    Fast,
}

impl PaceChoice {
    const fn name(self) -> &'static str {
        match self {
            Self::Realtime => "realtime",
            Self::Lockstep => "lockstep",
            Self::Fast => "fast",
        }
    }
}

/// What a run is told beside its scenario.
#[derive(Debug, Clone, PartialEq)]
pub struct RunOptions {
    /// The bus of all slots that do not name their own.
    pub bus: BusChoice,
    /// The pace.
    pub pace: PaceChoice,
    /// The profile on the wire.
    pub profile: Profile,
    /// Bit rates, nominal and data (bit/s).
    pub bit_rates: (f64, f64),
    /// How many times longer a cycle is on the wall.
    pub slow_down: NonZeroU8,
    /// Where to write.
    pub out: Option<PathBuf>,
    /// Name for the default folder.
    pub name: String,
    /// Real-time set-up.
    pub realtime: RealtimeOptions,
}

/// A bus of either kind.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "at most four, made once")]
enum AnyBus {
    Memory(MemoryBus),
    SocketCan(SocketCanBus),
}

impl Bus for AnyBus {
    fn send(&mut self, frame: &Frame) -> Sent {
        match self {
            Self::Memory(bus) => bus.send(frame),
            Self::SocketCan(bus) => bus.send(frame),
        }
    }
    fn receive(&mut self) -> Option<WireFrame> {
        match self {
            Self::Memory(bus) => bus.receive(),
            Self::SocketCan(bus) => bus.receive(),
        }
    }
    fn wait(&mut self, timeout: Duration) -> bool {
        match self {
            Self::Memory(bus) => bus.wait(timeout),
            Self::SocketCan(bus) => bus.wait(timeout),
        }
    }
    fn counters(&self) -> BusCounters {
        match self {
            Self::Memory(bus) => bus.counters(),
            Self::SocketCan(bus) => bus.counters(),
        }
    }
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// Its summary.
    pub summary: Summary,
    /// Where its files are.
    pub folder: PathBuf,
}

/// Where the rig of a slot is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RigPlace {
    slot: usize,
    pub(crate) node: Node,
    /// Number of its bus in the list of choices.
    bus: usize,
}

/// All buses that the scenario names, and where each rig is.
pub(crate) fn rigs_of(
    run: &Run,
    default: &BusChoice,
) -> anyhow::Result<(Vec<BusChoice>, Vec<RigPlace>)> {
    let mut choices: Vec<BusChoice> = Vec::new();
    let mut rigs = Vec::new();
    for (slot, place) in run.slots.iter().enumerate() {
        let SlotForce::Rig { node, bus, .. } = &place.force else { continue };
        let choice = match bus {
            Some(text) => text
                .parse()
                .map_err(|error| anyhow::anyhow!("slot \"{}\": bus: {error}", place.place))?,
            None => default.clone(),
        };
        let number = choices.iter().position(|known| *known == choice).unwrap_or_else(|| {
            choices.push(choice);
            choices.len() - 1
        });
        rigs.push(RigPlace { slot, node: Node::new(*node)?, bus: number });
    }
    Ok((choices, rigs))
}

/// Runs a scenario.
///
/// # Errors
/// Bad input, before anything is written; or a bus or disk that fails.
pub fn run(run: &Run, options: &RunOptions, stop: &AtomicBool) -> anyhow::Result<Finished> {
    let (choices, rigs) = rigs_of(run, &options.bus)?;
    if options.pace == PaceChoice::Fast && choices.iter().any(|choice| *choice != BusChoice::Memory)
    {
        bail!("pace fast runs on the memory bus only: on a CAN bus take lockstep or realtime");
    }
    let (plan_lines, load) = bus_plan(options, &choices, &rigs)?;
    for line in &plan_lines {
        eprintln!("{line}");
    }
    let in_memory = |rig: &RigPlace| choices.get(rig.bus) == Some(&BusChoice::Memory);
    let other = run.compared(|slot| rigs.iter().any(|rig| rig.slot == slot && in_memory(rig)))?;
    let mut buses = open_buses(run, options, &choices, &rigs)?;

    let track = run.track.view();
    let session = session(run, &track, &rigs, options.profile, options.slow_down)?;
    let mut state = session.start(session.line.start(run.start.state.clone()));

    let period_ns = (CYCLE_S * 1e9) as u64;
    let mut pace = match options.pace {
        PaceChoice::Realtime => {
            Pace::Realtime(Pacer::new(period_ns, u32::from(options.slow_down.get())))
        }
        PaceChoice::Lockstep => Pace::LockStep,
        PaceChoice::Fast => Pace::Fast,
    };
    if options.realtime.require && options.pace == PaceChoice::Realtime {
        // Asked in a thread of its own, before anything is written.
        let wanted = options.realtime;
        let report = std::thread::spawn(move || realtime::set_up(&wanted)).join();
        // An empty report would count as complete: a set-up that failed is none.
        let Ok(report) = report else { bail!("--require-realtime: the set-up failed") };
        if !report.complete() {
            for line in report.lines() {
                eprintln!("real-time: {line}");
            }
            bail!("--require-realtime: not everything was granted");
        }
    }
    if let Err(silent) = session.greet(&state, &mut buses, &pace, Duration::from_secs(10)) {
        bail!(SilentRigs(format!(
            "no answer from rig node {} on {} within 10 s; is `yawbench rig` running there?",
            silent.iter().map(u8::to_string).collect::<Vec<_>>().join(", "),
            options.bus
        )));
    }

    let folder = RunFolder::choose(options.out.as_deref(), &options.name);
    folder.create()?;
    let recording = record(
        &session,
        &mut state,
        &mut buses,
        &mut pace,
        run,
        &options.realtime,
        &folder,
        &choices,
        stop,
    )?;
    let counters = buses.iter().map(AnyBus::counters).fold(BusCounters::default(), sum);
    let outcome = Outcome {
        run,
        bus: options.bus.to_string(),
        pace: options.pace.name(),
        end: recording.end,
        state: &state,
        ports: &session.ports,
        counters,
        record_dropped: recording.dropped,
        wall_s: recording.wall_s,
        bus_load: load,
        watched: session.watched,
    };
    let mut summary = Summary::of(&outcome, &recording.columns);
    let leave = |summary: &Summary, compared| -> anyhow::Result<()> {
        let json = serde_json::to_string_pretty(summary)?;
        std::fs::write(folder.file("summary.json"), format!("{json}\n"))?;
        let page = page(run, summary, &recording.columns, &plan_lines, compared);
        Ok(page.write_to(folder.file("report.html"))?)
    };
    std::fs::write(folder.file("scenario.toml"), &run.effective.scenario)?;
    std::fs::write(folder.file("vehicle.toml"), &run.effective.vehicle)?;
    leave(&summary, None)?;
    if let (Some(setup), Some(other)) = (&run.compare, &other) {
        // Whoever stopped the run wants what there is of it, compared; a second time stops this too.
        stop.store(false, Ordering::Relaxed);
        let record = folder.file("record-compared.npy");
        match SecondRun::through(other, options.profile, summary.steps, &record, stop)? {
            Some(second) => {
                let main = (run, &summary, &recording.columns);
                let found = Comparison::of(setup, main, (other, &second));
                let section =
                    comparison::section(run, &summary.state, &recording.columns, &found, &second);
                summary.comparison = Some(found);
                leave(&summary, Some(section))?;
            }
            None => eprintln!("the comparison was stopped and is left out"),
        }
    }
    Ok(Finished { summary, folder: folder.path().to_owned() })
}

/// The control session of a scenario with its rigs.
pub(crate) fn session<'a>(
    run: &'a Run,
    track: &'a Track<'a>,
    rigs: &[RigPlace],
    profile: Profile,
    slow_down: NonZeroU8,
) -> Result<Session<'a>, can_protocol::Error> {
    let port = |rig: &RigPlace| {
        let port = Port::new(rig.node, rig.bus, rig.slot, profile)?;
        Ok(match watch_of(run, rig.slot) {
            Some(watch) => port.watched(watch),
            None => port,
        })
    };
    let body = |name: &str| run.body_names.iter().position(|body| body == name);
    Ok(Session {
        line: line(run, track),
        ports: rigs.iter().map(port).collect::<Result<_, can_protocol::Error>>()?,
        profile,
        slow_down,
        watched: [body("carbody"), body("bogie_front"), body("wheelset_1")],
    })
}

/// The line of a scenario: the vehicle on its track with its damper slots.
#[expect(clippy::large_stack_arrays, reason = "made once, before the loop")]
pub fn line<'a>(run: &'a Run, track: &'a Track<'a>) -> Line<'a> {
    let substep_s = CYCLE_S / f64::from(run.substeps);
    let mut slots = [const { Slot::Empty }; DAMPER_SLOTS];
    for (slot, place) in slots.iter_mut().zip(&run.slots) {
        *slot = match &place.force {
            SlotForce::Modelled(damper) => Slot::Modelled(damper.clone().prepared(substep_s)),
            SlotForce::Rig { virtual_clearance_2a_m, virtual_compliance_m_per_n, .. } => {
                Slot::Rig(VirtualWear {
                    clearance_2a_m: *virtual_clearance_2a_m,
                    compliance_m_per_n: *virtual_compliance_m_per_n,
                    ..VirtualWear::default()
                })
            }
        };
    }
    Line {
        vehicle: &run.vehicle,
        track,
        contact: run.contact.as_ref().map(|contact| &*contact.table),
        speed_m_per_s: run.speed_m_per_s,
        cycle_s: CYCLE_S,
        substeps: run.substeps,
        slots,
        guard: Guard::default(),
    }
}

/// The watch over the rig of a slot.
pub fn watch_of(run: &Run, slot: usize) -> Option<Watch> {
    match run.slots.get(slot).map(|slot| &slot.force) {
        Some(SlotForce::Rig { watch: Some(watch), .. }) => Some(Watch::new(watch)),
        _ => None,
    }
}

/// Rigs that never answered: an end in the safe state, not bad input.
#[derive(Debug)]
pub struct SilentRigs(pub String);

impl std::fmt::Display for SilentRigs {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for SilentRigs {}

fn sum(a: BusCounters, b: BusCounters) -> BusCounters {
    BusCounters {
        sent: a.sent + b.sent,
        received: a.received + b.received,
        send_dropped: a.send_dropped + b.send_dropped,
        receive_dropped: a.receive_dropped + b.receive_dropped,
        error_frames: a.error_frames + b.error_frames,
    }
}

/// Works the bus load out before the run; too much is refused.
fn bus_plan(
    options: &RunOptions,
    choices: &[BusChoice],
    rigs: &[RigPlace],
) -> anyhow::Result<(Vec<String>, f64)> {
    let mut lines = Vec::new();
    let mut most = 0.0f64;
    for (number, choice) in choices.iter().enumerate() {
        let plan = BusPlan {
            profile: options.profile,
            rigs: rigs.iter().filter(|rig| rig.bus == number).count() as u8,
            rate_hz: 1.0 / (CYCLE_S * f64::from(options.slow_down.get())),
            nominal_bits_per_s: options.bit_rates.0,
            data_bits_per_s: options.bit_rates.1,
        };
        most = most.max(plan.cyclic_load());
        let mut line = format!("bus {choice}: {plan}");
        match plan.verdict() {
            Verdict::Accept => {}
            Verdict::Warn => line += " - warning: above 50 %, a retransmission may delay a cycle",
            Verdict::Refuse => bail!(
                "bus {choice}: load {:.0} %, at most 80 %: take --profile fd, or several buses",
                plan.cyclic_load() * 100.0
            ),
        }
        lines.push(line);
    }
    Ok((lines, most))
}

fn open_buses(
    run: &Run,
    options: &RunOptions,
    choices: &[BusChoice],
    rigs: &[RigPlace],
) -> anyhow::Result<Vec<AnyBus>> {
    let mut buses = Vec::new();
    for (number, choice) in choices.iter().enumerate() {
        let nodes = rigs.iter().filter(|rig| rig.bus == number).map(|rig| rig.node);
        buses.push(match choice {
            BusChoice::Memory => AnyBus::Memory(MemoryBus::new(
                nodes.map(|node| RigNode::new(&run.rig, node, options.profile)),
            )),
            BusChoice::SocketCan(name) => {
                let accept: Vec<MessageId> = nodes
                    .flat_map(|node| {
                        [
                            MessageId::Measurement(options.profile, node),
                            MessageId::Fault(Sender::Rig(node)),
                            MessageId::Telemetry(node),
                            MessageId::Heartbeat(Sender::Rig(node)),
                        ]
                    })
                    .collect();
                AnyBus::SocketCan(SocketCanBus::open(name, &accept, options.profile)?)
            }
        });
    }
    Ok(buses)
}

/// What came out of the loop.
struct Recording {
    end: End,
    columns: Columns,
    dropped: u64,
    wall_s: f64,
}

#[expect(clippy::too_many_arguments, reason = "one call, one place")]
fn record(
    session: &Session<'_>,
    state: &mut SessionState,
    buses: &mut [AnyBus],
    pace: &mut Pace,
    run: &Run,
    realtime_options: &RealtimeOptions,
    folder: &RunFolder,
    choices: &[BusChoice],
    stop: &AtomicBool,
) -> anyhow::Result<Recording> {
    let now_ns = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_nanos() as u64);
    let names = choices
        .iter()
        .map(|choice| match choice {
            BusChoice::Memory => "memory".to_owned(),
            BusChoice::SocketCan(name) => name.clone(),
        })
        .collect();
    let mut record = NpyWriter::create(&folder.file("record.npy"))?;
    let mut log = BusLog::create(&folder.file("bus.log"), now_ns, names)?;
    let mut queues = Queues::default();
    let (mut recorder, drain) = queues.split();
    let done = AtomicBool::new(false);
    let begin = Instant::now();
    let (cycles, speed_kmh) = (run.cycles(), run.speed_m_per_s * 3.6);
    std::thread::scope(|scope| {
        let (to_file, file_rows) = bounded::<Batch>(64);
        let (to_watch, watch_rows) = bounded::<Batch>(64);
        let (to_log, log_events) = bounded::<Vec<BusEvent>>(64);
        let rows = [to_file, to_watch];
        let done = &done;
        scope.spawn(move || drain.run(done, &rows, &to_log));
        // A file that cannot be written ends the run: a bench is not driven without its record.
        let stop_on = |error| {
            stop.store(true, Ordering::Relaxed);
            Err(error)
        };
        let file = scope.spawn(move || -> std::io::Result<u64> {
            for batch in file_rows {
                record.write(&batch).or_else(stop_on)?;
            }
            record.finish()
        });
        let log = scope.spawn(move || -> std::io::Result<()> {
            for events in log_events {
                log.write(&events).or_else(stop_on)?;
            }
            log.finish()
        });
        let watch = scope.spawn(move || watch(&watch_rows, cycles, speed_kmh));

        // After the other threads have started: they must not inherit the loop's processor.
        if let Pace::Realtime(_) = pace {
            for line in realtime::set_up(realtime_options).lines() {
                eprintln!("real-time: {line}");
            }
        }
        let end = session.run(state, buses, pace, cycles, &mut recorder, stop);
        let wall_s = begin.elapsed().as_secs_f64();
        let dropped = recorder.dropped_rows + recorder.dropped_events;
        done.store(true, Ordering::Release);
        let lost = "a recorder thread failed";
        file.join().map_err(|_| anyhow::anyhow!(lost))?.context("record.npy")?;
        log.join().map_err(|_| anyhow::anyhow!(lost))?.context("bus.log")?;
        let columns = watch.join().map_err(|_| anyhow::anyhow!(lost))?;
        Ok(Recording { end, columns, dropped, wall_s })
    })
}

/// What the watches over the rigs say, for the line of progress.
fn watch_words(watched: &[Watched]) -> String {
    let mut words = String::new();
    for (slot, watched) in watched.iter().enumerate().filter(|(_, watched)| watched.verdict > 1) {
        let drift = if watched.verdict == 3 { " DRIFT" } else { "" };
        // Writing to a string cannot fail.
        let _ = write!(words, "  residual {} {:.0} N{drift}", slot + 1, watched.rms_n);
    }
    words
}

/// Collects the columns and shows progress.
fn watch(rows: &Receiver<Batch>, cycles: u64, speed_kmh: f64) -> Columns {
    let mut columns = Columns::default();
    let bar = ProgressBar::with_draw_target(Some(cycles), ProgressDrawTarget::stderr_with_hz(10));
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}") {
        bar.set_style(style);
    }
    let mut shown = Instant::now();
    for batch in rows {
        for row in batch.iter() {
            columns.push(row);
        }
        let Some(row) = batch.last() else { continue };
        if shown.elapsed() > Duration::from_millis(100) {
            shown = Instant::now();
            bar.set_position(row.cycle);
            let stale: u64 = columns.stale.iter().sum();
            bar.set_message(format!(
                "{:6.1} s {speed_kmh:3.0} km/h {:7.0} m  stroke {:6.2} mm  force {:6.1} kN  cycle p50 {:.0} p99 {:.0} µs  lost {stale}{}",
                row.time_s,
                row.distance_m,
                row.extension_m[0] * 1e3,
                row.force_n[0] * 1e-3,
                crate::summary::at(&columns.cycle_ns, 0.5),
                crate::summary::at(&columns.cycle_ns, 0.99),
                watch_words(&columns.watch),
            ));
        }
    }
    bar.finish_and_clear();
    columns
}
