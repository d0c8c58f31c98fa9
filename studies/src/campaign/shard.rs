//! Many cases: which of them run here, where their lines go, and how a stopped campaign goes on.
//!
//! A shard `i/n` runs the cases whose number leaves i - 1 when divided by n, and appends one line for each
//! to its file as it ends. A case that is in the file is not run again; a last line that was cut off
//! is. Lines stand in the order in which cases ended; merging sorts them.

use super::case::Case;
use super::score::{Line, score};
use rayon::prelude::*;
use std::fmt;
use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Mutex;

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

/// A part of a campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Which part, from 1.
    pub part: usize,
    /// Of how many.
    pub of: usize,
}

impl Shard {
    /// All of it.
    pub const WHOLE: Self = Self { part: 1, of: 1 };

    /// True when a case is in it.
    ///
    /// ```
    /// let shard: studies::campaign::Shard = "2/3".parse().unwrap();
    /// assert!(shard.holds(1) && shard.holds(4) && !shard.holds(2));
    /// ```
    pub const fn holds(&self, index: usize) -> bool {
        index % self.of == self.part - 1
    }

    /// The name of its file.
    pub fn file(&self) -> String {
        format!("cases-{}-of-{}.jsonl", self.part, self.of)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text
            .split_once('/')
            .and_then(|(part, of)| Some(Self { part: part.parse().ok()?, of: of.parse().ok()? }));
        match parts {
            Some(shard) if shard.part >= 1 && shard.part <= shard.of => Ok(shard),
            _ => Err("expected part/parts, such as 1/4".to_owned()),
        }
    }
}

/// Why a campaign cannot go on.
#[derive(Debug)]
pub enum CampaignError {
    /// A file cannot be read or written.
    File(PathBuf, io::Error),
    /// A line is no case: file, line, why.
    Line(PathBuf, usize, String),
    /// A file is of another campaign: file, seed and brevity found, expected.
    Other(PathBuf, (u64, bool), (u64, bool)),
    /// Two files hold different results for a case.
    Twice(PathBuf, usize),
    /// There is nothing to merge.
    Empty,
}

impl fmt::Display for CampaignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let length = |brief: bool| if brief { "brief" } else { "whole" };
        match self {
            Self::File(path, why) => write!(f, "{}: {why}", path.display()),
            Self::Line(path, line, why) => write!(f, "{}:{line}: {why}", path.display()),
            Self::Other(path, found, expected) => write!(
                f,
                "{}: {} cases of seed {}, expected {} cases of seed {}",
                path.display(),
                length(found.1),
                found.0,
                length(expected.1),
                expected.0
            ),
            Self::Twice(path, index) => {
                write!(f, "{}: case {index} has another result elsewhere", path.display())
            }
            Self::Empty => write!(f, "no case in these files"),
        }
    }
}

impl std::error::Error for CampaignError {}

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
) -> Result<PathBuf, CampaignError> {
    let path = folder.join(shard.file());
    let failed = |why| CampaignError::File(path.clone(), why);
    std::fs::create_dir_all(folder).map_err(failed)?;
    let kept = if path.exists() { keep_whole_lines(&path)? } else { Vec::new() };
    for line in &kept {
        let (found, expected) = ((line.campaign_seed, line.brief), (campaign.seed, campaign.brief));
        if found != expected {
            return Err(CampaignError::Other(path, found, expected));
        }
    }
    let done = |index: usize| kept.iter().any(|line| line.index == index);
    let open: Vec<usize> =
        (0..campaign.cases).filter(|index| shard.holds(*index) && !done(*index)).collect();
    let file = OpenOptions::new().create(true).append(true).open(&path).map_err(failed)?;
    let out = Mutex::new((file, 0_usize));
    // One after the other from the front, so that a stopped campaign has its first cases.
    open.par_iter().with_max_len(1).try_for_each(|index| {
        let line = score(
            &Case::draw(campaign.seed, *index, campaign.brief),
            campaign.seed,
            campaign.brief,
        );
        let mut text = serde_json::to_string(&line).map_err(|why| failed(why.into()))?;
        text.push('\n');
        let mut out = out.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        out.0.write_all(text.as_bytes()).map_err(failed)?;
        out.1 += 1;
        progress(&line, out.1, open.len());
        Ok(())
    })?;
    Ok(path)
}

/// Reads and merges files of one campaign, in the order of the cases.
///
/// # Errors
/// A file that cannot be read, of another campaign, or with another result for a case.
pub fn read_lines(paths: &[PathBuf]) -> Result<Vec<Line>, CampaignError> {
    let mut all: Vec<Line> = Vec::new();
    for path in paths {
        for line in read(path)?.0 {
            let key = |line: &Line| (line.campaign_seed, line.brief);
            if let Some(first) = all.first().filter(|first| key(first) != key(&line)) {
                return Err(CampaignError::Other(path.clone(), key(&line), key(first)));
            }
            match all.iter().find(|other| other.index == line.index) {
                // The time it took may differ.
                Some(other) if Line { seconds: line.seconds, ..other.clone() } == line => {}
                Some(_) => return Err(CampaignError::Twice(path.clone(), line.index)),
                None => all.push(line),
            }
        }
    }
    if all.is_empty() {
        return Err(CampaignError::Empty);
    }
    all.sort_by_key(|line| line.index);
    Ok(all)
}

/// The lines of a file and the length of the part of it that is whole, bytes.
fn read(path: &Path) -> Result<(Vec<Line>, u64), CampaignError> {
    let failed = |why| CampaignError::File(path.to_owned(), why);
    let mut file = BufReader::new(File::open(path).map_err(failed)?);
    let (mut lines, mut whole, mut text) = (Vec::new(), 0, String::new());
    while file.read_line(&mut text).map_err(failed)? > 0 {
        if !text.ends_with('\n') {
            // Cut off when the campaign was stopped.
            break;
        }
        let line = serde_json::from_str(&text).map_err(|why| {
            CampaignError::Line(path.to_owned(), lines.len() + 1, why.to_string())
        })?;
        lines.push(line);
        whole += text.len() as u64;
        text.clear();
    }
    Ok((lines, whole))
}

fn keep_whole_lines(path: &Path) -> Result<Vec<Line>, CampaignError> {
    let (lines, whole) = read(path)?;
    let failed = |why| CampaignError::File(path.to_owned(), why);
    let file = OpenOptions::new().write(true).open(path).map_err(failed)?;
    file.set_len(whole).map_err(failed)?;
    Ok(lines)
}
