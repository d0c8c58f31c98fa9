//! `yawbench rths-benchmark --yaw-damper`: our reference problem, for our compensators and for
//! those of others.

use crate::error::CommandError;
use crate::exit::{FAILED, INTERRUPTED};
use crate::output::print;
use crate::{progress, stop};
use clap::{Args, ValueEnum};
use files::{ResultFolder, number};
use report::Report;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use vehicle_studies::StudyError;
use vehicle_studies::yaw_damper_problem::{
    AIMS, Answer, CONDITIONS, Candidate, Condition, DEAD_TIMES_MS, Errors, Motion, OURS, Problem,
    ProblemFile, Question, RESULT_OF, Regime, page, read_command, read_filter, text,
};

/// The name of the results in their folder, and of the folder itself.
const NAME: &str = "yaw-damper-problem";
/// The files of scores.
const SCORES: [&str; 2] = ["report.html", "scores.json"];

/// The options of the reference problem.
#[derive(Debug, Args)]
pub(crate) struct YawDamperArgs {
    /// The locomotive and its rig.
    #[arg(
        long,
        value_name = "FILE",
        requires = "yaw_damper",
        default_value = "scenarios/ss9-160kmh-servo-rig.toml"
    )]
    scenario: PathBuf,
    /// One dead time on the nominal rig with new and worn dampers; no soft dampers, perturbed rigs
    /// and critical speeds: seconds instead of minutes.
    #[arg(long, requires = "yaw_damper", conflicts_with_all = ["problem", "command"])]
    quick: bool,
    /// Write the files that others need, and score nothing.
    #[arg(long, requires = "yaw_damper", conflicts_with_all = ["command", "filter"])]
    problem: bool,
    /// Score this command, `time_s,displacement_m,velocity_m_per_s`, in open loop. The score is
    /// printed and nothing is written: no --out; --json prints it as JSON.
    #[arg(long, value_name = "CSV", requires_all = ["yaw_damper", "motion", "dead_time_ms"],
        conflicts_with = "filter")]
    command: Option<PathBuf>,
    /// The wanted motion that the command is for.
    #[arg(long, requires = "command")]
    motion: Option<WantedMotion>,
    /// Score this linear filter of the wanted displacement, `b,a`, in the closed loop.
    #[arg(long, value_name = "CSV", requires_all = ["yaw_damper", "dead_time_ms"])]
    filter: Option<PathBuf>,
    /// Dead time of the rig that a command or a filter is for: 1, 2, 5, 10 or 15.
    #[arg(long, value_name = "MS", requires = "yaw_damper", value_parser = dead_time)]
    dead_time_ms: Option<u16>,
    /// Folder for the files [default: runs/yaw-damper-problem, with -2, -3, ... for another
    /// question].
    #[arg(long, value_name = "DIR", requires = "yaw_damper", conflicts_with = "command")]
    out: Option<PathBuf>,
}

/// A wanted motion by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum WantedMotion {
    NewTrack,
    NewHunting,
    WornTrack,
    WornHunting,
    SoftTrack,
    SoftHunting,
}

impl WantedMotion {
    const fn motion(self) -> Motion {
        let (damper, regime) = match self {
            Self::NewTrack => (Condition::New, Regime::Track),
            Self::NewHunting => (Condition::New, Regime::Hunting),
            Self::WornTrack => (Condition::Worn, Regime::Track),
            Self::WornHunting => (Condition::Worn, Regime::Hunting),
            Self::SoftTrack => (Condition::Soft, Regime::Track),
            Self::SoftHunting => (Condition::Soft, Regime::Hunting),
        };
        Motion { damper, regime }
    }
}

/// Parses a dead time of the problem.
fn dead_time(text: &str) -> Result<u16, String> {
    let found = text.parse().ok().filter(|ms| DEAD_TIMES_MS.contains(ms));
    found.ok_or_else(|| "expected 1, 2, 5, 10 or 15".to_owned())
}

/// What the identity of a result holds of the command line.
#[derive(Debug, Serialize)]
struct Asked<'a> {
    command: &'static str,
    question: &'a Question,
    is_problem_only: bool,
    filter: Option<String>,
}

/// What `--command ... --json` prints.
#[derive(Debug, Serialize)]
struct OpenLoop {
    result_of: &'static str,
    motion: String,
    dead_time_ms: u16,
    errors: Option<Errors>,
    meets_aims: bool,
}

/// Runs the command.
///
/// # Errors
/// Bad input, before anything is written; a disk that fails.
pub(crate) fn command(
    args: &YawDamperArgs,
    seed: u64,
    json: bool,
) -> Result<ExitCode, CommandError> {
    match scored(args, seed, json) {
        Err(CommandError::Study(why)) if matches!(*why, StudyError::Stopped) => {
            files::say!("interrupted: no result is written");
            Ok(ExitCode::from(INTERRUPTED))
        }
        other => other,
    }
}

fn scored(args: &YawDamperArgs, seed: u64, json: bool) -> Result<ExitCode, CommandError> {
    // clap asks for all three together.
    if let (Some(file), Some(motion), Some(dead_time_ms)) =
        (&args.command, args.motion, args.dead_time_ms)
    {
        return open_loop(args, file, (motion.motion(), dead_time_ms), json);
    }
    let mut question = if args.quick { Question::quick(seed) } else { Question::full(seed) };
    let mut candidates: Vec<Candidate> = OURS.map(Candidate::Ours).into();
    let mut filter = None;
    if let (Some(file), Some(dead_time_ms)) = (&args.filter, args.dead_time_ms) {
        let found = read_filter(file)?;
        filter = Some(format!("{found:?}"));
        candidates = vec![Candidate::Filter(found)];
        question.dead_times_ms = vec![dead_time_ms];
        question.climb = None;
    } else if args.dead_time_ms.is_some() {
        return Err(CommandError::option("--dead-time-ms", "--command or --filter with it"));
    }
    let dampers = if args.problem { CONDITIONS.to_vec() } else { question.dampers.clone() };
    let problem = Problem::load(&args.scenario, &dampers, stop::flag())?;
    let asked = Asked { command: NAME, question: &question, is_problem_only: args.problem, filter };
    let identity = problem.identity(&asked)?;
    let (mut folder, changed) =
        ResultFolder::for_identity(args.out.as_deref(), NAME, NAME, &identity)?;
    let files = problem.files(question.seed, Question::full(question.seed).perturbed_rigs);
    let scores: &[&str] = if args.problem { &[] } else { &SCORES };
    let names = scores.iter().copied().chain(files.iter().map(|(name, _)| name.as_str()));
    let names: Vec<&str> = names.collect();
    folder.check(&names)?;
    if let Some(changed) = changed {
        files::say!("note: {changed}");
    }
    if args.problem {
        folder.create()?;
        write(&folder, &files)?;
        print(&format!("files in {}: {}", folder.path().display(), names.join(", ")))?;
        return Ok(ExitCode::SUCCESS);
    }
    let bar = progress::bar("runs of the reference problem");
    let done = |done: usize, of: usize| progress::show(&bar, [done, of], "runs".to_owned());
    let answer = problem.score(&question, &candidates, stop::flag(), &done);
    bar.finish_and_clear();
    let answer = answer?;
    folder.create()?;
    write(&folder, &files)?;
    finish(&answer, (&folder, &names), json)
}

/// Writes the files of the problem.
fn write(folder: &ResultFolder, files: &[ProblemFile]) -> Result<(), CommandError> {
    for (name, content) in files {
        folder.write(name, content)?;
    }
    Ok(())
}

/// Writes and prints the scores, next to what was written of the problem.
fn finish(
    answer: &Answer,
    (folder, names): (&ResultFolder, &[&str]),
    json: bool,
) -> Result<ExitCode, CommandError> {
    let file = format!("{}\n", serde_json::to_string_pretty(answer)?);
    let html = page(answer, Report::new("Yaw damper on emulated rigs")).to_html()?;
    let [report, scores] = SCORES;
    folder.write(scores, &file)?;
    folder.write(report, &html)?;
    if json {
        print(&file)?;
    } else {
        let (place, names) = (folder.path().display(), names.join(", "));
        print(&format!("{}\n\nfiles in {place}: {names}", text(answer)))?;
    }
    let is_missed = answer.aims.iter().any(|aim| !aim.is_met);
    Ok(if is_missed { ExitCode::from(FAILED) } else { ExitCode::SUCCESS })
}

/// Scores a command on the rig alone.
fn open_loop(
    args: &YawDamperArgs,
    file: &Path,
    (motion, dead_time_ms): (Motion, u16),
    json: bool,
) -> Result<ExitCode, CommandError> {
    let command = read_command(file, motion.regime)?;
    let problem = Problem::load(&args.scenario, &[motion.damper], stop::flag())?;
    let errors = problem.open_loop(motion, dead_time_ms, &command);
    let meets_aims = errors.is_some_and(|errors| errors.meet_aims());
    let motion = motion.name();
    if json {
        let result = OpenLoop { result_of: RESULT_OF, motion, dead_time_ms, errors, meets_aims };
        print(&serde_json::to_string_pretty(&result)?)?;
    } else {
        print(&open_loop_text(&motion, dead_time_ms, errors))?;
    }
    Ok(if meets_aims { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
}

fn open_loop_text(motion: &str, dead_time_ms: u16, errors: Option<Errors>) -> String {
    let mut lines = vec![format!(
        "{RESULT_OF}, open loop: {motion}, dead time {dead_time_ms} ms, front left damper; what it \
         does to the vehicle is not in it"
    )];
    let Some(errors) = errors else {
        lines.push("nothing moves: no score".to_owned());
        return lines.join("\n");
    };
    let names = [("work", "%"), ("stroke", "%"), ("phase", "degrees")];
    for (((name, unit), found), most) in names.into_iter().zip(errors.all()).zip(AIMS.all()) {
        let met = if found.abs() <= most { "met" } else { "MISSED" };
        lines.push(format!("{name}: {found:.3} {unit}, at most {} {unit}: {met}", number(most)));
    }
    lines.join("\n")
}
