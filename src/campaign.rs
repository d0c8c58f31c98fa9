//! `yawbench campaign`: how often `identify` is right, on simulated records of known dampers.

use crate::error::CommandError;
use crate::exit::INTERRUPTED;
use crate::output::print;
use crate::value::whole;
use crate::{output, progress, stop};
use clap::Args;
use evidence::campaign::{self, Campaign, CaseResult, Table, is_right};
use files::identity::content_hash;
use files::{Identity, ResultFolder};
use signal::shards::{Computed, Shard, merge};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Name of the command in manifests.
const COMMAND: &str = "campaign";

#[derive(Debug, Args)]
pub(crate) struct CampaignArgs {
    /// Number of cases, required except with --merge; 1254 are the whole design. Cases that the
    /// folder already holds are not computed again.
    #[arg(long, value_name = "N", required_unless_present = "merge",
        value_parser = whole::<usize>(1, 1_000_000))]
    cases: Option<usize>,
    /// Seed of the cases, required except with --merge.
    #[arg(long, value_name = "S", required_unless_present = "merge")]
    seed: Option<u64>,
    /// The part of the campaign to compute, such as 1/4.
    #[arg(long, value_name = "I/N", allow_hyphen_values = true)]
    shard: Option<Shard>,
    /// Fewer tests per case: a quick check of the campaign itself.
    #[arg(long)]
    brief: bool,
    /// Print the table of cases that shards have computed, and compute nothing.
    #[arg(long, value_name = "JSONL", num_args = 1..,
        conflicts_with_all = ["cases", "seed", "shard", "brief"])]
    merge: Vec<PathBuf>,
    /// Folder for the files [default: runs/campaign-SEED].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the table as JSON.
    #[arg(long)]
    json: bool,
}

/// Runs a campaign or a shard of it, or merges the cases that shards have run.
///
/// # Errors
/// Bad input; files that hold no cases of one campaign; a disk that fails.
pub(crate) fn command(args: &CampaignArgs) -> Result<ExitCode, CommandError> {
    // Without --merge clap requires both.
    let (Some(cases), Some(seed)) = (args.cases, args.seed) else { return merged(args) };
    let campaign = Campaign { cases, seed, brief: args.brief };
    let shard = args.shard.unwrap_or(Shard::WHOLE);
    let identity = campaign.identity()?;
    // A fixed name, so that the same command continues a campaign that was stopped.
    let name = format!("campaign-{seed}");
    let (mut folder, changed) =
        ResultFolder::for_identity(args.out.as_deref(), &name, COMMAND, &identity)?;
    folder.check(&["table.json", "table.txt"])?;
    if let Some(changed) = changed {
        files::say!("note: {changed}");
    }
    folder.create()?;
    let bar = progress::bar("the first cases");
    let computed = campaign.run(shard, &folder, stop::flag(), &|case, done, of| {
        progress::show(&bar, [done, of], last(case));
    });
    bar.finish_and_clear();
    let computed = computed?;
    output::note_cut_off(&computed, "case");
    if computed.is_stopped() {
        let Computed { path, done, of, .. } = computed;
        files::say!(
            "interrupted: {} holds {done} of {of} cases; the same command continues",
            path.display()
        );
        return Ok(ExitCode::from(INTERRUPTED));
    }
    // A file of more cases than this campaign asks for keeps them.
    let lines: Vec<CaseResult> = merge(&[computed.path], Some(&identity))?;
    eprint!("{}", campaign::times(&lines));
    show(args, &Table::new(&lines), Some(&folder))
}

/// The table of the cases that shards have run.
fn merged(args: &CampaignArgs) -> Result<ExitCode, CommandError> {
    let table = Table::new(&merge::<CaseResult>(&args.merge, None)?);
    let folder = args.out.as_deref().map(|out| folder_of_merged(out, &args.merge, &table));
    show(args, &table, folder.transpose()?.as_ref())
}

/// The folder of a merged table: that of the campaign where this program has run the cases, else
/// one of its own, known by the content of the files.
fn folder_of_merged(
    out: &Path,
    files: &[PathBuf],
    table: &Table,
) -> Result<ResultFolder, CommandError> {
    let Table { cases, seed, brief, .. } = *table;
    let campaign = Campaign { cases, seed, brief }.identity()?;
    let identity = if merge::<CaseResult>(files, Some(&campaign)).is_ok() {
        campaign
    } else {
        let cases = serde_json::to_string(table)?;
        let inputs = [("cases".to_owned(), content_hash(cases.as_bytes()))].into();
        Identity::new(&"a table of merged cases", inputs, "")?
    };
    let (mut folder, _) = ResultFolder::for_identity(Some(out), "campaign", COMMAND, &identity)?;
    folder.check(&["table.json", "table.txt"])?;
    folder.create()?;
    Ok(folder)
}

/// The last case in a few words.
fn last(case: &CaseResult) -> String {
    let truth = if case.truth.is_empty() { case.kind.clone() } else { case.truth.join(", ") };
    let right = if is_right(case) { "right" } else { "wrong" };
    format!("case {} ({truth}): {right}", case.index)
}

/// Prints the table and writes it where there is a folder.
fn show(
    args: &CampaignArgs,
    table: &Table,
    folder: Option<&ResultFolder>,
) -> Result<ExitCode, CommandError> {
    let (json, text) = (serde_json::to_string_pretty(table)?, campaign::text(table));
    // The files are written whole.
    let _ = stop::flag();
    if let Some(folder) = folder {
        folder.write("table.json", &format!("{json}\n"))?;
        folder.write("table.txt", &text)?;
    }
    print(if args.json { &json } else { &text })?;
    Ok(ExitCode::SUCCESS)
}
