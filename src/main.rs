//! The command line: one file per subcommand, each parses, calls and prints.

mod bench_options;
mod campaign;
mod characterise;
mod critical_speed;
mod curve;
mod exit;
mod identify;
mod output;
mod predictions;
mod progress;
mod reproduce;
mod ride;
mod rig;
mod run;
mod simulate;
mod stop;
mod study;
mod validation;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};
use std::process::ExitCode;

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
    Run(run::RunArgs),
    /// Be the rig at the other end of a CAN bus: actuator, load cell and an emulated damper.
    #[command(
        after_help = "Example: yawbench rig scenarios/rigs/laboratory-rig.toml --bus socketcan:vcan0 --node 1"
    )]
    Rig(rig::RigArgs),
    /// Visit a damper bench: records and figures of a damper that exists only as a model, or the
    /// figures of measured records.
    #[command(
        after_help = "Examples: yawbench characterise --physical scenarios/dampers/hydraulic-yaw-damper.toml --tests short
          yawbench characterise --from sine.csv triangle.csv --datasheet sheet.toml"
    )]
    Characterise(characterise::CharacteriseArgs),
    /// Find the effect that a damper model lacks on measured records, and add it.
    #[command(
        after_help = "Examples: yawbench identify --datasheet sheet.toml --train sine-*.csv triangle.csv --holdout service.csv
          yawbench identify --campaign 773 --seed 1 --shard 1/2 --out campaign"
    )]
    Identify(identify::IdentifyArgs),
    /// The force of a model on a record, free-running from its displacement.
    #[command(after_help = "Example: yawbench simulate model.toml sine.csv --out predicted.csv")]
    Simulate(simulate::SimulateArgs),
    /// From which speed on does the vehicle of a scenario hunt? Its speed, track and duration do not
    /// matter.
    #[command(
        after_help = "Example: yawbench critical-speed scenarios/ss9-160kmh.toml --vary damper.ke_n_per_m=3e6:15e6:5"
    )]
    CriticalSpeed(critical_speed::CriticalSpeedArgs),
    /// The study of the SS9's yaw dampers, figure by figure: its numbers beside ours.
    #[command(after_help = "Examples: yawbench reproduce --figure 10a --out reproduced
          yawbench reproduce --validation")]
    Reproduce(reproduce::ReproduceArgs),
    /// How does the vehicle of a scenario ride on straight track? Sperling index, mean comfort,
    /// accelerations, spectra; its layout and duration do not matter.
    #[command(
        after_help = "Example: yawbench ride scenarios/ss9-160kmh.toml --vary speed_kmh=80:180:11"
    )]
    Ride(ride::RideArgs),
    /// How does the vehicle of a scenario go through its curve? Guiding forces, derailment, wheel load,
    /// wear, stability; its duration does not matter.
    #[command(
        after_help = "Example: yawbench curve scenarios/ss9-curve-400m.toml --vary damper.clearance_2a_m=0.5e-3,4e-3"
    )]
    Curve(curve::CurveArgs),
}

/// Runs the command line.
fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(told)
            if told.use_stderr()
                && told.kind() != ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand =>
        {
            eprintln!("{}", one_line(&told.render().to_string()));
            return ExitCode::from(exit::BAD_INPUT);
        }
        // Help or version, on standard output.
        Err(told) => told.exit(),
    };
    let result = match &cli.command {
        Command::Run(args) => run::command(args),
        Command::Rig(args) => rig::command(args),
        Command::Characterise(args) => characterise::command(args),
        Command::Identify(args) => identify::command(args).map(|()| ExitCode::SUCCESS),
        Command::Simulate(args) => simulate::command(args).map(|()| ExitCode::SUCCESS),
        Command::CriticalSpeed(args) => critical_speed::command(args),
        Command::Reproduce(args) => reproduce::command(args),
        Command::Ride(args) => ride::command(args),
        Command::Curve(args) => curve::command(args),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(exit::code(&error))
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
