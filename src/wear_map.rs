//! `yawbench wear-map`: where does wear in software stand for wear in the joint of the damper?

use crate::bench_options::{OverrideArgs, PrintedArgs};
use crate::error::CommandError;
use crate::exit::{FAILED, INTERRUPTED};
use crate::output::{print, warn};
use crate::progress::{bar, show};
use crate::stop;
use crate::value::number;
use clap::Args;
use hil_host::{Sine, WearMap, WearQuestion, wear_map};
use report::Report;
use scenario::run::Run;
use std::path::PathBuf;
use std::process::ExitCode;

/// The files in the folder of `--out`.
const FILES: [&str; 2] = ["wear-map.json", "report.html"];

#[derive(Debug, Args)]
pub(crate) struct WearMapArgs {
    /// The scenario file: its first damper on a rig, with that rig and its limits.
    scenario: PathBuf,
    /// Clearances in software (mm).
    #[arg(long, value_name = "MM,MM", value_delimiter = ',', default_value = "0,1,2,4,6,8",
        value_parser = number("clearances from 0 to 100 mm", |mm| (0.0..=100.0).contains(&mm)))]
    clearance_mm: Vec<f64>,
    /// Stiffnesses of the worn damper (MN/m); from that of the healthy one on nothing is softened.
    #[arg(long, value_name = "MN/M,MN/M", value_delimiter = ',', default_value = "3,5,8,12.5",
        value_parser = number("stiffnesses from 0.1 to 1000 MN/m", |ke| (0.1..=1e3).contains(&ke)))]
    ke_mn_per_m: Vec<f64>,
    /// Delays of ideal rigs (ms), next to the rig of the scenario.
    #[arg(long, value_name = "MS,MS", value_delimiter = ',', default_value = "1,3,5,10,15",
        value_parser = number("delays from 0.1 to 60 ms", |ms| (0.1..=60.0).contains(&ms)))]
    delay_ms: Vec<f64>,
    /// Least lags of ideal rigs (ms), a part of the delay: a bandwidth of 1 / (2 pi lag). Whole
    /// cycles make the rest; a lag that is longer than a delay is left out for it.
    #[arg(long, value_name = "MS,MS", value_delimiter = ',', default_value = "0.5,3",
        value_parser = number("lags from 0.1 to 20 ms", |ms| (0.1..=20.0).contains(&ms)))]
    lag_ms: Vec<f64>,
    /// Half of the travel between the eyes (mm).
    #[arg(long, value_name = "MM", default_value = "4",
        value_parser = number("a stroke from 0.01 to 500 mm", |mm| (0.01..=500.0).contains(&mm)))]
    stroke_mm: f64,
    /// Frequency of the motion (Hz).
    #[arg(long, value_name = "HZ", default_value = "3.5",
        value_parser = number("a frequency from 0.1 to 20 Hz", |hz| (0.1..=20.0).contains(&hz)))]
    frequency_hz: f64,
    #[command(flatten)]
    overrides: OverrideArgs,
    #[command(flatten)]
    printed: PrintedArgs,
}

/// Runs the command. Exit code 1 means that a cell which a run accepts does not hold.
///
/// # Errors
/// Bad input, before anything is written; a disk that fails.
pub(crate) fn command(args: &WearMapArgs) -> Result<ExitCode, CommandError> {
    let run = Run::load_at_usual_rate(&args.scenario, args.overrides.overrides())?;
    let mut folder = args.printed.folder(&args.scenario, "wear-map", &FILES)?;
    warn(&run.warnings);
    let progress = bar("dampers on rigs");
    let done = |done: usize, of: usize| show(&progress, [done, of], "dampers on rigs".to_owned());
    let found = wear_map(&run, &args.question(), stop::flag(), &done);
    progress.finish_and_clear();
    let Some(found) = found? else {
        files::say!("interrupted: nothing is written");
        return Ok(ExitCode::from(INTERRUPTED));
    };
    let json = serde_json::to_string_pretty(&found)?;
    if let Some(folder) = &mut folder {
        let page = found.page(Report::new(&run.title)).to_html()?;
        folder.create()?;
        folder.write(FILES[0], &format!("{json}\n"))?;
        folder.write(FILES[1], &page)?;
    }
    print(&if args.printed.json { json } else { text(&found) })?;
    let is_broken = found.broken().next().is_some();
    Ok(if is_broken { ExitCode::from(FAILED) } else { ExitCode::SUCCESS })
}

impl WearMapArgs {
    fn question(&self) -> WearQuestion {
        // Each once, in the order in which they are given.
        let si = |values: &[f64], unit: f64| -> Vec<f64> {
            let is_first = |place: &usize| !values[..*place].contains(&values[*place]);
            (0..values.len()).filter(is_first).map(|place| unit * values[place]).collect()
        };
        WearQuestion {
            sine: Sine { stroke_m: 1e-3 * self.stroke_mm, frequency_hz: self.frequency_hz },
            clearances_m: si(&self.clearance_mm, 1e-3),
            stiffnesses_n_per_m: si(&self.ke_mn_per_m, 1e6),
            delays_s: si(&self.delay_ms, 1e-3),
            lags_s: si(&self.lag_ms, 1e-3),
        }
    }
}

fn text(found: &WearMap) -> String {
    format!("{}\n{}", found.summary().to_text(), found.in_words())
}
