//! `yawbench identify --on-mass`: from the force on a body and its motion to what a spring and a
//! dashpot lack.

use crate::error::CommandError;
use crate::output::print;
use crate::{exit, progress, stop};
use files::{FolderError, ResultFolder};
use identification::on_mass::{
    OnMass, OnMassControl, OnMassQuestion, identify_on_mass, on_mass_page,
};
use identification::{IdentificationError, MODEL, QuestionFiles};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The options of `identify` that it uses.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OnMassOptions<'a> {
    /// The files.
    pub(crate) files: QuestionFiles<'a>,
    /// Result folder.
    pub(crate) out: Option<&'a Path>,
    /// Replace the result that the folder holds.
    pub(crate) overwrite: bool,
    /// Print result.json instead of a summary.
    pub(crate) json: bool,
}

/// Runs `identify --on-mass`.
///
/// # Errors
/// Bad input, before anything is written; or a disk that fails.
pub(crate) fn command(args: OnMassOptions<'_>) -> Result<ExitCode, CommandError> {
    // From here on Ctrl-C ends the command with its files.
    let stop = stop::flag();
    let OnMassOptions { files, out, overwrite, json: as_json } = args;
    let (question, warnings) = OnMassQuestion::read(files)?;
    let mut folder = ResultFolder::fresh(out, "identify", "identify", overwrite)?;
    let records = files.train.iter().chain(files.holdout).map(PathBuf::as_path);
    folder.refuse_inputs(records.chain(files.datasheet).chain(files.mapping))?;
    let names = question.train.iter().chain(&question.holdout).map(|record| &record.name);
    let predictions = names.map(|name| prediction_file(name));
    let fixed = ["result.json", MODEL, "report.html"].map(str::to_owned);
    let names: Vec<String> = fixed.into_iter().chain(predictions).collect();
    folder.check(&names.iter().map(String::as_str).collect::<Vec<_>>())?;
    // Only now: where the input is refused, the error stands alone.
    for warning in warnings {
        files::say!("warning: {warning}");
    }
    let bar = progress::bar("the linear body");
    let show = |counts, last: &str| progress::show(&bar, counts, last.to_owned());
    let found = identify_on_mass(&question, OnMassControl { progress: &show, stop });
    bar.finish_and_clear();
    let found = match found {
        Err(why @ IdentificationError::Interrupted) => {
            files::say!("error: {why}");
            return Ok(ExitCode::from(exit::INTERRUPTED));
        }
        other => other?,
    };
    let json = serde_json::to_string_pretty(&found.result)?;
    let html = on_mass_page(&found).to_html()?;
    folder.create()?;
    write(&folder, &found, &json, &html)?;
    if as_json {
        print(&json)?;
    } else {
        print(&format!("{}\nfiles: {}", found.summary(), folder.path().display()))?;
    }
    let interrupted = found.result.interrupted;
    Ok(if interrupted { ExitCode::from(exit::INTERRUPTED) } else { ExitCode::SUCCESS })
}

fn write(folder: &ResultFolder, found: &OnMass, json: &str, html: &str) -> Result<(), FolderError> {
    folder.write("result.json", &format!("{json}\n"))?;
    if let Some(text) = found.model_text() {
        folder.write(MODEL, &text)?;
    }
    folder.write("report.html", html)?;
    for (name, csv) in found.predictions() {
        folder.write(&prediction_file(&name), &csv)?;
    }
    Ok(())
}

fn prediction_file(record: &str) -> String {
    format!("predictions/{record}.csv")
}
