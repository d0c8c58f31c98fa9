//! `yawbench identify`: from measured records to the effect that a damper model lacks.

use crate::output::print;
use crate::predictions::{self, Forces};
use anyhow::{Context, bail};
use clap::Args;
use firmware_core::damper::Damper;
use hil_host::record::RunFolder;
use identification::empirical::{Empirical, FittedMap};
use identification::fit::Fit;
use identification::result::{IdentifyResult, Verdict};
use identification::search::Progress;
use identification::split::split;
use identification::{Identification, Question, identify, page};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use measurement::{Measurement, interpolant, read_tests};
use scenario::damper::DamperFile;
use scenario::datasheet::Datasheet;
use scenario::quantity::Provenance;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// The identified damper.
const MODEL: &str = "model.toml";
/// The same with an empirical map.
const WITH_MAP: &str = "model-empirical.toml";

/// What `identify` is told.
#[derive(Debug, Args)]
pub(crate) struct IdentifyArgs {
    /// The maker's numbers; without them there is no datasheet error.
    #[arg(long, value_name = "FILE")]
    datasheet: Option<PathBuf>,
    /// Records to fit.
    #[arg(long, value_name = "CSV", num_args = 1.., required = true)]
    train: Vec<PathBuf>,
    /// Records that no fit sees; without them some of the training tests are held out.
    #[arg(long, value_name = "CSV", num_args = 1..)]
    holdout: Vec<PathBuf>,
    /// Columns and units of the records.
    #[arg(long, value_name = "FILE")]
    mapping: Option<PathBuf>,
    /// Then put a smooth map over the coordinate that explains most of what is left: empirical and no
    /// physics, kept only if it gains on tests left out.
    #[arg(long)]
    empirical: bool,
    /// Go on past the usual limit of work where two effects at once are looked for: minutes where it is half a
    /// minute.
    #[arg(long)]
    thorough: bool,
    /// Folder for the files [default: runs/identify-N].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print result.json instead of a summary.
    #[arg(long)]
    json: bool,
}

/// Runs `identify`.
///
/// # Errors
/// Bad input, before anything is written; or a disk that fails.
pub(crate) fn command(args: &IdentifyArgs) -> anyhow::Result<()> {
    let question = question(args)?;
    let folder = RunFolder::choose(args.out.as_deref(), "identify");
    folder.try_create()?;
    let datasheet_given = question.datasheet.is_some();
    let identification = with_progress(|progress| identify(question, progress))?;
    let result = &identification.result;
    let json = serde_json::to_string_pretty(result)?;
    let damper = identification.damper().context("the identified damper cannot be built")?;
    let html = page::page(&identification).to_html()?;

    let place = |name: &str| folder.file(name).display().to_string();
    let write = |name: &str, text: &str| folder.write(name, text);
    folder.create()?;
    write("result.json", &format!("{json}\n"))?;
    write(MODEL, &model_text(&damper, result, ""))?;
    let map = identification.empirical.as_ref().and_then(Empirical::kept);
    match map {
        Some(map) => write(WITH_MAP, &empirical_text(map, result))?,
        // One of an earlier identification would be taken for one of this.
        None if folder.file(WITH_MAP).exists() => {
            std::fs::remove_file(folder.file(WITH_MAP)).with_context(|| place(WITH_MAP))?;
        }
        None => {}
    }
    write("report.html", &html)?;
    let within = folder.file("predictions");
    std::fs::create_dir_all(&within).with_context(|| place("predictions"))?;
    // Those of an earlier identification would be taken for some of this.
    for entry in std::fs::read_dir(&within).with_context(|| place("predictions"))?.flatten() {
        if entry.path().extension().is_some_and(|kind| kind == "csv") {
            std::fs::remove_file(entry.path()).with_context(|| place("predictions"))?;
        }
    }
    for (tests, models, mapped) in [
        (&identification.train, &identification.on_train, map.map(|map| &map.on_train)),
        (&identification.holdout, &identification.on_holdout, map.map(|map| &map.on_holdout)),
    ] {
        for (index, test) in tests.tests.iter().enumerate() {
            let path = within.join(format!("{}.csv", test.record.name));
            let forces = Forces {
                measured: Some(&test.record.force_n),
                models: models.map(|fit| force_of(fit.as_ref(), index)),
                with_empirical: mapped.map(|force_n| force_n[index].as_slice()),
            };
            predictions::write(&path, test, &forces).with_context(|| path.display().to_string())?;
        }
    }
    if args.json {
        return Ok(print(&json)?);
    }
    let text = told(&identification, datasheet_given)?;
    Ok(print(&format!("{text}\nfiles: {}", folder.path().display()))?)
}

/// Reads everything that is asked about.
fn question(args: &IdentifyArgs) -> anyhow::Result<Question> {
    let mut notes = Vec::new();
    let datasheet = args.datasheet.as_deref().map(Datasheet::load).transpose()?;
    if let Some(sheet) = &datasheet {
        notes.extend(sheet.conversion.iter().map(|line| format!("datasheet: {line}")));
        notes.extend(sheet.warnings.iter().map(|warning| format!("datasheet: {warning}")));
    }
    let twice = args.holdout.iter().find(|held| args.train.contains(held));
    if let Some(twice) = twice {
        bail!("{}: both in --train and in --holdout, expected in one of them", twice.display());
    }
    for files in [&args.train, &args.holdout] {
        let again = |(index, file): (usize, &PathBuf)| files[..index].contains(file);
        if let Some(place) = files.iter().enumerate().position(again) {
            bail!("{}: given twice, expected each record once", files[place].display());
        }
    }
    let mapping = args.mapping.as_deref();
    // Read together, so that no two tests share a name.
    let paths: Vec<PathBuf> = args.train.iter().chain(&args.holdout).cloned().collect();
    let mut train = read_tests(&paths, mapping)?;
    refuse_repeated(&train)?;
    let fitted = train.iter().take_while(|record| args.train.contains(&record.file)).count();
    let mut holdout = train.split_off(fitted);
    if holdout.is_empty() {
        let parted = split(train);
        notes.push(parted.how);
        (train, holdout) = (parted.train, parted.holdout);
    }
    for record in train.iter().chain(&holdout) {
        notes.extend(record.repairs.iter().map(|repair| format!("{}: {repair}", record.name)));
    }
    notes.extend(bandwidths(train.iter().chain(&holdout)));
    // After everything that may be refused: an error stands alone.
    for warning in datasheet.iter().flat_map(|sheet| &sheet.warnings) {
        eprintln!("warning: datasheet: {warning}");
    }
    let datasheet = datasheet.map(|sheet| sheet.nominal);
    Ok(Question {
        train,
        holdout,
        datasheet,
        empirical: args.empirical,
        thorough: args.thorough,
        notes,
    })
}

/// Refuses a record that is there twice, under whatever name: held out beside itself in training it
/// would show an error that nobody has.
fn refuse_repeated(records: &[Measurement]) -> anyhow::Result<()> {
    for (index, later) in records.iter().enumerate() {
        let same = |first: &&Measurement| {
            first.force_n == later.force_n && first.displacement_m == later.displacement_m
        };
        if let Some(first) = records[..index].iter().find(same) {
            let (file, of) = (later.file.display(), first.file.display());
            bail!("{file}: found the same numbers as in {of}, expected each record once");
        }
    }
    Ok(())
}

/// What each sampling rate lets through, once per rate.
fn bandwidths<'a>(records: impl Iterator<Item = &'a Measurement>) -> Vec<String> {
    let mut rates: Vec<f64> = records.map(|record| libm::round(record.rate_hz())).collect();
    rates.sort_by(f64::total_cmp);
    rates.dedup();
    let told = rates.iter().map(|rate_hz| {
        format!(
            "{rate_hz} samples per second: velocity and acceleration lose 3 dB at {:.0} Hz",
            interpolant::bandwidth_hz(*rate_hz, 3.0)
        )
    });
    told.collect()
}

/// Runs a task that says what it is doing; after two seconds people see it.
fn with_progress<T>(task: impl FnOnce(Progress<'_>) -> T) -> T {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(10));
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed:>4}  {msg}") {
        bar.set_style(style);
    }
    let begin = Instant::now();
    let done = task(&|what| {
        if begin.elapsed() > Duration::from_secs(2) {
            bar.set_message(what.to_owned());
            bar.tick();
        }
    });
    bar.finish_and_clear();
    done
}

fn force_of(fit: Option<&Fit>, test: usize) -> Option<&[f64]> {
    fit.map(|fit| fit.force_n[test].as_slice())
}

/// The identified damper as a file that scenarios load.
fn model_text(damper: &Damper, result: &IdentifyResult, more: &str) -> String {
    let mut notes = BTreeMap::new();
    let std = |std: Option<f64>| match std {
        Some(std) => format!("+- {std:.3e}"),
        None => "not fixed by the records".to_owned(),
    };
    for (name, value) in &result.nominal {
        notes.insert(name.clone(), std(value.std));
    }
    for effect in &result.effects {
        for (name, value) in &effect.parameters {
            notes.insert(format!("{}.{name}", effect.name), std(value.std));
        }
    }
    let heading = format!("Identified from measured records: {}.{more}", sentence(result));
    DamperFile::from_damper(damper, Provenance::Identified, &notes).to_model(&heading)
}

/// The same with the map, which nobody shall take for physics.
fn empirical_text(fitted: &FittedMap, result: &IdentifyResult) -> String {
    let over = fitted.map.coordinate().name();
    let more = format!(
        "\nEmpirical, no physics: a map over {over} stands beside the damper that was identified,\n\
         which is {MODEL}. It is valid only inside the range of the records."
    );
    model_text(&fitted.damper, result, &more)
}

/// The verdict in words.
fn sentence(result: &IdentifyResult) -> String {
    let names: Vec<String> = result
        .effects
        .iter()
        .map(|effect| match effect.alternatives.as_slice() {
            [] => effect.name.to_owned(),
            others => format!("{} (or {})", effect.name, others.join(", or ")),
        })
        .collect();
    let left = result.unexplained.as_ref().map_or(String::new(), |left| {
        format!("{:.4} N rms are unexplained, over {}", left.rms_n, left.coordinate)
    });
    match result.verdict {
        Verdict::NoMissingEffect => "no effect is missing".to_owned(),
        Verdict::EffectsFound => format!("missing: {}", names.join(", ")),
        Verdict::Unexplained => left,
        Verdict::EffectsFoundAndUnexplained => format!("missing: {}; {left}", names.join(", ")),
    }
}

/// The summary for people.
fn told(identification: &Identification, datasheet_given: bool) -> Result<String, std::fmt::Error> {
    let mut out = String::new();
    let result = &identification.result;
    writeln!(out, "{}", sentence(result))?;
    writeln!(
        out,
        "\n{:<14}{:>14}{:>10}{:>14}{:>10}",
        "rms error", "train N", "", "hold-out N", ""
    )?;
    let kept = result.empirical.as_ref().filter(|part| part.kept);
    let with_map = kept.and_then(|part| part.errors);
    let models = [
        ("datasheet", &result.errors.datasheet),
        ("refitted", &result.errors.refitted),
        ("with effects", &result.errors.with_effects),
        ("empirical map", &with_map),
    ];
    for (name, errors) in models {
        let Some(errors) = errors else {
            if name == "datasheet" && !datasheet_given {
                writeln!(out, "{name:<14}  none given")?;
            }
            continue;
        };
        let held = match (errors.holdout_rmse_n, errors.holdout_nrmse) {
            (Some(rmse), Some(share)) => format!("{rmse:>14.4}{:>9.2}%", 100.0 * share),
            _ => String::new(),
        };
        let share = 100.0 * errors.train_nrmse;
        writeln!(out, "{name:<14}{:>14.4}{share:>9.2}%{held}", errors.train_rmse_n)?;
    }
    writeln!(out, "{:<14}{:>14.4}", "noise floor", result.noise_floor_n)?;
    writeln!(out, "\n{:<34}{:>14}{:>12}{:>14}", "parameter", "identified", "+-", "datasheet")?;
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.5e}"));
    for (name, value) in &result.nominal {
        let std = value.std.map_or("not fixed".to_owned(), |std| format!("{std:.1e}"));
        let sheet = number(value.datasheet);
        writeln!(out, "{name:<34}{:>14}{std:>12}{sheet:>14}", number(Some(value.value)))?;
    }
    for effect in &result.effects {
        let evidence = &effect.evidence;
        writeln!(
            out,
            "{} ({}): takes away {:.1} % of the squared error on left-out tests, p = {:.1e}",
            effect.name,
            effect.place,
            100.0 * evidence.holdout_gain,
            evidence.p_value
        )?;
        for (name, value) in &effect.parameters {
            let std = value.std.map_or("not fixed".to_owned(), |std| format!("{std:.1e}"));
            writeln!(
                out,
                "  {name:<32}{:>14}{std:>12}  {}",
                number(Some(value.value)),
                value.unit
            )?;
        }
        if let Some(direction) = effect.direction {
            writeln!(out, "  {direction}")?;
        }
        if let Some(test) = &effect.separating_test {
            writeln!(out, "  cannot be told from {}: {test}", effect.alternatives.join(", "))?;
        }
    }
    if let Some(left) = &result.unexplained {
        writeln!(out, "left: {}", left.description)?;
    }
    if let Some(part) = &result.empirical {
        let over = part.coordinate.map_or(String::new(), |over| format!(" over {over}"));
        if part.kept {
            writeln!(out, "empirical map{over}: {}; it is no physics ({WITH_MAP})", part.why)?;
        } else {
            writeln!(out, "no empirical map{over}: {}", part.why)?;
        }
    }
    for note in &result.notes {
        writeln!(out, "note: {note}")?;
    }
    Ok(out)
}
