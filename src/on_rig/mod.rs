//! `yawbench characterise --bus`: a rig in open loop.
//!
//! Nothing is coupled: the ram follows a motion within limits that fit it, and no force reaches a
//! vehicle. There is one task at a time:
//!
//! | option | task |
//! | --- | --- |
//! | `--tests` | the tests of a visit ([`visit`]) |
//! | `--play` | the motion of a record ([`play`]) |
//! | `--jog`, `--warm-up` | a way that the ram rests behind; warm oil and nothing else ([`moves`]) |
//! | `--calibrate` | a rigid bar, a dry run, or the gain of the load cell ([`calibrate`]) |

mod calibrate;
mod moves;
mod play;
mod records;
mod tracking;
mod visit;

use crate::bench_options::{RealtimeArgs, WireArgs, slow_down};
use crate::calibration_file::CalibrationFile;
use crate::error::CommandError;
use crate::exit::{INTERRUPTED, SAFE_STATE};
use crate::keys::Keys;
use crate::value::number;
use crate::{output, stop};
use calibrate::CalibrateArgs;
use can_protocol::Node;
use clap::Args;
use files::ResultFolder;
use firmware_core::supervision::CommandLimits;
use hil_host::bus::BusChoice;
use hil_host::control::End;
use hil_host::run::{
    OPEN_LOOP_FILES, OpenLoopPlan, OpenLoopRecord, Origin, PlannedTest, open_loop,
};
use hil_host::{PaceChoice, RunOptions};
use play::PlayArgs;
use records::About;
use scenario::rig::{RigFile, RigSetup};
use scenario::run::{CYCLE_S, Readiness};
use std::num::NonZeroU8;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use virtual_bench::bench_visit::protocol::Test;
use virtual_bench::laboratory::Limit;

pub(crate) use records::LABORATORY;

/// Options of a rig in open loop.
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
    /// No tests: move the ram by this much at 5 mm/s, and leave it there.
    #[arg(long, value_name = "MM", requires = "bus",
        conflicts_with_all = ["tests", "play", "warm_up", "calibrate", "oil_degc"],
        value_parser = number("a way from -100 to 100 mm", |mm| mm.abs() <= 100.0))]
    jog: Option<f64>,
    /// No tests: stroke the damper until its oil is as warm as this.
    #[arg(long, value_name = "DEGC", requires = "bus",
        conflicts_with_all = ["tests", "play", "calibrate", "oil_degc"],
        value_parser = number("a temperature from -40 to 120 degrees Celsius",
            |degc| (-40.0..=120.0).contains(&degc)))]
    warm_up: Option<f64>,
    /// The calibration of this rig, a calibration.toml: its date, certificate and figures go into
    /// the records, and no force is corrected by it.
    #[arg(long, value_name = "FILE", requires = "bus")]
    calibration: Option<PathBuf>,
    /// Age at which a calibration is called old (days).
    #[arg(long, value_name = "DAYS", default_value_t = 365.0, requires = "calibration",
        value_parser = number("a number of days from 1 to 3650", |days| (1.0..=3650.0).contains(&days)))]
    calibration_days: f64,
    #[command(flatten)]
    play: PlayArgs,
    #[command(flatten)]
    calibrate: CalibrateArgs,
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
    /// Columns of the record that is played.
    pub(crate) mapping: Option<&'a Path>,
    /// Reads the record of a run that is played.
    pub(crate) reader: &'a dyn measurement::RecordReader,
    pub(crate) tests: &'a [Test],
    pub(crate) node: Option<Node>,
    pub(crate) out: Option<&'a Path>,
    pub(crate) overwrite: bool,
    pub(crate) json: bool,
    pub(crate) datasheet: &'a [Limit],
}

impl OnRigArgs {
    /// Whether a record is played.
    pub(crate) const fn plays(&self) -> bool {
        self.play.file.is_some()
    }
}

fn window(text: &str) -> Result<RangeInclusive<f64>, String> {
    let number = |text: &str| text.parse::<f64>().ok().filter(|degc| degc.abs() <= 200.0);
    let ends = text.split_once(':').and_then(|(from, to)| number(from).zip(number(to)));
    match ends.filter(|(from, to)| to - from >= 1.0) {
        Some((from, to)) => Ok(from..=to),
        None => Err("expected FROM:TO in degrees Celsius, at least 1 K apart".to_owned()),
    }
}

/// Runs the task on the rig.
///
/// # Errors
/// Bad input, before anything is written; a bus or a rig that does not take part; a disk that
/// fails.
pub(crate) fn command(
    args: &OnRigArgs,
    bus: &BusChoice,
    common: Common<'_>,
) -> Result<ExitCode, CommandError> {
    if !(1.0..=100.0).contains(&args.believed_kn) {
        let found = format!("--believed-kn {}", files::number(args.believed_kn));
        return Err(CommandError::option(found, "1 to 100 kN"));
    }
    let rig = match &args.rig {
        Some(path) => RigFile::load(path)?,
        None => RigFile::default_setup()?,
    };
    let node = common.node.unwrap_or(Node::ALL[0]);
    let load = |path| CalibrationFile::load(path, &[node.number()]);
    let calibration = args.calibration.as_deref().map(load).transpose()?;
    if let Some(calibration) = &calibration {
        output::warn(&calibration.old(args.calibration_days));
    }
    let bench = Bench { args, bus, common, rig, calibration };
    match (args.jog, args.warm_up) {
        (Some(jog_mm), _) => moves::jog(&bench, 1e-3 * jog_mm),
        (_, Some(degc)) => moves::warm_up(&bench, degc),
        (None, None) if args.calibrate.is_given() => calibrate::calibrate(bench),
        (None, None) if args.plays() => play::play(&bench),
        (None, None) => visit::visit(&bench),
    }
}

/// A rig on a bus, and what is asked of it.
struct Bench<'a> {
    args: &'a OnRigArgs,
    bus: &'a BusChoice,
    common: Common<'a>,
    rig: RigSetup,
    calibration: Option<CalibrationFile>,
}

impl Bench<'_> {
    /// The node of the rig.
    fn node(&self) -> Node {
        self.common.node.unwrap_or(Node::ALL[0])
    }

    /// Tests about mid-stroke, with limits that fit them.
    fn plan(&self, tests: Vec<PlannedTest>) -> OpenLoopPlan<'_> {
        let window_degc = self.args.oil_degc.clone();
        let limits = limits(&tests, window_degc.is_some());
        OpenLoopPlan {
            rig: &self.rig,
            node: self.node(),
            tests,
            limits,
            force_n: 1e3 * self.args.believed_kn,
            readiness: Readiness::default(),
            window_degc,
            origin: Origin::MidStroke,
            returns: true,
            needs_its_limits: true,
        }
    }

    /// The folder of the result, which holds no file that is read: neither the record that is
    /// played nor one of the options.
    fn folder(
        &self,
        record: Option<&Path>,
        names: &[String],
    ) -> Result<ResultFolder, CommandError> {
        let Common { out, overwrite, model, mapping, .. } = self.common;
        let folder = ResultFolder::fresh(out, "rig", "characterise", overwrite)?;
        let options = [model, mapping, self.args.rig.as_deref(), self.args.calibration.as_deref()];
        folder.refuse_inputs(options.into_iter().chain([record]).flatten())?;
        let names = names.iter().map(String::as_str).chain(OPEN_LOOP_FILES);
        folder.check(&names.collect::<Vec<_>>())?;
        Ok(folder)
    }

    /// Runs a plan on the rig, once an operator or a script has armed it.
    fn conduct(
        &self,
        plan: &OpenLoopPlan<'_>,
        folder: &mut ResultFolder,
    ) -> Result<OpenLoopRecord, CommandError> {
        let args = self.args;
        let options = RunOptions {
            bus: self.bus.clone(),
            pace: self.pace(),
            profile: args.wire.profile(),
            bit_rates: (args.wire.bitrate.0, args.wire.data_bitrate.0),
            slow_down: args.slow_down,
            out: None,
            overwrite: self.common.overwrite,
            inputs: Vec::new(),
            name: "rig".to_owned(),
            calibrations: Vec::new(),
            measured: None,
            linear: None,
            gateway: None,
            realtime: args.realtime.options(),
        };
        let requests = stop::requests();
        let keys = Keys::of_operator(requests, args.arm || *self.bus == BusChoice::Memory)?;
        let found = open_loop(plan, &options, folder, requests)?;
        drop(keys);
        Ok(found)
    }

    /// Real rigs have their own clock; emulated ones in memory need none.
    fn pace(&self) -> PaceChoice {
        match self.bus {
            BusChoice::Memory => PaceChoice::Fast,
            BusChoice::SocketCan(_) if self.args.lockstep => PaceChoice::Lockstep,
            BusChoice::SocketCan(_) => PaceChoice::Realtime,
        }
    }

    /// What the mappings of all records say.
    fn about(&self) -> About<'_> {
        About {
            specimen: self.args.specimen.as_deref(),
            orientation: self.args.orientation.as_deref(),
            calibration: self.calibration.as_ref(),
        }
    }
}

/// Limits of the commands: what the tests take, and a little to spare.
fn limits(tests: &[PlannedTest], warms_oil: bool) -> CommandLimits {
    let commands = || tests.iter().flat_map(|test| &test.commands);
    let pairs = || tests.iter().flat_map(|test| test.commands.windows(2));
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |a, b| a.max(b.abs()));
    let reach_m = most(&mut commands().map(|command| command.displacement_m));
    let speed_m_per_s = most(&mut commands().map(|command| command.velocity_m_per_s));
    let steps = &mut pairs().map(|pair| pair[1].velocity_m_per_s - pair[0].velocity_m_per_s);
    let acceleration_m_per_s2 = most(steps) / CYCLE_S;
    CommandLimits {
        // Oil is warmed by strokes of 10 mm from where a test begins.
        stroke_m: reach_m + if warms_oil { 15e-3 } else { 5e-3 },
        velocity_m_per_s: (1.1 * speed_m_per_s).max(50e-3),
        // Coming to rest behind a test takes 10 m/s2.
        acceleration_m_per_s2: (1.2 * acceleration_m_per_s2).max(12.0),
    }
}

/// The exit code of an end that no task decides about, with its message; none of a whole sequence.
fn ended_early(found: &OpenLoopRecord) -> Option<ExitCode> {
    match (found.end, &found.cause) {
        (End::Completed, _) => None,
        (End::Stopped, _) => Some(ExitCode::from(INTERRUPTED)),
        (_, cause) => {
            let message = cause.as_ref().map_or("", |cause| cause.message.as_str());
            output::complain(&format!("ended early {message}; the ram was brought to rest"));
            Some(ExitCode::from(SAFE_STATE))
        }
    }
}
