//! The command line: one file per subcommand; each parses, calls and prints.
//!
//! Every command returns an exit code ([`exit`]) or an [`error`] that has one. [`stop`] is the flag
//! that Ctrl-C sets, [`output`] is standard output, [`progress`] the bar on standard error,
//! [`usage`] the answer to a wrong command line, [`value`] the ranges of options.

mod bench_options;
mod calibration_file;
mod campaign;
mod characterise;
mod compare;
mod critical_speed;
mod curve;
mod date;
mod doctor;
mod error;
mod exit;
mod faults;
mod identify;
mod identify_on_mass;
mod keys;
mod linear_vehicle;
mod next_test;
mod on_rig;
mod output;
mod progress;
mod rehearse;
mod replay;
mod report;
mod reproduce;
mod ride;
mod rig;
mod rig_delay;
mod rig_reset;
mod rtcheck;
mod rths_benchmark;
mod run;
mod run_records;
mod served;
mod simulate;
mod stop;
mod study;
mod track_server;
mod usage;
mod validation;
mod value;
mod wear_map;
mod yaw_damper;

use clap::error::ErrorKind;
use clap::{Arg, CommandFactory, FromArgMatches, Parser, Subcommand};
use error::CommandError;
use std::process::ExitCode;

/// A hardware-in-the-loop bench for railway yaw dampers: a locomotive model, a CAN bus and a
/// damper.
#[derive(Debug, Parser)]
#[command(name = "yawbench", version, max_term_width = 100, after_help = exit::HELP)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scenario: the vehicle on its track, with dampers modelled or on a rig.
    #[command(after_help = "Example: yawbench run scenarios/ss9-160kmh.toml --duration 10")]
    Run(run::RunArgs),
    /// Rehearse a run on emulated rigs that are as late as the real ones: how far every limit is
    /// away, before anything is armed.
    #[command(after_help = "Examples: yawbench rehearse scenarios/ss9-160kmh.toml --delay-ms 1.5
          yawbench rehearse scenarios/ss9-160kmh.toml --measured runs/rig-1")]
    Rehearse(rehearse::RehearseArgs),
    /// Map where wear in software stands for wear in the joint of the damper: clearance, stiffness,
    /// rig and damper, on emulated rigs.
    #[command(after_help = "Example: yawbench wear-map scenarios/ss9-one-worn-of-four.toml")]
    WearMap(wear_map::WearMapArgs),
    /// Make the report of a run from the files in its folder, also of a run that was killed.
    #[command(after_help = "Example: yawbench report runs/ss9-160kmh-1")]
    Report(report::ReportArgs),
    /// Compute a recorded run again from what came over the bus, and compare every frame sent and
    /// the trajectory of every cycle, bit for bit.
    #[command(after_help = "Example: yawbench replay runs/ss9-160kmh-1")]
    Replay(replay::ReplayArgs),
    /// Set runs side by side: is what differs between them larger than what repeats differ by?
    #[command(after_help = "Examples: yawbench compare runs/new-* runs/worn-*
          yawbench compare --group new runs/a-1 runs/a-2 --group worn runs/b-1 runs/b-2")]
    Compare(compare::CompareArgs),
    /// Emulate the rig at the other end of a CAN bus: actuator, load cell and damper.
    #[command(
        after_help = "Example: yawbench rig scenarios/rigs/laboratory-rig.toml --bus socketcan:vcan0 --node 1"
    )]
    Rig(rig::RigArgs),
    /// Reset a rig that is latched in SAFE or FAULT. It does not arm it.
    #[command(after_help = "Example: yawbench rig-reset --bus socketcan:can0 --node 1")]
    RigReset(rig_reset::RigResetArgs),
    /// Hand the track of a scenario to a locomotive on a board, which has no memory for it.
    #[command(
        after_help = "Example: yawbench track-server scenarios/ss9-160kmh.toml --duration 10.5 --there-and-back --bus socketcan:can0"
    )]
    TrackServer(track_server::TrackServerArgs),
    /// Look at this machine and its CAN interface: what holds a run back, and how to change it.
    /// Nothing is changed.
    #[command(after_help = "Examples: yawbench doctor
          yawbench doctor --bus socketcan:can0 --bitrate 500k --dbc bus.dbc")]
    Doctor(doctor::DoctorArgs),
    /// Measure whether this machine keeps the pace of the loop, and the answer time of the bus.
    /// No rig moves.
    #[command(
        after_help = "Example: yawbench rtcheck scenarios/ss9-160kmh.toml --seconds 3600 --bus socketcan:can0 --cpu 1"
    )]
    Rtcheck(rtcheck::RtcheckArgs),
    /// Inject faults into a coupled run in virtual time: what is found, and after how many cycles.
    #[command(after_help = "Example: yawbench faults")]
    Faults(faults::FaultsArgs),
    /// Simulate the bench tests of a damper model, or evaluate measured records: records and
    /// figures.
    #[command(
        after_help = "Examples: yawbench characterise --physical scenarios/dampers/hydraulic-yaw-damper.toml --tests short
          yawbench characterise --from sine.csv triangle.csv --datasheet sheet.toml"
    )]
    Characterise(Box<characterise::CharacteriseArgs>),
    /// Find the effects in measured records that a damper model lacks, and add them to it.
    #[command(
        after_help = "Example: yawbench identify --datasheet sheet.toml --train sine-*.csv triangle.csv --holdout service.csv"
    )]
    Identify(identify::IdentifyArgs),
    /// Measure how often `identify` is right: it runs on simulated records of known dampers.
    #[command(
        after_help = "Examples: yawbench campaign --cases 1254 --seed 1 --shard 1/2 --out campaign
          yawbench campaign --merge campaign/cases-1-of-2.jsonl campaign/cases-2-of-2.jsonl"
    )]
    Campaign(campaign::CampaignArgs),
    /// Compute the force of a damper model on a record, as a free-run simulation from the
    /// displacement.
    #[command(after_help = "Example: yawbench simulate model.toml sine.csv --out predicted.csv")]
    Simulate(simulate::SimulateArgs),
    /// Find the critical speed of the vehicle of a scenario, above which it hunts. The speed, track
    /// and duration of the scenario are not used.
    #[command(
        after_help = "Example: yawbench critical-speed scenarios/ss9-160kmh.toml --vary damper.ke_n_per_m=3e6:15e6:5"
    )]
    CriticalSpeed(critical_speed::CriticalSpeedArgs),
    /// Find by how much the critical speed is wrong that is measured with a rig whose force is
    /// late. The speed of the scenario counts for the measured delay alone; its track and duration
    /// are not used.
    #[command(
        after_help = "Example: yawbench rig-delay scenarios/ss9-160kmh.toml --delay-ms=-1,0,1,2"
    )]
    RigDelay(rig_delay::RigDelayArgs),
    /// Reproduce the study of the SS9's yaw dampers, figure by figure: its numbers next to ours.
    #[command(after_help = "Examples: yawbench reproduce --figure 10a --out reproduced
          yawbench reproduce --validation")]
    Reproduce(reproduce::ReproduceArgs),
    /// Assess the ride of the vehicle of a scenario on straight track: Sperling index, mean
    /// comfort, accelerations, spectra. The layout and duration of the scenario are not used.
    #[command(
        after_help = "Example: yawbench ride scenarios/ss9-160kmh.toml --vary speed_kmh=80:180:11"
    )]
    Ride(ride::RideArgs),
    /// Run the virtual benchmark of real-time hybrid simulation with our delay compensators, and
    /// with its own controller next to the published table; or our reference problem with a yaw
    /// damper.
    #[command(after_help = "Examples: yawbench rths-benchmark --record el-centro-1940.csv
          yawbench rths-benchmark --yaw-damper --quick
          yawbench rths-benchmark --yaw-damper --filter filter.csv --dead-time-ms 5")]
    RthsBenchmark(rths_benchmark::RthsBenchmarkArgs),
    /// Assess the vehicle of a scenario in its curve: guiding forces, derailment, wheel load, wear,
    /// stability. The duration of the scenario is not used.
    #[command(
        after_help = "Example: yawbench curve scenarios/ss9-curve-400m.toml --vary damper.clearance_2a_m=0.5e-3,4e-3"
    )]
    Curve(curve::CurveArgs),
}

/// Runs the command line.
fn main() -> ExitCode {
    stop::listen();
    let cli = match parsed() {
        Ok(cli) => cli,
        Err(why)
            if why.use_stderr()
                && why.kind() != ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand =>
        {
            let command = std::env::args().nth(1);
            output::complain(&usage::one_line(&why, command.as_deref()));
            return ExitCode::from(exit::BAD_INPUT);
        }
        // Help or version, on standard output.
        Err(help) => return show_help(&help),
    };
    match run(&cli.command) {
        Ok(code) => code,
        Err(why) => {
            output::complain(&why.to_string());
            ExitCode::from(why.exit_code())
        }
    }
}

/// Prints help or version.
fn show_help(help: &clap::Error) -> ExitCode {
    if help.use_stderr() {
        let _ = help.print();
        return ExitCode::from(exit::BAD_INPUT);
    }
    match output::print(&help.render().to_string()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            output::complain(&why.to_string());
            ExitCode::from(exit::FAILED)
        }
    }
}

/// Parses the command line. Every option takes a negative number as its value, so that the option
/// itself can say what it expects.
fn parsed() -> Result<Cli, clap::Error> {
    let negative = |arg: Arg| {
        let takes_value = arg.get_action().takes_values() && !arg.is_positional();
        arg.allow_negative_numbers(takes_value)
    };
    let command = Cli::command().mut_subcommands(|command| command.mut_args(negative));
    Cli::from_arg_matches(&command.try_get_matches()?)
}

fn run(command: &Command) -> Result<ExitCode, CommandError> {
    Ok(match command {
        Command::Run(args) => run::command(args)?,
        Command::Rehearse(args) => rehearse::command(args)?,
        Command::WearMap(args) => wear_map::command(args)?,
        Command::Report(args) => report::command(args)?,
        Command::Replay(args) => replay::command(args)?,
        Command::Compare(args) => compare::command(args)?,
        Command::Rig(args) => rig::command(args)?,
        Command::Doctor(args) => doctor::command(args)?,
        Command::Rtcheck(args) => rtcheck::command(args)?,
        Command::Faults(args) => faults::command(args)?,
        Command::RigReset(args) => rig_reset::command(args)?,
        Command::TrackServer(args) => track_server::command(args)?,
        Command::Characterise(args) => characterise::command(args)?,
        Command::Identify(args) => identify::command(args)?,
        Command::Campaign(args) => campaign::command(args)?,
        Command::Simulate(args) => simulate::command(args).map(done)?,
        Command::CriticalSpeed(args) => critical_speed::command(args)?,
        Command::RigDelay(args) => rig_delay::command(args)?,
        Command::Reproduce(args) => reproduce::command(args)?,
        Command::Ride(args) => ride::command(args)?,
        Command::RthsBenchmark(args) => rths_benchmark::command(args)?,
        Command::Curve(args) => curve::command(args)?,
    })
}

const fn done((): ()) -> ExitCode {
    ExitCode::SUCCESS
}
