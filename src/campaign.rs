//! `yawbench campaign`: the proof of `identify` on records whose truth is known.

use crate::output::print;
use crate::progress;
use anyhow::bail;
use clap::Args;
use evidence::campaign::score::Line;
use evidence::campaign::{Campaign, Table, page, run, table};
use hil_host::record::RunFolder;
use signal::shards::{Shard, merge};
use std::path::{Path, PathBuf};

/// Options of `campaign`.
#[derive(Debug, Args)]
pub(crate) struct CampaignArgs {
    /// Number of cases; 773 hold every kind. A folder that has some of them is completed.
    #[arg(long, value_name = "N", requires = "seed", required_unless_present = "merge")]
    cases: Option<usize>,
    /// Seed of the campaign.
    #[arg(long, value_name = "S", requires = "cases")]
    seed: Option<u64>,
    /// The part of the campaign to run, such as 1/4.
    #[arg(long, value_name = "I/N", requires = "cases")]
    shard: Option<Shard>,
    /// Fewer and shorter tests per case, to try the campaign itself.
    #[arg(long, requires = "cases")]
    brief: bool,
    /// The table of cases that shards have run.
    #[arg(long, value_name = "JSONL", num_args = 1.., conflicts_with = "cases")]
    merge: Vec<PathBuf>,
    /// Folder for the files [default: runs/campaign-SEED].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the table as JSON.
    #[arg(long)]
    json: bool,
}

/// Runs a campaign or a shard of it, or merges what others have run.
///
/// # Errors
/// Bad input; files that are no lines of this campaign; a disk that fails.
pub(crate) fn command(args: &CampaignArgs) -> anyhow::Result<()> {
    if !args.merge.is_empty() {
        return tell(args, &args.merge, None);
    }
    let Some(cases) = args.cases else { bail!("--cases: no number of cases") };
    let Some(seed) = args.seed else { bail!("--seed: no seed") };
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
    tell(args, &[path], Some(&folder))
}

/// The last case in a few words.
fn last(line: &Line) -> String {
    let truth = if line.truth.is_empty() { line.kind.clone() } else { line.truth.join(", ") };
    let right = if table::is_right(line) { "right" } else { "wrong" };
    format!("case {} ({truth}): {right}", line.index)
}

/// Prints the table and writes it where there is a folder.
fn tell(args: &CampaignArgs, files: &[PathBuf], folder: Option<&Path>) -> anyhow::Result<()> {
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
