//! `yawbench identify`: from measured records to the effect that a damper model lacks.

use crate::error::CommandError;
use crate::identify_on_mass::{self, OnMassOptions};
use crate::next_test::{NEXT_TEST, NextTestArgs, Proposed};
use crate::output::print;
use crate::run_records::{RunRecordArgs, refuse_one_run_twice};
use crate::{exit, stop};
use clap::Args;
use files::{FolderError, ResultFolder};
use hil_host::record::measured::RunRecords;
use identification::{
    Control, Identification, IdentificationError, MODEL, MODEL_WITH_MAP, Question, QuestionFiles,
    RoundProgress, Step, identify, page,
};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Options of `identify`.
#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "switches of a command line")]
pub(crate) struct IdentifyArgs {
    /// The maker's numbers; without them there is no datasheet error.
    #[arg(long, value_name = "FILE")]
    datasheet: Option<PathBuf>,
    /// Records to fit: CSV files, or record.npy and bus.log of a run.
    #[arg(long, value_name = "FILE", num_args = 1.., required = true)]
    train: Vec<PathBuf>,
    /// Records that no fit sees; without them some of the training tests are held out.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    holdout: Vec<PathBuf>,
    /// Columns and units of the records.
    #[arg(long, value_name = "FILE")]
    mapping: Option<PathBuf>,
    /// Fit a smooth map to the residual, over the coordinate that explains most of it: empirical
    /// and no physics, kept only if it gains on left-out tests.
    #[arg(long)]
    empirical: bool,
    /// Continue the search for pairs of effects past its usual limit of work: minutes instead of
    /// half a minute.
    #[arg(long)]
    thorough: bool,
    /// The records are those of a body on a damper or a spring: predict its motion from the force
    /// on it. With a datasheet the damper is part of the model from the beginning.
    #[arg(long, conflicts_with_all = ["empirical", "thorough"])]
    on_mass: bool,
    /// Result folder [default: runs/identify-N].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace the result that the folder holds.
    #[arg(long)]
    overwrite: bool,
    /// Print result.json instead of a summary.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    next_test: NextTestArgs,
    #[command(flatten)]
    of_run: RunRecordArgs,
}

impl IdentifyArgs {
    fn files<'a>(&'a self, reader: &'a RunRecords) -> QuestionFiles<'a> {
        QuestionFiles {
            train: &self.train,
            holdout: &self.holdout,
            datasheet: self.datasheet.as_deref(),
            mapping: self.mapping.as_deref(),
            reader: Some(reader),
        }
    }
}

/// Runs `identify`.
///
/// # Errors
/// Bad input, before anything is written; or a disk that fails.
pub(crate) fn command(args: &IdentifyArgs) -> Result<ExitCode, CommandError> {
    if args.on_mass {
        return identify_on_mass::command(OnMassOptions {
            files: args.files(&args.of_run.reader()),
            out: args.out.as_deref(),
            overwrite: args.overwrite,
            json: args.json,
        });
    }
    // From here on Ctrl-C ends the command with its files.
    let stop = stop::flag();
    args.next_test.check()?;
    let records = args.train.iter().chain(&args.holdout);
    refuse_one_run_twice(&args.of_run.reader(), records)?;
    let (question, warnings) = question(args)?;
    args.next_test.check_records(&question)?;
    let out = args.out.as_deref();
    let mut folder = ResultFolder::fresh(out, "identify", "identify", args.overwrite)?;
    let options = args.datasheet.iter().chain(&args.mapping);
    let inputs = args.train.iter().chain(&args.holdout).chain(options);
    folder.refuse_inputs(inputs.map(PathBuf::as_path))?;
    check(&folder, &question)?;
    // Only now: where the input is refused, the error stands alone.
    for warning in warnings {
        files::say!("warning: {warning}");
    }
    let identification = match with_progress(stop, |control| identify(question, control)) {
        Err(why @ IdentificationError::Interrupted) => {
            files::say!("error: {why}");
            return Ok(ExitCode::from(exit::INTERRUPTED));
        }
        other => other?,
    };
    let proposed = (args.next_test.is_wanted())
        .then(|| with_progress(stop, |control| args.next_test.propose(&identification, control)))
        .transpose()?;
    let json = serde_json::to_string_pretty(&identification.result)?;
    let html = page(&identification).to_html()?;
    folder.create()?;
    write(&folder, &identification, &json, &html)?;
    if let Some(Proposed { list: Some(list), .. }) = &proposed {
        folder.write(NEXT_TEST, list)?;
    }
    if args.json {
        print(&json)?;
    } else {
        let tests = proposed.map(|proposed| proposed.text).unwrap_or_default();
        let (summary, path) = (identification.summary(), folder.path().display());
        print(&format!("{summary}{tests}\nfiles: {path}"))?;
    }
    let interrupted = identification.result.interrupted;
    Ok(if interrupted { ExitCode::from(exit::INTERRUPTED) } else { ExitCode::SUCCESS })
}

fn question(args: &IdentifyArgs) -> Result<(Question, Vec<String>), IdentificationError> {
    let (question, warnings) = Question::read(args.files(&args.of_run.reader()))?;
    let question = Question { empirical: args.empirical, thorough: args.thorough, ..question };
    Ok((question, warnings))
}

/// Checks before the work that every file can be written after it.
fn check(folder: &ResultFolder, question: &Question) -> Result<(), FolderError> {
    let records = question.train.iter().chain(&question.holdout);
    let predictions = records.flat_map(|record| prediction_files(&record.name));
    let fixed = ["result.json", MODEL, MODEL_WITH_MAP, NEXT_TEST, "report.html"].map(str::to_owned);
    let names: Vec<String> = fixed.into_iter().chain(predictions).collect();
    folder.check(&names.iter().map(String::as_str).collect::<Vec<_>>())
}

fn write(
    folder: &ResultFolder,
    identification: &Identification,
    json: &str,
    html: &str,
) -> Result<(), FolderError> {
    folder.write("result.json", &format!("{json}\n"))?;
    folder.write(MODEL, &identification.model_text())?;
    if let Some(text) = identification.model_with_map_text() {
        folder.write(MODEL_WITH_MAP, &text)?;
    }
    folder.write("report.html", html)?;
    for prediction in identification.predictions() {
        let [csv, mapping] = prediction_files(&prediction.test.record.name);
        folder.write(&csv, &prediction.to_csv())?;
        folder.write(
            &mapping,
            &prediction.to_mapping(&format!("{}.csv", prediction.test.record.name)),
        )?;
    }
    Ok(())
}

/// The CSV file of a test and its mapping.
fn prediction_files(test: &str) -> [String; 2] {
    ["csv", "toml"].map(|ending| format!("predictions/{test}.{ending}"))
}

/// Runs the work; its steps are shown once it has taken two seconds, with the time that the round
/// of the search still takes at the pace so far.
fn with_progress<T>(stop: &AtomicBool, work: impl FnOnce(Control<'_>) -> T) -> T {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(10));
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed:>4}  {msg}") {
        bar.set_style(style);
    }
    let begin = Instant::now();
    // The round that is under way, and when it began.
    let round = Mutex::new((0, begin));
    let progress = |step: &Step<'_>| {
        let mut message = step.what.to_owned();
        if let (Some(at), Ok(mut round)) = (step.round, round.lock()) {
            if round.0 != at.number {
                *round = (at.number, Instant::now());
            }
            message = in_round(step.what, at, round.1.elapsed());
        }
        if begin.elapsed() > Duration::from_secs(2) {
            bar.set_message(message);
            bar.tick();
        }
    };
    let done = work(Control { progress: &progress, stop });
    bar.finish_and_clear();
    done
}

/// A step of a round, and how long the round still takes.
fn in_round(what: &str, at: RoundProgress, elapsed: Duration) -> String {
    let RoundProgress { number, done, of } = at;
    let mut line = format!("round {number}, step {} of {of}: {what}", done + 1);
    if done > 0 {
        let left_s = elapsed.as_secs_f64() * (of - done) as f64 / done as f64;
        let _ = write!(line, ", about {} s left in this round", left_s.ceil());
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_round_states_the_time_that_it_still_takes() {
        let at = |done| RoundProgress { number: 2, done, of: 20 };
        let begin = in_round("screening", at(0), Duration::ZERO);
        assert_eq!(begin, "round 2, step 1 of 20: screening");
        let middle = in_round("fitting soft_yield", at(15), Duration::from_secs(30));
        assert!(middle.ends_with("fitting soft_yield, about 10 s left in this round"), "{middle}");
    }
}
