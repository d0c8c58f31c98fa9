//! `yawbench compare`: is what differs between runs larger than what repeats differ by?

use crate::bench_options::PrintedArgs;
use crate::error::CommandError;
use crate::exit::INTERRUPTED;
use crate::output::print;
use crate::stop;
use clap::{Arg, ArgAction, ArgMatches, Args, FromArgMatches};
use hil_host::{RunGroups, side_by_side};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The files in the folder of `--out`.
const FILES: [&str; 2] = ["compare.json", "report.html"];

#[derive(Debug, Args)]
pub(crate) struct CompareArgs {
    /// The folders of the runs, grouped by what they recorded: runs whose files differ in title and
    /// in the seed of the emulated rig's noise alone are repeats of one condition.
    #[arg(value_name = "RUN", conflicts_with = "group")]
    runs: Vec<PathBuf>,
    #[command(flatten)]
    named: NamedGroups,
    #[command(flatten)]
    printed: PrintedArgs,
}

/// Groups that the user names, one for each `--group`. By hand: derived options lose which value
/// stood behind which of them.
#[derive(Debug, Default)]
struct NamedGroups(Vec<Vec<OsString>>);

/// Runs the command.
///
/// # Errors
/// Runs that cannot stand beside each other, before anything is written; a disk that fails.
pub(crate) fn command(args: &CompareArgs) -> Result<ExitCode, CommandError> {
    let asked = args.asked()?;
    let first = match &asked {
        RunGroups::ByCondition(runs) => runs.first(),
        RunGroups::Named(groups) => groups.first().and_then(|(_, runs)| runs.first()),
    };
    let first = first.map_or(Path::new("runs"), PathBuf::as_path);
    let mut folder = args.printed.folder(first, "compare", &FILES)?;
    let Some(found) = side_by_side(&asked, stop::flag())? else {
        files::say!("interrupted: nothing is written");
        return Ok(ExitCode::from(INTERRUPTED));
    };
    let json = serde_json::to_string_pretty(&found)?;
    if let Some(folder) = &mut folder {
        let page = found.page().to_html()?;
        folder.create()?;
        folder.write(FILES[0], &format!("{json}\n"))?;
        folder.write(FILES[1], &page)?;
    }
    print(&if args.printed.json { json } else { found.to_string() })?;
    Ok(ExitCode::SUCCESS)
}

impl CompareArgs {
    fn asked(&self) -> Result<RunGroups, CommandError> {
        let mut groups: Vec<(String, Vec<PathBuf>)> = Vec::new();
        for words in &self.named.0 {
            let [name, runs @ ..] = &words[..] else { continue };
            let option = |name: &str| format!("--group {name}");
            let is_folder = Path::new(name).is_dir();
            let name = name.to_string_lossy().into_owned();
            if is_folder || runs.is_empty() {
                return Err(CommandError::option(option(&name), "a name, and then its runs"));
            }
            if groups.iter().any(|(earlier, _)| *earlier == name) {
                return Err(CommandError::option(option(&name), "each name once"));
            }
            groups.push((name, runs.iter().map(PathBuf::from).collect()));
        }
        let asked = match groups.len() {
            0 => RunGroups::ByCondition(self.runs.clone()),
            _ => RunGroups::Named(groups),
        };
        let count = match &asked {
            RunGroups::ByCondition(runs) => runs.len(),
            RunGroups::Named(groups) => groups.iter().map(|(_, runs)| runs.len()).sum(),
        };
        if count < 2 {
            return Err(CommandError::option("compare", "two runs or more"));
        }
        Ok(asked)
    }
}

impl Args for NamedGroups {
    fn augment_args(command: clap::Command) -> clap::Command {
        let group = Arg::new("group")
            .long("group")
            .value_names(["NAME", "RUN"])
            .num_args(1..)
            .action(ArgAction::Append)
            .value_parser(clap::value_parser!(OsString))
            .help(
                "A group of repeats: a name, and then its runs. For what the files do not tell \
                 apart, such as two dampers on one rig; the first group is the reference",
            );
        command.arg(group)
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for NamedGroups {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let groups = matches.get_occurrences::<OsString>("group");
        Ok(Self(groups.into_iter().flatten().map(|words| words.cloned().collect()).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}
