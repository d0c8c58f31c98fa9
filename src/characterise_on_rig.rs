//! `yawbench characterise --bus`: the tests of a visit on a rig, in open loop.
//!
//! Nothing is coupled: the ram follows each test within limits that fit it, and no force reaches a
//! vehicle. Before it is armed, the heat of every test and the temperature that the oil will reach
//! are printed.

use crate::bench_options::{RealtimeArgs, WireArgs, slow_down};
use crate::error::CommandError;
use crate::exit::{FAILED, INTERRUPTED, SAFE_STATE};
use crate::keys::Keys;
use crate::output::print;
use crate::{output, stop};
use can_protocol::Node;
use clap::Args;
use files::ResultFolder;
use firmware_core::command::Command;
use firmware_core::damper::{Damper, DamperState, HeatBalance, Motion};
use firmware_core::supervision::CommandLimits;
use hil_host::bus::BusChoice;
use hil_host::control::End;
use hil_host::run::{
    MeasuredTest, OPEN_LOOP_FILES, OpenLoopPlan, OpenLoopRecord, PlannedTest, TRACKING,
    TrackingFile, open_loop,
};
use hil_host::{PaceChoice, RunOptions};
use measurement::mapping::{Companion, Extension};
use measurement::read_tests;
use report::{Cell, Table};
use scenario::damper::DamperFile;
use scenario::rig::{RigFile, RigSetup};
use scenario::run::{CYCLE_S, Readiness};
use scenario::source::Source;
use std::fmt::Write as _;
use std::num::NonZeroU8;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use virtual_bench::bench_visit::LABORATORY_DEGC;
use virtual_bench::bench_visit::protocol::{self, Test};
use virtual_bench::characterisation::LaboratoryFile;
use virtual_bench::laboratory::Limit;

/// The figures of a visit.
pub(crate) const LABORATORY: &str = "laboratory.json";

/// Options of a visit on a rig.
#[derive(Debug, Args)]
#[command(next_help_heading = "On a rig")]
pub(crate) struct OnRigArgs {
    /// Run the tests on the rig on this bus, in open loop: memory, or socketcan:INTERFACE.
    #[arg(long, value_name = "BUS", conflicts_with_all = ["physical", "from", "propose_mapping"])]
    pub(crate) bus: Option<BusChoice>,
    /// The emulated rig on the memory bus [default: a laboratory rig with a new SS9 yaw damper].
    #[arg(long, value_name = "FILE", requires = "bus")]
    rig: Option<PathBuf>,
    /// Arm the rig without asking: for scripts on a bench that nobody stands at.
    #[arg(long, requires = "bus")]
    arm: bool,
    /// Lock-step, without a clock; the memory bus has no clock in any case.
    #[arg(long, requires = "bus")]
    lockstep: bool,
    /// Stretch the period by this factor.
    #[arg(long, value_name = "1..255", default_value_t = NonZeroU8::MIN, value_parser = slow_down)]
    slow_down: NonZeroU8,
    /// The largest force that is believed, which the rig is asked to keep.
    #[arg(long, value_name = "KN", default_value_t = 50.0)]
    believed_kn: f64,
    /// Oil temperatures at which a test may begin, such as 18:25.
    #[arg(long, value_name = "FROM:TO", requires = "bus", value_parser = window)]
    oil_degc: Option<RangeInclusive<f64>>,
    /// What is mounted, for the records.
    #[arg(long, value_name = "NAME", requires = "bus")]
    specimen: Option<String>,
    /// How it is mounted, for the records.
    #[arg(long, value_name = "TEXT", requires = "bus")]
    orientation: Option<String>,
    #[command(flatten)]
    wire: WireArgs,
    #[command(flatten)]
    realtime: RealtimeArgs,
}

/// What of the command's other options counts on a rig.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Common<'a> {
    /// The damper that is expected, for its heat.
    pub(crate) model: Option<&'a Path>,
    pub(crate) tests: &'a [Test],
    pub(crate) node: Option<Node>,
    pub(crate) out: Option<&'a Path>,
    pub(crate) overwrite: bool,
    pub(crate) json: bool,
    pub(crate) datasheet: &'a [Limit],
}

fn window(text: &str) -> Result<RangeInclusive<f64>, String> {
    let number = |text: &str| text.parse::<f64>().ok().filter(|degc| degc.abs() <= 200.0);
    let ends = text.split_once(':').and_then(|(from, to)| number(from).zip(number(to)));
    match ends.filter(|(from, to)| to - from >= 1.0) {
        Some((from, to)) => Ok(from..=to),
        None => Err("expected FROM:TO in degrees Celsius, at least 1 K apart".to_owned()),
    }
}

/// Runs the tests on the rig.
///
/// # Errors
/// Bad input, before anything is written; a bus or a rig that does not take part; a disk that
/// fails.
pub(crate) fn command(
    args: &OnRigArgs,
    bus: &BusChoice,
    common: Common<'_>,
) -> Result<ExitCode, CommandError> {
    let rig = match &args.rig {
        Some(path) => RigFile::load(path)?,
        None => RigFile::default_setup()?,
    };
    let damper = match common.model {
        Some(path) => DamperFile::load_model(path)?.build(&Source::read(path)?)?,
        None => rig.damper.clone(),
    };
    let plan = plan(args, common, &rig)?;
    let mut folder = ResultFolder::fresh(common.out, "rig", "characterise", common.overwrite)?;
    folder.refuse_inputs(common.model.into_iter().chain(args.rig.as_deref()))?;
    let csv: Vec<String> = common.tests.iter().map(Test::csv_name).collect();
    let mappings: Vec<String> = csv.iter().map(|name| Companion::name_for(name)).collect();
    let names = csv.iter().chain(&mappings).map(String::as_str).chain(OPEN_LOOP_FILES);
    folder.check(&names.chain([LABORATORY, TRACKING]).collect::<Vec<_>>())?;
    let options = RunOptions {
        bus: bus.clone(),
        pace: pace(args, bus),
        profile: args.wire.profile(),
        bit_rates: (args.wire.bitrate.0, args.wire.data_bitrate.0),
        slow_down: args.slow_down,
        out: None,
        overwrite: common.overwrite,
        inputs: Vec::new(),
        name: "rig".to_owned(),
        linear: None,
        gateway: None,
        realtime: args.realtime.options(),
    };
    eprintln!("expected heat, from {LABORATORY_DEGC} degrees Celsius on:");
    for line in heat(&damper, common.tests, &plan).lines() {
        eprintln!("{line}");
    }
    let requests = stop::requests();
    let keys = Keys::of_operator(requests, args.arm || *bus == BusChoice::Memory)?;
    let found = open_loop(&plan, &options, &mut folder, requests)?;
    drop(keys);
    write(args, common, &folder, &found)
}

/// Real rigs have their own clock; emulated ones in memory need none.
fn pace(args: &OnRigArgs, bus: &BusChoice) -> PaceChoice {
    match bus {
        BusChoice::Memory => PaceChoice::Fast,
        BusChoice::SocketCan(_) if args.lockstep => PaceChoice::Lockstep,
        BusChoice::SocketCan(_) => PaceChoice::Realtime,
    }
}

/// The tests as commands, and limits that fit them.
fn plan<'a>(
    args: &OnRigArgs,
    common: Common<'_>,
    rig: &'a RigSetup,
) -> Result<OpenLoopPlan<'a>, CommandError> {
    if !(1.0..=100.0).contains(&args.believed_kn) {
        let found = format!("--believed-kn {}", files::number(args.believed_kn));
        return Err(CommandError::option(found, "1 to 100 kN"));
    }
    let tests: Vec<PlannedTest> = common.tests.iter().map(planned).collect();
    let (speed_m_per_s, reach_m) = protocol::reach(common.tests);
    let steps = |test: &PlannedTest| {
        let pairs = test.commands.windows(2);
        let change = |pair: &[Command]| pair[1].velocity_m_per_s - pair[0].velocity_m_per_s;
        pairs.map(|pair| change(pair).abs() / CYCLE_S).fold(0.0, f64::max)
    };
    let acceleration_m_per_s2 = tests.iter().map(steps).fold(0.0, f64::max);
    Ok(OpenLoopPlan {
        rig,
        node: common.node.unwrap_or(Node::ALL[0]),
        tests,
        limits: CommandLimits {
            stroke_m: reach_m + 5e-3,
            velocity_m_per_s: (1.1 * speed_m_per_s).max(50e-3),
            // Coming to rest behind a test takes 10 m/s2.
            acceleration_m_per_s2: (1.2 * acceleration_m_per_s2).max(12.0),
        },
        force_n: 1e3 * args.believed_kn,
        readiness: Readiness::default(),
        window_degc: args.oil_degc.clone(),
    })
}

fn planned(test: &Test) -> PlannedTest {
    let cycles = libm::floor(test.duration_s / CYCLE_S + 1e-9) as usize;
    let command = |cycle: usize| {
        let (x_m, v_m_per_s) = test.excitation.at(cycle as f64 * CYCLE_S);
        Command { displacement_m: test.mean_m + x_m, velocity_m_per_s: v_m_per_s }
    };
    PlannedTest { name: test.name.clone(), commands: (0..=cycles).map(command).collect() }
}

/// The heat of every test with the damper that is expected, and where it leads the oil.
fn heat(damper: &Damper, tests: &[Test], plan: &OpenLoopPlan<'_>) -> Table {
    let table = Table::new("")
        .text("test")
        .fixed("length", "s", 1)
        .fixed("work", "J", 0)
        .fixed("per cycle", "J", 1)
        .fixed("heat", "W", 0)
        .fixed("oil behind it", "degC", 1);
    let (damper, balance) = (damper.clone().prepared(CYCLE_S), HeatBalance::of(damper));
    let mut degc = LABORATORY_DEGC;
    let rows: Vec<[Cell; 6]> = tests
        .iter()
        .zip(&plan.tests)
        .map(|(test, planned)| {
            let work_j = work_j(&damper, &planned.commands);
            let length_s = test.duration_s;
            degc = balance.after(degc, work_j / length_s, LABORATORY_DEGC, length_s);
            let cycles = length_s * test.excitation.frequency_hz();
            let per_cycle = (cycles >= 1.0).then(|| work_j / cycles);
            [
                test.name.as_str().into(),
                length_s.into(),
                work_j.into(),
                per_cycle.into(),
                (work_j / length_s).into(),
                degc.into(),
            ]
        })
        .collect();
    table.rows(rows)
}

/// The work of a damper along a motion (J).
fn work_j(damper: &Damper, commands: &[Command]) -> f64 {
    let Some(first) = commands.first() else { return 0.0 };
    let mut state = DamperState::starting(Motion::new(first.displacement_m, 0.0));
    let steps = commands.windows(2).map(|pair| {
        let motion = Motion::new(pair[1].displacement_m, pair[1].velocity_m_per_s);
        let force_n = damper.advance(&mut state, motion, CYCLE_S);
        force_n * (pair[1].displacement_m - pair[0].displacement_m)
    });
    steps.sum()
}

/// Writes records, mappings and figures; prints them with the tracking of the rig.
fn write(
    args: &OnRigArgs,
    common: Common<'_>,
    folder: &ResultFolder,
    found: &OpenLoopRecord,
) -> Result<ExitCode, CommandError> {
    let specimen = args.specimen.as_deref().unwrap_or("specimen");
    let mut paths = Vec::new();
    for test in &found.tests {
        let name = format!("{}.csv", test.name);
        folder.write(&name, &csv(test, args))?;
        let companion = Companion {
            specimen: Some(specimen.to_owned()),
            extension: Extension::Positive,
            temperature: test.temperature_degc.is_some(),
        };
        folder.write(&Companion::name_for(&name), &companion.to_toml(&name))?;
        paths.push(folder.file(&name));
    }
    let followed = serde_json::to_string_pretty(&TrackingFile::of(&found.tests))?;
    folder.write(TRACKING, &format!("{followed}\n"))?;
    let mut lines = Vec::new();
    if paths.is_empty() {
        lines.push("no test was run to its end".to_owned());
    } else {
        let tests = read_tests(&paths, None)?;
        let file = LaboratoryFile::of_records(&paths, &tests, common.datasheet);
        let json = serde_json::to_string_pretty(&file)?;
        folder.write(LABORATORY, &format!("{json}\n"))?;
        if common.json {
            print(&json)?;
        } else {
            lines.extend(file.to_string().lines().map(str::to_owned));
        }
    }
    if !common.json {
        lines.push("\nTracking of the ram".to_owned());
        lines.extend(tracking(&found.tests).lines());
        lines.push(counted(found));
        let place = folder.path().display().to_string();
        lines.push(format!("files in {}", files::quoted(&place)));
        print(&lines.join("\n"))?;
    }
    Ok(match (found.end, &found.cause) {
        (End::Completed, _) if found.tests.len() == common.tests.len() => ExitCode::SUCCESS,
        (End::Completed, _) => {
            output::complain("tests were left out: the oil did not reach its temperatures");
            ExitCode::from(FAILED)
        }
        (End::Stopped, _) => ExitCode::from(INTERRUPTED),
        (_, cause) => {
            let message = cause.as_ref().map_or("", |cause| cause.message.as_str());
            output::complain(&format!("ended early {message}; the ram was brought to rest"));
            ExitCode::from(SAFE_STATE)
        }
    })
}

/// How well the ram has followed.
fn tracking(tests: &[MeasuredTest]) -> Table {
    let table = Table::new("")
        .text("test")
        .fixed("delay", "ms", 2)
        .fixed("rms error", "%", 2)
        .fixed("most", "mm", 3)
        .fixed("missing", "", 0);
    table.rows(tests.iter().map(|test| -> [Cell; 5] {
        [
            test.name.as_str().into(),
            (1e3 * test.delay_s).into(),
            (1e2 * test.tracking_nrmse).into(),
            (1e3 * test.tracking_most_m).into(),
            (test.missing as f64).into(),
        ]
    }))
}

fn counted(found: &OpenLoopRecord) -> String {
    let mut line = format!("frames sent {} received {}", found.bus.sent, found.bus.received);
    let counters = [
        ("ticks skipped", found.skipped),
        ("commands limited", found.limited),
        ("rows and frames not recorded", found.unrecorded),
        ("frames dropped", found.bus.send_dropped + found.bus.receive_dropped),
    ];
    for (what, count) in counters.into_iter().filter(|(_, count)| *count > 0) {
        // Writing to a string cannot fail.
        let _ = write!(line, ", {count} {what}");
    }
    line
}

/// The record of a test. What is mounted and how stands above its columns.
fn csv(test: &MeasuredTest, args: &OnRigArgs) -> String {
    let mut text = String::new();
    let about = [("specimen", &args.specimen), ("orientation", &args.orientation)];
    for (what, value) in about {
        if let Some(value) = value {
            let _ = writeln!(text, "# {what}: {}", files::quoted(value));
        }
    }
    let degc = test.temperature_degc.as_deref();
    let temperature = if degc.is_some() { ",temperature_degc" } else { "" };
    let _ = writeln!(text, "time_s,displacement_m,force_n{temperature},cycle");
    for (row, cycle) in test.cycles.iter().enumerate() {
        let (time_s, x_m, force_n) =
            (test.time_s[row], test.displacement_m[row], test.force_n[row]);
        let _ = write!(text, "{time_s:.3},{x_m:.9},{force_n:.3}");
        if let Some(degc) = degc.and_then(|degc| degc.get(row)) {
            let _ = write!(text, ",{degc:.2}");
        }
        let _ = writeln!(text, ",{cycle}");
    }
    text
}
