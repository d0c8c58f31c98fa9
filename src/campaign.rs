//! `yawbench campaign`: how often `identify` is right, on simulated records of known dampers.

use crate::error::CommandError;
use crate::output::print;
use crate::progress;
use crate::value::whole;
use clap::Args;
use evidence::campaign::score::Line;
use evidence::campaign::{Campaign, Table, page, run, table};
use hil_host::record::RunFolder;
use signal::shards::{Shard, merge};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(crate) struct CampaignArgs {
    /// Number of cases; 773 cover every kind. Cases that the folder already holds are not computed
    /// again.
    #[arg(long, value_name = "N", required_unless_present = "merge",
        value_parser = whole::<usize>(1, 1_000_000))]
    cases: Option<usize>,
    /// Seed of the cases.
    #[arg(long, value_name = "S", required_unless_present = "merge")]
    seed: Option<u64>,
    /// The part of the campaign to compute, such as 1/4.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Fewer and shorter tests per case: a quick check of the campaign itself.
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

/// Runs a campaign or a shard of it, or merges shards.
///
/// # Errors
/// Bad input; files that hold no cases of this campaign; a disk that fails.
pub(crate) fn command(args: &CampaignArgs) -> Result<(), CommandError> {
    // Without --merge clap requires both.
    let (Some(cases), Some(seed)) = (args.cases, args.seed) else {
        return conclude(args, &args.merge, None);
    };
    let campaign = Campaign { cases, seed, brief: args.brief };
    let shard = args.shard.unwrap_or(Shard::WHOLE);
    // A fixed name, so that the same command goes on where it was stopped.
    let usual = || PathBuf::from(format!("runs/campaign-{seed}"));
    let folder = args.out.clone().unwrap_or_else(usual);
    let bar = progress::bar("the first cases");
    let path = run(&campaign, shard, &folder, &|line, done, of| {
        progress::show(&bar, [done, of], last(line));
    })?;
    bar.finish_and_clear();
    conclude(args, &[path], Some(&folder))
}

/// The last case in a few words.
fn last(line: &Line) -> String {
    let truth = if line.truth.is_empty() { line.kind.clone() } else { line.truth.join(", ") };
    let right = if table::is_right(line) { "right" } else { "wrong" };
    format!("case {} ({truth}): {right}", line.index)
}

/// Merges the cases, prints their table and writes it where there is a folder.
fn conclude(
    args: &CampaignArgs,
    files: &[PathBuf],
    folder: Option<&Path>,
) -> Result<(), CommandError> {
    let table = Table::new(&merge(files)?);
    let (json, text) = (serde_json::to_string_pretty(&table)?, page::text(&table));
    if let Some(folder) = folder.or(args.out.as_deref()) {
        let folder = RunFolder::at(folder.to_owned());
        folder.create()?;
        folder.write("table.json", &format!("{json}\n"))?;
        folder.write("table.txt", &text)?;
    }
    if args.json {
        print(&json)?;
    } else {
        print(&text)?;
    }
    Ok(())
}
