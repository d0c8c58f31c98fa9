//! `yawbench reproduce`: the study of the SS9's yaw dampers, figure by figure.

use crate::error::CommandError;
use crate::exit::INTERRUPTED;
use crate::output::{print, warn};
use crate::{progress, stop, validation};
use clap::Args;
use evidence::EvidenceError;
use evidence::reproduce::Locomotive;
use evidence::reproduce::{Basis, FIGURES, Recipe, named, page, text};
use evidence::reproduce::{Calibrated, UNKNOWNS, calibrate};
use evidence::reproduce::{Figure, Row};
use files::{Identity, ResultFolder, did_you_mean};
use scenario::run::{Overrides, Run};
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::Ordering;
use vehicle_studies::critical_speed::Procedure;

/// Speeds among which critical ones are looked for (km/h): the study's lie between 170 and 260.
const SPEEDS_KMH: [f64; 2] = [140.0, 340.0];

/// The options of `reproduce`.
#[derive(Debug, Args)]
pub(crate) struct ReproduceArgs {
    /// One figure of the study, such as 10a; all of them without it.
    #[arg(long, value_name = "N", conflicts_with = "calibrate")]
    figure: Option<String>,
    /// Calibrate the three numbers that are published nowhere on the three critical speeds that fix
    /// them.
    #[arg(long)]
    calibrate: bool,
    /// Compare with benchmarks, published values, closed forms and second solutions instead of the
    /// study; exit code 1 if one is missed.
    #[arg(long, conflicts_with_all = ["figure", "calibrate"])]
    validation: bool,
    /// The locomotive with its dampers in good condition.
    #[arg(long, value_name = "FILE", default_value = "scenarios/ss9-160kmh.toml")]
    scenario: PathBuf,
    /// Tracks: seeds 1 to N.
    #[arg(long, value_name = "N", default_value_t = 5)]
    seeds: u64,
    /// Folder for the files [default: runs/reproduce or runs/validation, with -2, -3, ... where
    /// another result is there].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print reproduce.json instead of tables.
    #[arg(long)]
    json: bool,
}

/// `calibration.json`.
#[derive(Debug, Serialize)]
struct CalibrationFile<'a> {
    format: u32,
    procedure: &'a Procedure,
    calibrated: &'a [Calibrated],
}

/// Runs the command.
///
/// # Errors
/// Bad input, before anything is written; a vehicle that does not run; a disk that fails.
pub(crate) fn command(args: &ReproduceArgs) -> Result<ExitCode, CommandError> {
    if !(1..=1000).contains(&args.seeds) {
        return Err(CommandError::option(format!("--seeds {}", args.seeds), "1 to 1000"));
    }
    if args.validation {
        return validation::command(args.out.as_deref(), args.json);
    }
    let recipes = match &args.figure {
        None => FIGURES.to_vec(),
        Some(number) => named(number),
    };
    if recipes.is_empty() {
        let known: Vec<&str> = FIGURES.iter().map(|recipe| recipe.number).collect();
        let given = args.figure.as_deref().unwrap_or_default();
        let similar = did_you_mean(given, known.iter().copied());
        let expected = format!("one of {}{similar}", known.join(", "));
        return Err(CommandError::option(format!("--figure {given}"), expected));
    }
    let locomotive = Locomotive::load(&args.scenario, &[])?;
    warn(&Run::load_at_usual_rate(&args.scenario, Overrides::default())?.warnings);
    let [from_kmh, to_kmh] = SPEEDS_KMH;
    let seeds = (1..=args.seeds).collect();
    let procedure = Procedure { from_kmh, to_kmh, seeds, ..Procedure::default() };
    let scenario = args.scenario.as_path();
    let basis =
        Basis { scenario, locomotive: &locomotive, procedure: &procedure, stop: stop::flag() };
    if args.calibrate {
        return calibration(args, &basis);
    }
    let numbers: Vec<&'static str> = recipes.iter().map(|recipe| recipe.number).collect();
    let folder = folder(args, &basis.identity(&numbers)?, &["reproduce.json", "report.html"])?;
    let figures = make(&recipes, &basis)?;
    let rows: Vec<&Row> = figures.iter().flat_map(|figure| &figure.rows).collect();
    let json = format!("{}\n", serde_json::to_string_pretty(&rows)?);
    folder.write("reproduce.json", &json)?;
    folder.write("report.html", &page(&figures, &locomotive).to_html()?)?;
    if args.json {
        print(&json)?;
    } else {
        let (text, place) = (text(&figures), folder.path().display());
        print(&format!("{text}\n\nfiles in {place}: report.html, reproduce.json"))?;
    }
    let (done, of) = (figures.len(), recipes.len());
    if done < of {
        files::say!("interrupted: {done} of {of} figures are made");
        return Ok(ExitCode::from(INTERRUPTED));
    }
    Ok(ExitCode::SUCCESS)
}

/// The folder of a question, made before the work.
fn folder(
    args: &ReproduceArgs,
    identity: &Identity,
    names: &[&str],
) -> Result<ResultFolder, CommandError> {
    let out = args.out.as_deref();
    let (mut folder, changed) =
        ResultFolder::for_identity(out, "reproduce", "reproduce", identity)?;
    folder.check(names)?;
    if let Some(changed) = changed {
        files::say!("note: {changed}");
    }
    folder.create()?;
    Ok(folder)
}

/// Makes the figures; those that are done when the command is stopped.
fn make(recipes: &[Recipe], basis: &Basis<'_>) -> Result<Vec<Figure>, CommandError> {
    let bar = progress::bar("the first figure");
    let mut figures = Vec::new();
    for (done, recipe) in recipes.iter().enumerate() {
        let now = format!("figure {}: {}", recipe.number, recipe.title);
        progress::show(&bar, [done, recipes.len()], now);
        match recipe.make(basis) {
            Err(EvidenceError::Stopped) => break,
            made => figures.push(made?),
        }
    }
    bar.finish_and_clear();
    Ok(figures)
}

fn calibration(args: &ReproduceArgs, basis: &Basis<'_>) -> Result<ExitCode, CommandError> {
    let folder = folder(args, &basis.identity(&["calibration"])?, &["calibration.json"])?;
    let bar = progress::bar("the first number");
    let tried = std::cell::Cell::new(0);
    let calibrated = calibrate(basis, &|key, value, kmh| {
        tried.set(tried.get() + 1);
        let speed = kmh.map_or("beyond the range".to_owned(), |kmh| format!("{kmh:.1} km/h"));
        let name = key.rsplit('.').next().unwrap_or(key);
        // How many values are tried is not known before.
        progress::show(&bar, [tried.get(), tried.get() + 1], format!("{name} {value:.4}: {speed}"));
    })?;
    bar.finish_and_clear();
    let procedure = basis.procedure;
    let file = CalibrationFile { format: 1, procedure, calibrated: &calibrated };
    let json = format!("{}\n", serde_json::to_string_pretty(&file)?);
    folder.write("calibration.json", &json)?;
    let interrupted = basis.stop.load(Ordering::Relaxed);
    if interrupted {
        files::say!("interrupted: the numbers are those of the last complete step");
    }
    let code = if interrupted { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS };
    if args.json {
        print(&json)?;
        return Ok(code);
    }
    let mut lines = Vec::new();
    for (number, unknown) in calibrated.iter().zip(UNKNOWNS) {
        let reached = number.reached_kmh.map_or("-".to_owned(), |kmh| format!("{kmh:.1}"));
        let [low, high] = unknown.range;
        let end = if number.at_end_of_range { "; at the end of its range" } else { "" };
        lines.push(format!(
            "{} = {:.6}   in {low} to {high}   aim {:.0} km/h, reached {reached}{end}",
            number.key, number.value, number.aim_kmh
        ));
    }
    lines.push(format!("\nfiles in {}: calibration.json", folder.path().display()));
    print(&lines.join("\n"))?;
    Ok(code)
}
