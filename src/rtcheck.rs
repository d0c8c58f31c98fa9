//! `yawbench rtcheck`: whether this machine keeps the pace of the loop, by measurement.

use crate::bench_options::{ProfileChoice, RealtimeArgs, rate};
use crate::error::CommandError;
use crate::exit::{FAILED, INTERRUPTED};
use crate::output::{print, warn};
use crate::served::served;
use crate::stop;
use crate::value::number;
use clap::Args;
use hil_host::bus::BusChoice;
use hil_host::doctor::{BusFacts, InterfaceKind};
use hil_host::live::{LiveAddress, RunEnd};
use hil_host::rtcheck::{BudgetOptions, Options, Outcome, RtCheck, Setup, budget, measure};
use scenario::run::{Overrides, Rate, Run};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(crate) struct RtcheckArgs {
    /// The scenario whose vehicle is stepped in every cycle; rigs are replaced by their models.
    /// Without one only the clock is measured.
    scenario: Option<PathBuf>,
    /// Another rate of the ticks (Hz) [default: the scenario's].
    #[arg(long, value_name = "HZ", value_parser = rate)]
    rate: Option<Rate>,
    /// Time every stage of the whole loop, with an emulated rig, at 1, 2 and 4 kHz, for so long at
    /// each rate, and print the table of the real-time budget. The bus may be a virtual one.
    #[arg(long, requires = "scenario", conflicts_with_all = ["rate", "serve", "json"])]
    stages: bool,
    /// How long to measure (s). An hour under the load of a working day says more than a minute.
    #[arg(long, value_name = "S", default_value = "60",
        value_parser = number("a duration from 0.1 to 86400 s", |s| (0.1..=86_400.0).contains(&s)))]
    seconds: f64,
    /// Measure the answer time of this bus too: socketcan:INTERFACE. Rigs there are not armed.
    #[arg(long, default_value_t = BusChoice::Memory)]
    bus: BusChoice,
    /// Frames that the rigs on the bus expect.
    #[arg(long, value_enum, default_value_t = ProfileChoice::Classical)]
    profile: ProfileChoice,
    /// Highest lateness of a wake-up (us).
    #[arg(long, value_name = "US", default_value = "100",
        value_parser = number("a time from 1 to 1000 us", |us| (1.0..=1000.0).contains(&us)))]
    budget_us: f64,
    /// Serve a page as `run --serve` does and feed it in every other second: the times with and
    /// without stand next to each other.
    #[arg(long, value_name = "ADDRESS")]
    serve: Option<LiveAddress>,
    /// Print the result as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    realtime: RealtimeArgs,
}

/// Runs the command.
///
/// # Errors
/// A scenario that is none; a bus that cannot be used, or with a host on it; real time is required
/// and was not granted.
pub(crate) fn command(args: &RtcheckArgs) -> Result<ExitCode, CommandError> {
    if let (true, Some(scenario)) = (args.stages, &args.scenario) {
        return stages(args, scenario);
    }
    let overrides =
        Overrides { duration_s: Some(args.seconds), rate: args.rate, ..Overrides::default() };
    let run = args.scenario.as_deref().map(|path| Run::load(path, overrides)).transpose()?;
    if let Some(run) = &run {
        warn(&run.warnings);
    }
    let rate = run.as_ref().map_or(args.rate.unwrap_or_default(), |run| run.rate);
    if args.serve.is_some() && rate != Rate::Usual {
        let found = format!("--serve at {} Hz", rate.hz());
        return Err(CommandError::option(
            found,
            "1000 Hz: the page is measured at that rate alone",
        ));
    }
    let options = Options {
        ticks: rate.cycles(args.seconds),
        rate,
        realtime: args.realtime.options(),
        bus: args.bus.clone(),
        profile: args.profile.into(),
    };
    let bus = match &args.bus {
        BusChoice::Memory => None,
        BusChoice::SocketCan(name) => Some((args.bus.to_string(), BusFacts::read(name).kind)),
    };
    let vehicle = run.as_ref().map(|run| run.vehicle_name.clone());
    let setup = Setup { rate, budget_us: args.budget_us, vehicle, bus };
    let requests = stop::end_requests();
    let page = args.serve.map(|address| served(address, requests)).transpose()?;
    let measured = measure(run.as_ref(), &options, page.as_ref(), requests.end_flag())?;
    if let Some(page) = page {
        page.end(RunEnd {
            words: "The measurement has ended.".to_owned(),
            why: None,
            warnings: Vec::new(),
            files: None,
            is_good: true,
        });
    }
    let result = RtCheck::of(&measured, &setup);
    if args.json {
        print(&serde_json::to_string_pretty(&result)?)?;
    } else {
        print(&result.lines().join("\n"))?;
    }
    Ok(match result.outcome {
        _ if result.interrupted => ExitCode::from(INTERRUPTED),
        Outcome::Held => ExitCode::SUCCESS,
        Outcome::NotHeld => ExitCode::from(FAILED),
    })
}

/// Cycles one behind the other at each rate, next to those on the clock.
const HOT_CYCLES: u64 = 20_000;

/// The budget of the whole loop, at every rate.
fn stages(args: &RtcheckArgs, scenario: &Path) -> Result<ExitCode, CommandError> {
    if let BusChoice::SocketCan(name) = &args.bus
        && BusFacts::read(name).kind == InterfaceKind::Can
    {
        // Commands would go to whatever rig is there.
        let found = format!("--stages on {}", args.bus);
        return Err(CommandError::option(found, "memory, or a virtual interface such as vcan0"));
    }
    let load = |rate: Rate, seconds: f64| {
        let (duration_s, rate) = (Some(seconds), Some(rate));
        let overrides = Overrides { duration_s, rate, ..Overrides::default() };
        Ok::<_, CommandError>(Run::load(scenario, overrides)?)
    };
    let options = BudgetOptions {
        seconds: args.seconds,
        hot_cycles: HOT_CYCLES,
        realtime: args.realtime.options(),
        bus: args.bus.clone(),
    };
    let found = budget(load, &options)?;
    for line in found.realtime.lines() {
        files::say!("real-time: {line}");
    }
    print(&found.lines().join("\n"))?;
    Ok(ExitCode::SUCCESS)
}
