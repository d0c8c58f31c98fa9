//! `yawbench rehearse`: how far every limit of a run is away, on emulated rigs, before anything is
//! armed.

use crate::bench_options::{OverrideArgs, PrintedArgs};
use crate::error::CommandError;
use crate::exit::{FAILED, INTERRUPTED};
use crate::linear_vehicle::linear_vehicle;
use crate::output::{print, stem, warn};
use crate::stop;
use crate::value::number;
use clap::Args;
use files::ResultFolder;
use hil_host::{BenchError, LinearVehicle, MeasuredRam, MeasuredRams, rehearse};
use scenario::rig::DELAY_MAX_S;
use scenario::run::{Run, SlotForce};
use std::path::PathBuf;
use std::process::ExitCode;

/// Frequency of hunting where that of the vehicle is not known (Hz).
const HUNTING_HZ: f64 = 3.5;

/// The file in the folder of `--out`.
const REHEARSAL: &str = "rehearsal.json";

#[derive(Debug, Args)]
pub(crate) struct RehearseArgs {
    /// The scenario file.
    scenario: PathBuf,
    /// How late the ram is (ms): measured displacement against the command of the cycle in which it
    /// arrives. The emulated rig is then an ideal one that is late by this
    /// [default: the scenario's].
    #[arg(long, value_name = "MS", conflicts_with = "measured",
        value_parser = number("a delay from 0 to 64 ms", |ms| (0.0..=64.0).contains(&ms)))]
    delay_ms: Option<f64>,
    /// The same from the folder in which it was measured: of an open loop, or of a run. Tests near
    /// the hunting frequency count, and of these the one with the largest delay.
    #[arg(long, value_name = "DIR")]
    measured: Option<PathBuf>,
    #[command(flatten)]
    overrides: OverrideArgs,
    #[command(flatten)]
    printed: PrintedArgs,
}

/// Runs the command. Exit code 1 means that a limit was passed.
///
/// # Errors
/// Bad input, before anything is written; a disk that fails.
pub(crate) fn command(args: &RehearseArgs) -> Result<ExitCode, CommandError> {
    let mut run = Run::load(&args.scenario, args.overrides.overrides())?;
    let mut folder = args.printed.folder(&args.scenario, "rehearse", &[REHEARSAL])?;
    warn(&run.warnings);
    // A run would write there, unless it is told otherwise.
    let free_bytes = ResultFolder::fresh(None, &stem(&args.scenario), "run", false)?.free_bytes();
    let linear = linear_vehicle(&run)?;
    let ram = ram(args, &run, linear.as_ref())?;
    if let Some(ram) = &ram {
        run.rig = run.rig.late_by(ram.delay_s.max(0.0)).ok_or_else(|| {
            let found = format!("a ram that is {:.3} ms late", 1e3 * ram.delay_s);
            let expected = format!("0 to {:.0} ms", 1e3 * DELAY_MAX_S);
            CommandError::Input { file: ram.source.as_str().into(), found, expected }
        })?;
    }
    let Some(found) = rehearse(&run, ram, linear.as_ref(), free_bytes, stop::flag())? else {
        files::say!("interrupted: nothing is written");
        return Ok(ExitCode::from(INTERRUPTED));
    };
    let json = serde_json::to_string_pretty(&found)?;
    if let Some(folder) = &mut folder {
        folder.create()?;
        folder.write(REHEARSAL, &format!("{json}\n"))?;
    }
    print(&if args.printed.json { json } else { found.to_string() })?;
    Ok(if found.holds { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
}

/// How late the rams are: as an option says, or the largest delay that was measured of them.
fn ram(
    args: &RehearseArgs,
    run: &Run,
    linear: Option<&LinearVehicle>,
) -> Result<Option<MeasuredRam>, CommandError> {
    let rams = match (args.delay_ms, &args.measured) {
        (Some(ms), _) => MeasuredRams::said(1e-3 * ms, "--delay-ms"),
        (None, Some(folder)) => MeasuredRams::read(std::slice::from_ref(folder))?,
        (None, None) => return Ok(None),
    };
    let frequency_hz = linear.map_or(HUNTING_HZ, |linear| linear.hunting.frequency_hz);
    let rigs = run.slots.iter().filter_map(|slot| match slot.force {
        SlotForce::Rig { node, .. } => Some((&slot.place, node)),
        SlotForce::Modelled(_) | SlotForce::StandIn { .. } => None,
    });
    let rigs: Vec<_> = rigs.collect();
    if rigs.is_empty() {
        return Ok(None);
    }
    let of_rigs = rigs.into_iter().flat_map(|(place, node)| rams.of_rig(place, node, frequency_hz));
    match of_rigs.max_by(|one, other| one.delay_s.total_cmp(&other.delay_s)) {
        Some(ram) => Ok(Some(ram.clone())),
        None => Err(BenchError::OtherRams { found: rams.found(), frequency_hz }.into()),
    }
}
