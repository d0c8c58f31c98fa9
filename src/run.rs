//! `yawbench run`: a scenario, from its file to record, summary and report.

use crate::bench_options::{OverrideArgs, RealtimeArgs, WireArgs, slow_down};
use crate::calibration_file::CalibrationFile;
use crate::error::CommandError;
use crate::exit::{DONE, FAILED, INTERRUPTED, SAFE_STATE};
use crate::keys::Keys;
use crate::linear_vehicle::linear_vehicle;
use crate::output::{print, stem, warn};
use crate::served::served;
use crate::stop;
use crate::value::number;
use clap::{Args, ValueEnum};
use hil_host::bus::BusChoice;
use hil_host::control::{Asker, End};
use hil_host::gateway::{GatewayError, GatewayPlan, Loss, loss_lines};
use hil_host::live::{LiveAddress, RunEnd};
use hil_host::run::Finished;
use hil_host::{
    BenchError, DamperSummary, MeasuredRams, PaceChoice, RunOptions, Summary, WearSummary, run,
};
use report::{Cell, Table};
use scenario::run::{Run, SlotForce};
use std::num::NonZeroU8;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Pace {
    /// Absolute deadlines of a monotonic clock.
    Realtime,
    /// The next cycle comes when every rig has answered this one.
    Lockstep,
    /// As fast as possible, on the memory bus only.
    Fast,
}

impl From<Pace> for PaceChoice {
    fn from(pace: Pace) -> Self {
        match pace {
            Pace::Realtime => Self::Realtime,
            Pace::Lockstep => Self::Lockstep,
            Pace::Fast => Self::Fast,
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// The scenario file.
    scenario: PathBuf,
    /// Where the rigs are: memory, or socketcan:INTERFACE.
    #[arg(long, default_value_t = BusChoice::Memory)]
    bus: BusChoice,
    /// DBC of a rig that speaks its own messages, on the bus of --bus.
    #[arg(long, value_name = "FILE", requires = "dbc_map")]
    dbc: Option<PathBuf>,
    /// Which signals of that DBC are command, measurement and status.
    #[arg(long, value_name = "FILE", requires = "dbc")]
    dbc_map: Option<PathBuf>,
    /// Losses to accept, such as no-echo,no-crc: what the rig's own messages lack.
    #[arg(long, value_name = "LOSSES", value_delimiter = ',', requires = "dbc")]
    accept: Vec<Loss>,
    /// Arm rigs on a real bus without asking: for scripts on a bench that nobody stands at.
    #[arg(long)]
    arm: bool,
    /// Who sets the pace.
    #[arg(long, value_enum, default_value_t = Pace::Realtime)]
    pace: Pace,
    /// Calibration of a rig, its calibration.toml; once for each rig. Date, certificate and figures
    /// stand in run.json, summary.json and the report.
    #[arg(long, value_name = "FILE")]
    calibration: Vec<PathBuf>,
    /// Folder of the open loop, or of an earlier run, in which the delay of a rig was measured;
    /// once for each rig. Tests near the hunting frequency count. A delay that the scenario does
    /// not compensate is refused before anything is armed.
    #[arg(long, value_name = "DIR")]
    measured: Vec<PathBuf>,
    /// Age at which a calibration is called old (days).
    #[arg(long, value_name = "DAYS", default_value_t = 365.0, requires = "calibration",
        value_parser = number("an age from 0 days on", |days| days >= 0.0))]
    calibration_days: f64,
    #[command(flatten)]
    overrides: OverrideArgs,
    /// Serve a page on this machine that shows the run and can ramp it out: an address and a port
    /// such as 127.0.0.1:8080, port 0 for any.
    #[arg(long, value_name = "ADDRESS")]
    serve: Option<LiveAddress>,
    /// Folder for the files of the run [default: runs/SCENARIO-N].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace an earlier result in that folder.
    #[arg(long)]
    overwrite: bool,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    wire: WireArgs,
    /// Stretch the period by this factor, for a host that cannot hold it; the sync frame gives it
    /// to the rig.
    #[arg(long, value_name = "1..255", default_value_t = NonZeroU8::MIN, value_parser = slow_down)]
    slow_down: NonZeroU8,
    #[command(flatten)]
    realtime: RealtimeArgs,
}

/// Runs the command.
///
/// # Errors
/// Bad input, before anything is written; a bus or disk that fails; silent rigs.
pub(crate) fn command(args: &RunArgs) -> Result<ExitCode, CommandError> {
    let scenario = Run::load(&args.scenario, args.overrides.overrides())?;
    let gateway = gateway(args)?;
    refuse_without_a_rig(args, &scenario)?;
    let calibrations = calibrations(args, &scenario)?;
    let mut inputs = vec![args.scenario.clone()];
    inputs.extend([&args.dbc, &args.dbc_map].into_iter().flatten().cloned());
    inputs.extend(args.calibration.iter().chain(&args.measured).cloned());
    let options = RunOptions {
        bus: args.bus.clone(),
        gateway,
        pace: args.pace.into(),
        profile: args.wire.profile(),
        bit_rates: (args.wire.bitrate.0, args.wire.data_bitrate.0),
        slow_down: args.slow_down,
        out: args.out.clone(),
        overwrite: args.overwrite,
        inputs,
        name: stem(&args.scenario),
        calibrations,
        measured: match args.measured.as_slice() {
            [] => None,
            folders => Some(MeasuredRams::read(folders)?),
        },
        linear: if on_rigs(&scenario) { linear_vehicle(&scenario)? } else { None },
        realtime: args.realtime.options(),
    };
    let requests = stop::requests();
    let page = args.serve.map(|address| served(address, requests)).transpose()?;
    let is_on_a_bus = run::is_on_a_bus(&scenario, &args.bus);
    let keys = Keys::of_operator(requests, args.arm || !is_on_a_bus)?;
    let finished = run::run(&scenario, &options, requests, page.as_ref());
    drop(keys);
    if let (Err(why), Some(page)) = (&finished, &page) {
        page.end(ended_with(why));
    }
    let is_ended_by_operator = requests.asker().is_some_and(Asker::is_operator);
    let finished = match finished {
        Err(why) if why.is_interrupted() && is_ended_by_operator => {
            files::say!("ended before the rigs were armed: nothing is written");
            return Ok(ExitCode::SUCCESS);
        }
        finished => finished?,
    };
    let ending = Ending::of(&finished, requests.asker(), is_on_a_bus);
    if let Some(page) = &page {
        page.end(ending.on_page(&finished, &scenario));
    }
    if args.json {
        print(&serde_json::to_string_pretty(&finished.summary)?)?;
    } else {
        print(&text(&finished, &scenario))?;
    }
    let cause = finished.summary.cause.as_ref();
    if cause.is_some_and(|cause| cause.skipped_ticks > 0) {
        files::say!(
            "this host was late: `yawbench doctor` says what holds it back; --slow-down stretches \
             the period, and on the memory bus --pace fast needs no clock"
        );
    }
    if let Some(words) = &ending.words {
        files::say!("{words}");
    }
    Ok(ExitCode::from(ending.code))
}

/// What a page shows of a run that has no result.
fn ended_with(why: &BenchError) -> RunEnd {
    let words = if why.is_interrupted() {
        "The run was ended before the rigs were armed: nothing is written."
    } else {
        "The run has ended with an error."
    };
    let error = (!why.is_interrupted()).then(|| why.to_string());
    RunEnd {
        words: words.to_owned(),
        why: error,
        warnings: Vec::new(),
        files: None,
        is_good: why.is_interrupted(),
    }
}

/// How a run has ended: its exit code, and the last line on standard error.
struct Ending {
    code: u8,
    words: Option<String>,
}

impl Ending {
    fn of(finished: &Finished, asker: Option<Asker>, is_on_a_bus: bool) -> Self {
        let Finished { summary, interrupted, .. } = finished;
        let cause = summary.cause.as_ref().map_or("", |cause| cause.message.as_str());
        let said = |code, words: String| Self { code, words: Some(words) };
        // What is partly the result of a model must not look like one of the bench alone.
        let has_lost_rigs = !summary.drop_outs.is_empty();
        let done = if has_lost_rigs { FAILED } else { DONE };
        match (summary.state, interrupted) {
            (End::Safe, _) => said(
                SAFE_STATE,
                format!("ended in the safe state {cause}; rigs were brought to rest"),
            ),
            (End::RampedOut, _) => {
                said(SAFE_STATE, format!("ended early {cause}; rigs were ramped out"))
            }
            (_, true) => {
                let (code, how) = match asker {
                    Some(Asker::Key) => (done, "ended by key"),
                    Some(Asker::Page) => (done, "ended from the page"),
                    Some(Asker::Signal | Asker::Record) | None => (INTERRUPTED, "interrupted"),
                };
                said(code, format!("{how}: the files hold the run up to this point"))
            }
            _ if !summary.not_held.is_empty() && is_on_a_bus => Self { code: FAILED, words: None },
            _ => Self { code: done, words: None },
        }
    }

    /// The same on a page.
    fn on_page(&self, finished: &Finished, scenario: &Run) -> RunEnd {
        let Summary { state, not_held, .. } = &finished.summary;
        let held = if not_held.is_empty() { "completed" } else { "completed, not held" };
        let words = self.words.clone().unwrap_or_else(|| held.to_owned());
        let report = finished.folder.join("report.html").display().to_string();
        RunEnd {
            words: format!("The run has ended: {words}."),
            why: (!not_held.is_empty()).then(|| not_held.join("; ")),
            warnings: warnings(finished, scenario),
            files: Some(format!("Its report is {}.", files::quoted(&report))),
            is_good: matches!(state, End::Completed | End::Stopped) && not_held.is_empty(),
        }
    }
}

/// What a page warns of: what the terminal does, but for what the end itself says.
fn warnings(finished: &Finished, scenario: &Run) -> Vec<String> {
    let lines = lines(finished, scenario).into_iter();
    let warnings = lines.filter_map(|line| line.strip_prefix("warning: ").map(str::to_owned));
    warnings.filter(|warning| !warning.starts_with("not held: ")).collect()
}

/// What is printed of the bench and its scenario.
fn lines(finished: &Finished, scenario: &Run) -> Vec<String> {
    let mut lines = summary_lines(&finished.summary);
    lines.extend(scenario.warnings.iter().map(|warning| format!("warning: {warning}")));
    lines
}

/// What is printed of a run.
fn text(finished: &Finished, scenario: &Run) -> String {
    let mut lines = lines(finished, scenario);
    let mut files = "report.html, summary.json, record.npy, record-columns.md, bus.log, \
                     events.jsonl, run.json, scenario.toml, vehicle.toml"
        .to_owned();
    if let Some(comparison) = &finished.summary.comparison {
        lines.push(comparison.to_string().trim_end().to_owned());
        let warnings = comparison.warnings(finished.summary.state);
        lines.extend(warnings.iter().map(|warning| format!("warning: {warning}")));
        files += ", record-compared.npy";
    }
    let folder = finished.folder.display().to_string();
    lines.push(format!("files in {}: {files}", files::quoted(&folder)));
    lines.push(last_line(&finished.summary));
    lines.join("\n")
}

/// Whether any damper is on a rig.
fn on_rigs(run: &Run) -> bool {
    run.slots.iter().any(|slot| matches!(slot.force, SlotForce::Rig { .. }))
}

/// How the rigs follow, and what their delay costs: one line for each, and what to be warned of.
fn tracking_lines(dampers: &[DamperSummary]) -> Vec<String> {
    let mut lines = Vec::new();
    for damper in dampers {
        let wear = damper.virtual_wear.as_ref();
        if let Some(words) = wear.and_then(WearSummary::in_words) {
            lines.push(format!("{}: {words}", damper.name));
        }
        if let Some(warning) = wear.and_then(WearSummary::warning) {
            lines.push(format!("warning: {}: {warning}", damper.name));
        }
        let Some(tracking) = &damper.tracking else { continue };
        let measured = [("before RUN", tracking.before_run), ("in RUN", tracking.delay)];
        for (when, delay) in measured {
            let Some(delay) = delay else { continue };
            lines.push(format!("{} {when}: {}", damper.name, delay.in_words()));
        }
        if let Some(warning) = tracking.warning() {
            lines.push(format!("warning: {}: {warning}", damper.name));
        }
    }
    lines
}

/// How a rig is driven by its own messages. Where losses are not accepted, what each of them costs
/// is said first.
fn gateway(args: &RunArgs) -> Result<Option<GatewayPlan>, CommandError> {
    let (Some(dbc), Some(map)) = (&args.dbc, &args.dbc_map) else { return Ok(None) };
    let plan = GatewayPlan::read(dbc, map, &args.accept);
    if let Err(GatewayError::Unaccepted { all, .. }) = &plan {
        for line in loss_lines(all, &args.accept) {
            files::say!("{line}");
        }
    }
    Ok(Some(plan.map_err(BenchError::from)?))
}

/// The forces, strokes and work of every damper.
fn damper_table(dampers: &[DamperSummary]) -> Table {
    let table = Table::new("")
        .text("damper")
        .text("is")
        .fixed("min", "kN", 2)
        .fixed("max", "kN", 2)
        .fixed("rms", "kN", 2)
        .fixed("stroke", "mm", 2)
        .fixed("PSD", "Hz", 2)
        .fixed("work", "J/s", 1);
    table.rows(dampers.iter().map(|damper| -> [Cell; 8] {
        [
            damper.name.as_str().into(),
            damper.place.as_str().into(),
            (damper.force_n.min * 1e-3).into(),
            (damper.force_n.max * 1e-3).into(),
            (damper.force_n.rms * 1e-3).into(),
            damper.stroke_m.mean_peak.map(|peak_m| peak_m * 1e3).into(),
            damper.frequency_psd_peak_hz.into(),
            damper.work_per_s_j.into(),
        ]
    }))
}

/// The last line: frames and trajectory, measured forces that acted on several bogies, and every
/// counter that is not zero.
fn last_line(summary: &Summary) -> String {
    let frames = &summary.frames;
    let mut parts = vec![
        format!("frames sent {} received {}", frames.sent, frames.received),
        format!("trajectory {}", summary.trajectory_hash),
    ];
    parts.extend(summary.labels.iter().cloned());
    let counters = summary.counters();
    parts.push(if counters.is_empty() {
        "no faults counted".to_owned()
    } else {
        counters.join(", ")
    });
    parts.extend(summary.rounded_commands());
    parts.join(" | ")
}

fn summary_lines(summary: &Summary) -> Vec<String> {
    let mut lines = Vec::new();
    lines.push(summary.title.clone());
    lines.push(format!(
        "{} cycles of {} ms, {} | vehicle step p50 {:.1} p99 {:.1} µs | cycle p50 {:.1} p99 {:.1} \
         p99.9 {:.1} max {:.0} µs | skipped {}",
        summary.steps,
        1e3 / f64::from(summary.rate_hz),
        if summary.not_held.is_empty() { summary.state.name() } else { "completed, not held" },
        summary.step_compute_us.p50,
        summary.step_compute_us.p99,
        summary.cycle_time_us.p50,
        summary.cycle_time_us.p99,
        summary.cycle_time_us.p99_9,
        summary.cycle_time_us.max,
        summary.overruns,
    ));
    if summary.statistics_s == 0.0 {
        lines.push(format!(
            "no statistics: they begin {:.1} s after the ramps, and the run ended before",
            summary.run_in_s
        ));
    } else if !summary.damper.is_empty() {
        lines.extend(damper_table(&summary.damper).lines());
    }
    lines.extend(tracking_lines(&summary.damper));
    for damper in &summary.damper {
        let Some(stand_in) = &damper.stand_in else { continue };
        lines.push(match stand_in.warning() {
            Some(warning) => format!("warning: {}: {warning}", damper.name),
            None => format!("{}: {}", damper.name, stand_in.in_words()),
        });
    }
    let bodies = [
        ("carbody", summary.accelerations.carbody),
        ("bogie front", summary.accelerations.bogie_front),
        ("wheelset 1", summary.accelerations.wheelset_1),
    ];
    for (name, body) in bodies {
        if let Some(body) = body.filter(|_| summary.statistics_s > 0.0) {
            lines.push(format!(
                "{name:<12} lateral {:.3} vertical {:.3} m/s² rms",
                body.lateral_rms_m_per_s2, body.vertical_rms_m_per_s2
            ));
        }
    }
    lines.extend(summary.labels.iter().map(|label| format!("warning: {label}")));
    if summary.not_held.is_empty() {
        let lost = summary.drop_outs.iter();
        lines.extend(lost.map(|drop_out| format!("warning: {}", drop_out.why.message)));
    }
    let not_held = summary.not_held.iter();
    lines.extend(not_held.map(|reason| format!("warning: not held: {reason}")));
    lines.extend(summary.noted.iter().map(|noted| {
        let (first, largest) = (&noted.first, report::significant(noted.largest, 4));
        let unit = first.unit.as_deref().unwrap_or_default();
        let (message, times) = (&first.message, noted.times);
        format!("noted: {message}; {times} times, at most {largest} {unit}")
    }));
    for damper in &summary.damper {
        let (cut, flagged) = (damper.saturated_commands, damper.flagged_measurements);
        if cut.unwrap_or(0) + flagged.unwrap_or(0) > 0 {
            lines.push(format!(
                "warning: {}: {} commands cut to the frame's limits, {} measurements with a flag \
                 (limit reached, actuator lagging, saturated)",
                damper.name,
                cut.unwrap_or(0),
                flagged.unwrap_or(0)
            ));
        }
        if let Some(error) = damper.exchanged_energy_error.filter(|error| error.abs() > 0.1) {
            lines.push(format!(
                "warning: {}: exchanged energy differs by {:.0} %",
                damper.name,
                error * 100.0
            ));
        }
    }
    lines
}

/// What is known of the rigs by calibration, one line for each part; one that is old is warned of.
fn calibrations(args: &RunArgs, scenario: &Run) -> Result<Vec<String>, CommandError> {
    let nodes: Vec<u8> = nodes(scenario).collect();
    let mut lines = Vec::new();
    let mut known = Vec::new();
    for path in &args.calibration {
        let file = CalibrationFile::load(path, &nodes)?;
        if known.contains(&file.node()) {
            let found = format!("a second calibration of node {}", file.node());
            let expected = "one for each rig".to_owned();
            return Err(CommandError::Input { file: path.to_owned(), found, expected });
        }
        known.push(file.node());
        warn(&file.old(args.calibration_days));
        let node = file.node();
        lines.extend(file.lines().into_iter().map(|line| format!("node {node}: {line}")));
    }
    Ok(lines)
}

/// Numbers of the rigs of a scenario.
fn nodes(scenario: &Run) -> impl Iterator<Item = u8> {
    scenario.slots.iter().filter_map(|slot| match slot.force {
        SlotForce::Rig { node, .. } => Some(node),
        SlotForce::Modelled(_) | SlotForce::StandIn { .. } => None,
    })
}

/// What is known of a rig says nothing of a run without one.
fn refuse_without_a_rig(args: &RunArgs, scenario: &Run) -> Result<(), CommandError> {
    let calibration = args.calibration.first().map(|file| ("--calibration", file));
    let known = calibration.or(args.measured.first().map(|folder| ("--measured", folder)));
    match known {
        Some((option, path)) if nodes(scenario).next().is_none() => {
            let found = format!("{option} {}", files::quoted(&path.display().to_string()));
            Err(CommandError::option(found, "none: no damper is on a rig"))
        }
        _ => Ok(()),
    }
}
