//! `yawbench identify --campaign` and `--merge`: the proof of `identify` on records whose truth is known.

use crate::identify::IdentifyArgs;
use crate::output::print;
use crate::progress;
use anyhow::bail;
use evidence::campaign::score::Line;
use evidence::campaign::{Campaign, Table, page, run, table};
use hil_host::record::RunFolder;
use signal::shards::{Shard, merge};
use std::path::{Path, PathBuf};

/// Runs a campaign or a shard of it, or merges what others have run.
///
/// # Errors
/// Bad input; files that are no lines of this campaign; a disk that fails.
pub(crate) fn command(args: &IdentifyArgs) -> anyhow::Result<()> {
    if !args.merge.is_empty() {
        return tell(args, &args.merge, None);
    }
    let Some(cases) = args.campaign else { bail!("--campaign: no number of cases") };
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
fn tell(args: &IdentifyArgs, files: &[PathBuf], folder: Option<&Path>) -> anyhow::Result<()> {
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
