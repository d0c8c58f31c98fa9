//! Many cases, in shards that can be stopped ([`signal::shards`]).

use super::case::Case;
use super::score::{Line, score};
use signal::shards::{self, Item, Shard, ShardError, Work};
use std::path::{Path, PathBuf};

/// A campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Campaign {
    /// Number of cases.
    pub cases: usize,
    /// Seed.
    pub seed: u64,
    /// Fewer and shorter tests per case, to try the campaign itself.
    pub brief: bool,
}

impl Item for Line {
    const CALLED: &'static str = "case";
    const MANY: &'static str = "cases";

    fn index(&self) -> usize {
        self.index
    }

    fn work(&self) -> String {
        name(self.campaign_seed, self.brief)
    }

    fn lasting(&self) -> Self {
        Self { seconds: 0.0, ..self.clone() }
    }
}

fn name(seed: u64, brief: bool) -> String {
    format!("{} cases of seed {seed}", if brief { "brief" } else { "whole" })
}

/// Runs the cases of a shard that its file in `folder` does not have yet. `progress` gets each line
/// that is done, the number of those and how many there will be. Returns the path of the file.
///
/// # Errors
/// A file that cannot be read or written, or that belongs to another campaign.
pub fn run(
    campaign: &Campaign,
    shard: Shard,
    folder: &Path,
    progress: &(dyn Fn(&Line, usize, usize) + Sync),
) -> Result<PathBuf, ShardError> {
    let Campaign { cases, seed, brief } = *campaign;
    let work = Work { items: cases, name: name(seed, brief) };
    let case = |index| score(&Case::draw(seed, index, brief), seed, brief);
    shards::run(&work, shard, folder, &case, progress)
}
