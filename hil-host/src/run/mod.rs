//! `yawbench run`: from a scenario to a folder with record, bus log, summary and report.
//!
//! [`run`] reads from top to bottom: plan, check, open, meet, arm and record, sum up,
//! compare.

mod about;
mod handshake;
mod in_memory;
mod late_report;
mod measured_delay;
mod measured_test;
mod model_peak;
mod open_loop;
mod plan;
mod progress;
mod recording;
mod sequence;
mod setup;
mod space;
mod stability_check;
mod work;

pub use crate::page::Ending;
pub(crate) use late_report::kept_summary;
pub use late_report::{LateReport, report};
pub use measured_test::{Delay, MeasuredTest};
pub use open_loop::{OPEN_LOOP_FILES, OpenLoopPlan, OpenLoopRecord, PlannedTest, open_loop};
pub use plan::is_on_a_bus;
pub(crate) use plan::{Plan, profile_of};
pub use sequence::{Origin, on_the_way};
pub(crate) use setup::{Terms, limits, session};
pub use setup::{line, watch_of};

use crate::BenchError;
use crate::bus::{AnyBus, Bus, BusChoice, BusCounters};
use crate::comparison::{self, Cycles, SecondRun};
use crate::control::{Asker, Course, End, Requests, Session, SessionState};
use crate::gateway::GatewayPlan;
use crate::live::{Facts, LivePage, Phase, RunEnd, SlotFacts, edges_us};
use crate::options::{PaceChoice, RunOptions};
use crate::page::{SHOWN_MS, page};
use crate::realtime::{self, RealtimeOptions};
use crate::record::{
    self, ABOUT, BusEvent, PART_CYCLES, Row, RunEvent, column_reference, open_parts, part_name,
    part_of, read_events,
};
use crate::statistics::Statistics;
use crate::summary::{Outcome, Summary, labels};
pub(crate) use about::{RunAbout, check_format, read_about, read_json};
use can_protocol::Pace as WirePace;
use files::{FolderError, ResultFolder};
use handshake::{Epoch, Heard};
pub(crate) use in_memory::in_memory;
use plan::BusLoad;
use recording::{Output, Place, Recording, RunFile, Task};
use report::Section;
use scenario::run::{Run, SlotForce};
use setup::{arming, open_buses, pace};
pub(crate) use space::needed_bytes;
pub(crate) use stability_check::StabilityCheck;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;
use work::Coupled;

pub(crate) const RECORD: &str = "record.npy";
const COMPARED: &str = "record-compared.npy";
pub(crate) const LOG: &str = "bus.log";
pub(crate) const SUMMARY: &str = "summary.json";
const REPORT: &str = "report.html";
pub(crate) const SCENARIO: &str = "scenario.toml";
pub(crate) const VEHICLE: &str = "vehicle.toml";
const EVENTS: &str = "events.jsonl";
const COLUMNS: &str = "record-columns.md";

/// The files of a run.
const FILES: [&str; 10] =
    [RECORD, COMPARED, LOG, SUMMARY, REPORT, SCENARIO, VEHICLE, ABOUT, EVENTS, COLUMNS];

/// How long rigs may take to answer before a run.
const PATIENCE: Duration = Duration::from_secs(10);

/// A run that has ended, with its files.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// Its summary.
    pub summary: Summary,
    /// Where its files are.
    pub folder: PathBuf,
    /// Whether the user ended it, or the comparison behind it.
    pub interrupted: bool,
}

/// Runs a scenario.
///
/// `requests` arm it and end it early: record, summary and report hold the run up to that point,
/// and [`Finished::interrupted`] is set. A `live` page shows it.
///
/// # Errors
/// Bad input, before anything is written; rigs that do not answer; a bus or disk that fails.
pub fn run(
    run: &Run,
    options: &RunOptions,
    requests: &Requests,
    live: Option<&LivePage>,
) -> Result<Finished, BenchError> {
    let plan = Plan::new(run, &options.bus)?;
    if let Some(live) = live {
        live.begin(facts(run, options, &plan));
    }
    plan.check_rate(run.rate, options)?;
    plan.check_pace(options.pace)?;
    plan.check_gateway(options)?;
    let load = plan.load(run.rate, options)?;
    let mut folder = checked_folder(run, options, &plan)?;
    let other = run.compared(|slot| plan.is_emulated(slot))?;
    let mut buses = open_buses(run, options, &plan)?;
    // Only now: where the bus is refused, the error stands alone.
    let losses = options.gateway.iter().flat_map(GatewayPlan::loss_lines);
    for line in losses.chain(load.lines.iter().cloned()) {
        files::say!("{line}");
    }

    let track = run.track.view();
    let mut pace = pace(run.rate, options);
    let session =
        session(run, &track, &plan.rigs, terms(run, options, &plan, pace.on_the_wire())?)?;
    StabilityCheck::of(&session, run, options.linear.as_ref()).pass(plan.real_bus())?;
    let known_rams = measured_delay::pass(run, options)?;
    let mut state = session.start(session.line.start(run.start.state.clone()));
    if options.realtime.require && options.pace == PaceChoice::Realtime {
        require_realtime(options.realtime)?;
    }
    let epoch = Epoch::now();
    let enter = |phase| {
        if let Some(live) = live {
            live.enter(phase);
        }
    };
    enter(Phase::Meeting);
    let handshake = meet(&session, &mut state, &mut buses, &options.bus, epoch, requests)?;
    enter(Phase::Arming);

    let is_new = !folder.path().exists();
    let about = RunAbout::new(run, options, &session, &plan, &load, epoch.unix_ns, known_rams);
    begin(&mut folder, run, &about)?;
    let output = Output {
        place: InFolder(&folder),
        part_cycles: PART_CYCLES,
        lost_cycles_max: run.plausibility.lost_rows,
        bus_names: plan.buses.iter().map(|bus| bus.interface().to_owned()).collect(),
        epoch,
        handshake,
        feed: live.map(|live| live.feed(is_rig(run))),
    };
    let task = Task {
        session: &session,
        work: Coupled { course: Course::new(run, &track), cycles: run.cycles() },
        state: &mut state,
        buses: &mut buses,
        bus: &options.bus,
        pace: &mut pace,
        cycles: run.cycles(),
    };
    let recorded = recording::record(task, &options.realtime, output, requests);
    let recording = recorded.inspect_err(|why| clear_unbegun(&folder, is_new, why))?;
    if let Some(live) = live {
        live.end(end_of_loop(recording.end, &state));
    }
    // The recorder has counted the rows.
    let statistics = Statistics::of(&folder.file(RECORD), run.run_in_s, run.cycle_s(), |_| {})?;

    let known = (&recording, &statistics, read_events(&folder.file(EVENTS)));
    let asker = requests.asker().filter(|_| recording.end == End::Stopped);
    let mut summary = summary(run, options, &session, (&state, asker), &buses, &load, known);
    let write = |summary: &Summary, compared: Option<Section>| -> Result<(), BenchError> {
        let json = serde_json::to_string_pretty(summary)?;
        folder.write(SUMMARY, &format!("{json}\n"))?;
        let rows = around_stop(&folder.file(RECORD), summary)?;
        let seen = (&recording.counts, &statistics, &*rows);
        let page = page(run, summary, seen, &load.lines, compared, Ending::Known);
        Ok(folder.write(REPORT, &page.to_html()?)?)
    };
    let written = write(&summary, None);
    if let Some(failure) = recording.failure {
        // The cause comes first: summary and report may not have found room either.
        return Err(failure);
    }
    written?;
    let mut interrupted = recording.end == End::Stopped;
    if let (Some(setup), Some(other), false) = (&run.compare, &other, interrupted) {
        let in_folder = InFolder(&folder);
        let record = (folder.file(COMPARED), |part| in_folder.part(COMPARED, part));
        // One that left its track shows the other damper for as long as it took to stop.
        let is_safe = summary.state == End::Safe;
        let asked = if is_safe { state.line.run_cycles() } else { summary.steps };
        let cycles = Cycles { ramp_in: state.line.ramp_in_cycles, run: asked };
        match SecondRun::through(other, options.profile, cycles, record, requests.end_flag())? {
            Some(second) => {
                let main = (run, &summary, &statistics);
                let found = comparison::compare(setup, main, (other, &second));
                let records = [folder.file(RECORD), folder.file(COMPARED)];
                let section = comparison::section(run, summary.state, &found, &records)?;
                summary.comparison = Some(found);
                write(&summary, Some(section))?;
            }
            None => interrupted = true,
        }
    }
    if interrupted && run.compare.is_some() {
        files::say!("interrupted: the comparison is omitted");
    }
    Ok(Finished { summary, folder: folder.path().to_owned(), interrupted })
}

/// What the rigs are given in the handshake.
fn terms(
    run: &Run,
    options: &RunOptions,
    plan: &Plan,
    pace: WirePace,
) -> Result<Terms, BenchError> {
    // Without a clock a rig is as late as on the memory bus, bit for bit.
    let has_clock = pace == WirePace::Clock && plan.real_bus().is_some();
    let hunting_hz = options.linear.as_ref().map(|linear| linear.hunting.frequency_hz);
    Ok(Terms {
        profile: options.profile,
        pace,
        slow_down: options.slow_down,
        arming: arming(&plan.buses, run.rate, options)?,
        gate_hz: hunting_hz.filter(|_| has_clock),
        shows_progress: true,
    })
}

/// What a page shows that does not change.
fn facts(run: &Run, options: &RunOptions, plan: &Plan) -> Facts {
    let buses = plan.buses.iter().map(BusChoice::to_string);
    Facts {
        title: run.title.clone(),
        vehicle: run.vehicle_name.clone(),
        speed_kmh: run.speed_m_per_s * 3.6,
        duration_s: run.cycles() as f64 * run.cycle_s(),
        bus: buses.collect::<Vec<_>>().join(", "),
        pace: options.pace.name(),
        is_clocked: options.pace == PaceChoice::Realtime,
        slots: SlotFacts::of(run),
        warnings: run.warnings.iter().cloned().chain(labels(run)).collect(),
        edges_us: edges_us(),
    }
}

/// Whether each damper slot has a rig.
fn is_rig(run: &Run) -> Vec<bool> {
    run.slots.iter().map(|slot| matches!(slot.force, SlotForce::Rig { .. })).collect()
}

/// What a page shows while the files are being written.
fn end_of_loop(end: End, state: &SessionState) -> RunEnd {
    let words = match end {
        End::Completed => "The run is completed.",
        End::Stopped => "The run was ended early: the rigs were ramped out.",
        End::RampedOut => "A limit has ended the run: the rigs were ramped out.",
        End::Safe => "A limit has ended the run: the rigs were brought to rest.",
    };
    RunEnd {
        words: words.to_owned(),
        why: state.stop.map(|stop| stop.to_string()),
        warnings: Vec::new(),
        files: Some("Its files are being written.".to_owned()),
        is_good: matches!(end, End::Completed | End::Stopped),
    }
}

/// Makes the folder, with what is known before the first cycle.
fn begin(folder: &mut ResultFolder, run: &Run, about: &RunAbout) -> Result<(), BenchError> {
    folder.create()?;
    folder.write(SCENARIO, &run.effective.scenario)?;
    folder.write(VEHICLE, &run.effective.vehicle)?;
    folder.write(ABOUT, &format!("{}\n", serde_json::to_string_pretty(about)?))?;
    folder.write(COLUMNS, &column_reference())?;
    // A power cut leaves them too: without them a record says little.
    Ok(folder.settle()?)
}

/// Removes a new folder that holds nothing but the files of a run that has not begun.
fn clear_unbegun(folder: &ResultFolder, is_new: bool, why: &BenchError) {
    if is_new && (why.is_safe_state() || why.is_interrupted()) {
        // One that stays does no harm.
        let _stays = std::fs::remove_dir_all(folder.path());
    }
}

/// The folder of the results, with room for them.
fn checked_folder(
    run: &Run,
    options: &RunOptions,
    plan: &Plan,
) -> Result<ResultFolder, BenchError> {
    let folder =
        ResultFolder::fresh(options.out.as_deref(), &options.name, "run", options.overwrite)?;
    let names = file_names(run.cycles());
    folder.check(&names.iter().map(String::as_str).collect::<Vec<_>>())?;
    folder.refuse_inputs(options.inputs.iter().map(PathBuf::as_path))?;
    let needed = space::needed_bytes(run, plan, options.profile);
    space::check(folder.path(), folder.free_bytes(), needed, run.cycles())?;
    Ok(folder)
}

/// Names of the files that a run of so many cycles may write.
fn file_names(cycles: u64) -> Vec<String> {
    // The cycles before and after RUN are few.
    let parts = part_of(cycles, PART_CYCLES) + 1;
    let parts = (2..=parts).flat_map(|part| [RECORD, LOG, COMPARED].map(|n| part_name(n, part)));
    FILES.into_iter().map(str::to_owned).chain(parts).collect()
}

/// The folder of a run, in which its parts are made.
#[derive(Debug)]
struct InFolder<'a>(&'a ResultFolder);

impl InFolder<'_> {
    /// Makes a part, from one, of the file `first`.
    fn part(&self, first: &str, part: u64) -> io::Result<File> {
        let made = self.0.create_file(&part_name(first, part)).map_err(|why| match why {
            FolderError::Disk(_, why) => why,
            other => io::Error::other(other.to_string()),
        })?;
        self.0.settle_names()?;
        Ok(made)
    }
}

impl Place for InFolder<'_> {
    type File = File;

    fn make(&self, file: RunFile, part: u64) -> io::Result<File> {
        self.part(name_of(file), part)
    }

    fn path(&self, file: RunFile) -> PathBuf {
        self.0.file(name_of(file))
    }
}

const fn name_of(file: RunFile) -> &'static str {
    match file {
        RunFile::Record => RECORD,
        RunFile::Log => LOG,
        RunFile::Events => EVENTS,
    }
}

/// The rows around the cycle that stopped a run; none of a run that was not stopped.
fn around_stop(record: &Path, summary: &Summary) -> Result<Vec<Row>, BenchError> {
    let Some(cause) = &summary.cause else { return Ok(Vec::new()) };
    let (before, behind) = SHOWN_MS;
    let per_ms = u64::from(summary.rate_hz) / 1000;
    let (before, behind) = (before * per_ms, behind * per_ms);
    let cycles = cause.cycle.saturating_sub(before)..=cause.cycle + behind;
    let failed = |why| BenchError::File { file: record.to_owned(), why };
    let rows = record::rows_of(open_parts(record)?, cycles).map_err(failed)?;
    Ok(rows.unwrap_or_default())
}

/// Asks for the real-time set-up in a thread of its own, before anything is written.
fn require_realtime(wanted: RealtimeOptions) -> Result<(), BenchError> {
    let asked = std::thread::spawn(move || realtime::set_up(&wanted)).join();
    // An empty report would count as complete: a set-up that failed is none.
    let report = asked.map_err(|_| BenchError::Thread { name: "asks for real time" })?;
    if report.complete() {
        return Ok(());
    }
    for line in report.lines() {
        files::say!("real-time: {line}");
    }
    Err(BenchError::RealtimeRefused)
}

/// Waits for the rigs and an operator; gives the frames of the handshake.
fn meet(
    session: &Session<'_>,
    state: &mut SessionState,
    buses: &mut [AnyBus],
    bus: &BusChoice,
    epoch: Epoch,
    requests: &Requests,
) -> Result<Vec<BusEvent>, BenchError> {
    let mut heard = Heard::all(buses, epoch);
    session.meet(state, &mut heard, PATIENCE, requests).map_err(|why| why.on(bus))?;
    Ok(Heard::events(heard))
}

fn summary(
    run: &Run,
    options: &RunOptions,
    session: &Session<'_>,
    (state, asker): (&SessionState, Option<Asker>),
    buses: &[AnyBus],
    load: &BusLoad,
    (recording, statistics, events): (&Recording, &Statistics, Vec<RunEvent>),
) -> Summary {
    let outcome = Outcome {
        run,
        bus: options.bus.to_string(),
        pace: options.pace,
        end: recording.end,
        asker,
        state,
        line: &session.line,
        ports: &session.ports,
        counters: buses
            .iter()
            .map(AnyBus::counters)
            .fold(BusCounters::default(), BusCounters::plus),
        record_dropped: recording.dropped,
        wall_s: recording.wall_s,
        record_fault: recording.failure.as_ref().map(BenchError::to_string),
        events,
        bus_load: load.most,
        watched: session.watched,
        noted: session.noted(state),
        calibrations: options.calibrations.clone(),
        hunting: options.linear.as_ref().map(|linear| linear.hunting),
    };
    Summary::of(&outcome, &recording.counts, statistics)
}
