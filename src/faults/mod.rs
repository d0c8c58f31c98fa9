//! `yawbench faults`: faults injected into a coupled run in virtual time, and what became of each.

mod loss;
mod random;
mod rows;
mod sound;

use crate::error::CommandError;
use crate::exit::{FAILED, INTERRUPTED};
use crate::progress::{bar, show};
use crate::stop;
use crate::value::number;
use clap::Args;
use clap::builder::TypedValueParser;
use indicatif::ProgressBar;
use scenario::run::{Overrides, Run};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};

#[derive(Debug, Args)]
pub(crate) struct FaultsArgs {
    /// A scenario with a damper on a rig.
    #[arg(default_value = "scenarios/ss9-160kmh.toml")]
    scenario: PathBuf,
    /// Cycles of random faults after the table; none by default.
    #[arg(long, value_name = "N", default_value_t = 0)]
    cycles: u64,
    /// Lose 0.1 % of the measurements for so many seconds after the table, 1 % for a 24th of them,
    /// and 10 % in either direction until the run ends.
    #[arg(long, value_name = "SECONDS", value_parser = seconds())]
    loss: Option<f64>,
    /// Run sound rigs for so many seconds each instead of faults: every alarm is a false one.
    #[arg(long, value_name = "SECONDS", value_parser = seconds(),
        conflicts_with_all = ["cycles", "loss"])]
    sound: Option<f64>,
    /// How many of the 48 cases of sound rigs run, drawn by the seed; all by default.
    #[arg(long, value_name = "N", requires = "sound")]
    cases: Option<usize>,
    /// The scenario of sound rigs in a curve.
    #[arg(long, value_name = "FILE", default_value = "scenarios/ss9-curve-400m.toml")]
    curve: PathBuf,
    /// Seed of the random faults and losses, and of track and noise of the sound rigs.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Parses a time up to a day.
fn seconds() -> impl TypedValueParser<Value = f64> {
    number("1 to 86400 s", |seconds| (1.0..=86_400.0).contains(&seconds))
}

/// Runs the command.
///
/// # Errors
/// A scenario that cannot be read or has no rig.
pub(crate) fn command(args: &FaultsArgs) -> Result<ExitCode, CommandError> {
    let holds = if let Some(seconds) = args.sound {
        sound::listen(args, seconds)?
    } else {
        let overrides = Overrides { duration_s: Some(10.0), ..Overrides::default() };
        let run = Run::load_at_usual_rate(&args.scenario, overrides)?;
        let all_right = rows::inject(&run)? & rows::drop_out(&run)?;
        let random = args.cycles == 0 || random::inject(&run, args)?;
        let losses = args.loss.map_or(Ok(true), |seconds| loss::inject(args, seconds))?;
        all_right && random && losses
    };
    Ok(match holds {
        _ if stop::flag().load(Ordering::Relaxed) => ExitCode::from(INTERRUPTED),
        true => ExitCode::SUCCESS,
        false => ExitCode::from(FAILED),
    })
}

/// Progress in cycles, counted by several threads.
struct CyclesDone {
    bar: ProgressBar,
    done: AtomicU64,
    of: u64,
}

impl CyclesDone {
    fn new(first: &'static str, of: u64) -> Self {
        Self { bar: bar(first), done: AtomicU64::new(0), of }
    }

    /// So many more are done.
    fn add(&self, cycles: u64) {
        let done = self.done.fetch_add(cycles, Ordering::Relaxed) + cycles;
        let thousands = [done.min(self.of) / 1000, self.of / 1000];
        show(&self.bar, thousands.map(|cycles| cycles as usize), "thousand cycles".to_owned());
    }
}

impl Drop for CyclesDone {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
