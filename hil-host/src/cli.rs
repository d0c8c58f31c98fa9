//! The command line.
//!
//! Exit codes: 0 done; 1 a check or target failed; 2 bad input, nothing written; 3 ended in the safe
//! state.

use crate::characterise::{self, CharacteriseArgs};
use crate::critical_speed::{self, CriticalSpeedArgs};
use crate::curve::{self, CurveArgs};
use crate::identify::{self, IdentifyArgs, SimulateArgs};
use crate::output::print;
use crate::realtime::RealtimeOptions;
use crate::reproduce::{self, ReproduceArgs};
use crate::ride::{self, RideArgs};
use crate::run::{self, BusChoice, PaceChoice, RunOptions, SilentRigs};
use crate::summary::Summary;
use can_protocol::{Node, Profile};
use clap::error::ErrorKind;
use clap::{Args, Parser, Subcommand, ValueEnum};
use scenario::run::{Overrides, Run};
use std::num::NonZeroU8;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A bench for railway yaw dampers that believes it is bolted under a locomotive.
#[derive(Debug, Parser)]
#[command(name = "yawbench", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scenario: the vehicle on its track, dampers modelled or on a rig.
    #[command(after_help = "Example: yawbench run scenarios/ss9-160kmh.toml --duration 10")]
    Run(RunArgs),
    /// Be the rig at the other end of a CAN bus: actuator, load cell and an emulated damper.
    #[command(
        after_help = "Example: yawbench rig scenarios/rigs/laboratory-rig.toml --bus socketcan:vcan0 --node 1"
    )]
    Rig(RigArgs),
    /// Visit a damper bench: records and figures of a damper that exists only as a model, or the
    /// figures of measured records.
    #[command(
        after_help = "Examples: yawbench characterise --physical scenarios/dampers/hydraulic-yaw-damper.toml --tests short
          yawbench characterise --from sine.csv triangle.csv --datasheet sheet.toml"
    )]
    Characterise(CharacteriseArgs),
    /// Find the effect that a damper model lacks on measured records, and add it.
    #[command(
        after_help = "Examples: yawbench identify --datasheet sheet.toml --train sine-*.csv triangle.csv --holdout service.csv
          yawbench identify --campaign 773 --seed 1 --shard 1/2 --out campaign"
    )]
    Identify(IdentifyArgs),
    /// The force of a model on a record, free-running from its displacement.
    #[command(after_help = "Example: yawbench simulate model.toml sine.csv --out predicted.csv")]
    Simulate(SimulateArgs),
    /// From which speed on does the vehicle of a scenario hunt? Its speed, track and duration do not
    /// matter.
    #[command(
        after_help = "Example: yawbench critical-speed scenarios/ss9-160kmh.toml --vary damper.ke_n_per_m=3e6:15e6:5"
    )]
    CriticalSpeed(CriticalSpeedArgs),
    /// The study of the SS9's yaw dampers, figure by figure: its numbers beside ours.
    #[command(after_help = "Examples: yawbench reproduce --figure 10a --out reproduced
          yawbench reproduce --validation")]
    Reproduce(ReproduceArgs),
    /// How does the vehicle of a scenario ride on straight track? Sperling index, mean comfort,
    /// accelerations, spectra; its layout and duration do not matter.
    #[command(
        after_help = "Example: yawbench ride scenarios/ss9-160kmh.toml --vary speed_kmh=80:180:11"
    )]
    Ride(RideArgs),
    /// How does the vehicle of a scenario go through its curve? Guiding forces, derailment, wheel load,
    /// wear, stability; its duration does not matter.
    #[command(
        after_help = "Example: yawbench curve scenarios/ss9-curve-400m.toml --vary damper.clearance_2a_m=0.5e-3,4e-3"
    )]
    Curve(CurveArgs),
}

#[derive(Debug, Args)]
struct RunArgs {
    /// The scenario file.
    scenario: PathBuf,
    /// Where the rigs are: memory, or socketcan:INTERFACE.
    #[arg(long, default_value_t = BusChoice::Memory)]
    bus: BusChoice,
    /// Who sets the pace.
    #[arg(long, value_enum, default_value_t = PaceChoice::Realtime)]
    pace: PaceChoice,
    /// Another duration (s).
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    /// Another speed (km/h).
    #[arg(long, value_name = "KMH")]
    speed_kmh: Option<f64>,
    /// Folder for the files of the run [default: runs/SCENARIO-N].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    wire: WireArgs,
    /// Stretch the period for a host that cannot hold it; the sync frame tells the rig.
    #[arg(long, value_name = "N", default_value_t = NonZeroU8::MIN)]
    slow_down: NonZeroU8,
    #[command(flatten)]
    realtime: RealtimeArgs,
}

#[derive(Debug, Args)]
struct RigArgs {
    /// The rig file; without one, a laboratory rig with a new SS9 yaw damper.
    rig: Option<PathBuf>,
    /// The bus: socketcan:INTERFACE.
    #[arg(long)]
    bus: BusChoice,
    /// Node number, 1 to 4.
    #[arg(long, default_value_t = 1)]
    node: u8,
    #[command(flatten)]
    wire: WireArgs,
    /// Exit when the host has ended its run.
    #[arg(long)]
    exit_after_run: bool,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    realtime: RealtimeArgs,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum ProfileChoice {
    /// Classical CAN, 8 bytes, 1 kHz.
    Classical,
    /// CAN FD with bit-rate switch, 16 bytes.
    Fd,
}

#[derive(Debug, Args)]
struct WireArgs {
    /// Frames on the wire.
    #[arg(long, value_enum, default_value_t = ProfileChoice::Classical)]
    profile: ProfileChoice,
    /// Bit rate, for the bus load (bit/s).
    #[arg(long, value_name = "BITS", default_value_t = 1_000_000)]
    bitrate: u32,
    /// Bit rate of the data phase, for the bus load (bit/s).
    #[arg(long, value_name = "BITS", default_value_t = 5_000_000)]
    data_bitrate: u32,
}

impl WireArgs {
    fn profile(&self) -> Profile {
        match self.profile {
            ProfileChoice::Classical => Profile::Classical,
            ProfileChoice::Fd => Profile::Fd,
        }
    }
}

#[derive(Debug, Args)]
struct RealtimeArgs {
    /// SCHED_FIFO priority of the loop; 0 leaves the scheduler alone.
    #[arg(long, value_name = "0..99", default_value_t = 80,
        value_parser = clap::value_parser!(u8).range(0..=99))]
    fifo_priority: u8,
    /// Processor for the loop.
    #[arg(long, value_name = "N")]
    cpu: Option<usize>,
    /// Fail unless the whole real-time set-up was granted.
    #[arg(long)]
    require_realtime: bool,
}

impl RealtimeArgs {
    fn options(&self) -> RealtimeOptions {
        RealtimeOptions {
            fifo_priority: (self.fifo_priority > 0).then_some(self.fifo_priority),
            cpu: self.cpu,
            require: self.require_realtime,
            ..RealtimeOptions::default()
        }
    }
}

/// Something failed that is not the input's fault.
pub(crate) const FAILED: u8 = 1;
/// Bad input.
const BAD_INPUT: u8 = 2;
/// The run ended in the safe state.
const SAFE_STATE: u8 = 3;

/// Runs the command line.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(told)
            if told.use_stderr()
                && told.kind() != ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand =>
        {
            eprintln!("{}", one_line(&told.render().to_string()));
            return ExitCode::from(BAD_INPUT);
        }
        // Help or version, on standard output.
        Err(told) => told.exit(),
    };
    let result = match &cli.command {
        Command::Run(args) => run_command(args),
        Command::Rig(args) => rig_command(args),
        Command::Characterise(args) => characterise::command(args).map(|()| ExitCode::SUCCESS),
        Command::Identify(args) => identify::command(args).map(|()| ExitCode::SUCCESS),
        Command::Simulate(args) => identify::simulate_command(args).map(|()| ExitCode::SUCCESS),
        Command::CriticalSpeed(args) => critical_speed::command(args),
        Command::Reproduce(args) => reproduce::command(args),
        Command::Ride(args) => ride::command(args),
        Command::Curve(args) => curve::command(args),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(match () {
                () if error.is::<SilentRigs>() => SAFE_STATE,
                // The run itself went on; its files could not be written.
                () if error.is::<std::io::Error>() => FAILED,
                () => BAD_INPUT,
            })
        }
    }
}

/// What clap says of an argument, in one line and without the usage behind it.
fn one_line(told: &str) -> String {
    let lines = told.lines().map(str::trim).filter(|line| !line.is_empty());
    let ours =
        lines.take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"));
    ours.collect::<Vec<_>>().join("; ").replace(":; ", ": ")
}

/// Set by Ctrl-C or a termination signal.
fn stop_signal() -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let set = Arc::clone(&stop);
    ctrlc::set_handler(move || set.store(true, Ordering::Relaxed))?;
    Ok(stop)
}

fn run_command(args: &RunArgs) -> anyhow::Result<ExitCode> {
    let overrides = Overrides { duration_s: args.duration, speed_kmh: args.speed_kmh };
    let scenario = Run::load(&args.scenario, overrides)?;
    let options = RunOptions {
        bus: args.bus.clone(),
        pace: args.pace,
        profile: args.wire.profile(),
        bit_rates: (f64::from(args.wire.bitrate), f64::from(args.wire.data_bitrate)),
        slow_down: args.slow_down,
        out: args.out.clone(),
        name: stem(&args.scenario),
        json: args.json,
        realtime: args.realtime.options(),
    };
    let stop = stop_signal()?;
    let finished = run::run(&scenario, &options, &stop)?;
    if args.json {
        print(&serde_json::to_string_pretty(&finished.summary)?)?;
    } else {
        let mut lines = summary_lines(&finished.summary);
        let mut files =
            "report.html, summary.json, record.npy, bus.log, scenario.toml, vehicle.toml"
                .to_owned();
        if let Some(comparison) = &finished.summary.comparison {
            lines.push(comparison.to_string().trim_end().to_owned());
            let warnings = comparison.warnings(&finished.summary.state);
            lines.extend(warnings.iter().map(|warning| format!("warning: {warning}")));
            files += ", record-compared.npy";
        }
        lines.push(format!("files in {}: {files}", finished.folder.display()));
        print(&lines.join("\n"))?;
    }
    Ok(if finished.summary.state == "safe" {
        eprintln!(
            "ended in the safe state: no valid force for 5 cycles, a silent rig, a bus that went \
             down, or a model that left its track; rigs were brought to rest"
        );
        ExitCode::from(SAFE_STATE)
    } else {
        ExitCode::SUCCESS
    })
}

/// The name of a file without its ending.
pub(crate) fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "run".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

fn summary_lines(summary: &Summary) -> Vec<String> {
    let mut lines = Vec::new();
    lines.push(summary.title.clone());
    lines.push(format!(
        "{} cycles of 1 ms, {} | vehicle step p50 {:.1} p99 {:.1} µs | cycle p50 {:.1} p99 {:.1} p99.9 {:.1} max {:.0} µs | skipped {}",
        summary.steps,
        summary.state,
        summary.step_compute_us.p50,
        summary.step_compute_us.p99,
        summary.cycle_time_us.p50,
        summary.cycle_time_us.p99,
        summary.cycle_time_us.p99_9,
        summary.cycle_time_us.max,
        summary.overruns,
    ));
    lines.push(format!(
        "{:<12} {:<9} {:>9} {:>9} {:>9} {:>10} {:>8} {:>9}",
        "damper", "is", "min kN", "max kN", "rms kN", "stroke mm", "PSD Hz", "work J/s"
    ));
    for damper in &summary.damper {
        lines.push(format!(
            "{:<12} {:<9} {:>9.2} {:>9.2} {:>9.2} {:>10.2} {:>8} {:>9.1}",
            damper.name,
            damper.place,
            damper.force_n.min * 1e-3,
            damper.force_n.max * 1e-3,
            damper.force_n.rms * 1e-3,
            damper.stroke_m.mean_peak.unwrap_or(0.0) * 1e3,
            damper.frequency_psd_peak_hz.map_or("-".to_owned(), |hz| format!("{hz:.2}")),
            damper.work_per_s_j,
        ));
    }
    let bodies = [
        ("carbody", summary.accelerations.carbody),
        ("bogie front", summary.accelerations.bogie_front),
        ("wheelset 1", summary.accelerations.wheelset_1),
    ];
    for (name, body) in bodies {
        if let Some(body) = body {
            lines.push(format!(
                "{name:<12} lateral {:.3} vertical {:.3} m/s² rms",
                body.lateral_rms_m_per_s2, body.vertical_rms_m_per_s2
            ));
        }
    }
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
    lines.push(format!(
        "frames sent {} received {} lost {} | trajectory {}",
        summary.frames.sent, summary.frames.received, summary.frames.lost, summary.trajectory_hash
    ));
    lines
}

fn rig_command(args: &RigArgs) -> anyhow::Result<ExitCode> {
    let BusChoice::SocketCan(interface) = &args.bus else {
        anyhow::bail!("--bus memory: a rig of its own needs socketcan:INTERFACE");
    };
    let node =
        Node::new(args.node).map_err(|error| anyhow::anyhow!("--node {}: {error}", args.node))?;
    let setup = match &args.rig {
        Some(path) => scenario::rig::RigFile::load(path)?,
        None => scenario::rig::RigFile::default_setup()?,
    };
    let stop = stop_signal()?;
    crate::rig::process::command(
        &setup,
        interface,
        node,
        args.wire.profile(),
        &crate::rig::process::Options {
            exit_after_run: args.exit_after_run,
            json: args.json,
            realtime: args.realtime.options(),
        },
        &stop,
    )
}
