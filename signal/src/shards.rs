//! Long work in parts: which part runs here, where its lines go, and how stopped work goes on.
//!
//! Work is a number of independent items. A shard `i/n` does those whose number leaves i - 1 when
//! divided by n, and appends one line of JSON for each to its file as it ends. An item that is in the file
//! is not done again; a last line that was cut off is. Lines stand in the order in which items ended;
//! merging sorts them, so what is made of them is the same on one core or many, in one piece or in parts.

use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt;
use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Mutex;

/// A part of a work.
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

    /// True when an item is in it.
    ///
    /// ```
    /// let shard: signal::shards::Shard = "2/3".parse().unwrap();
    /// assert!(shard.holds(1) && shard.holds(4) && !shard.holds(2));
    /// ```
    pub const fn holds(&self, index: usize) -> bool {
        index % self.of == self.part - 1
    }

    /// The name of its file, after what its items are called.
    pub fn file(&self, items: &str) -> String {
        format!("{items}-{}-of-{}.jsonl", self.part, self.of)
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

/// What was found for one item.
pub trait Item: Serialize + DeserializeOwned + Clone + PartialEq + Send + Sync {
    /// What one is called.
    const CALLED: &'static str;
    /// What many are called; files are named after it.
    const MANY: &'static str;

    /// Its number in the work.
    fn index(&self) -> usize;

    /// The work that it belongs to, in words: the same for all items of one.
    fn work(&self) -> String;

    /// The same item without what may differ from run to run, such as the time it took.
    #[must_use]
    fn lasting(&self) -> Self {
        self.clone()
    }
}

/// Why work cannot go on.
#[derive(Debug)]
pub enum ShardError {
    /// A file cannot be read or written.
    File(PathBuf, io::Error),
    /// A line is no item: file, line, why.
    Line(PathBuf, usize, String),
    /// A file is of other work: file, found, expected.
    Other(PathBuf, String, String),
    /// Two files hold different results for an item: file, what it is called, number.
    Twice(PathBuf, &'static str, usize),
    /// There is nothing to merge: the first file, what it would be called.
    Empty(PathBuf, &'static str),
}

impl fmt::Display for ShardError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path, why) => write!(f, "{}: {why}", path.display()),
            Self::Line(path, line, why) => write!(f, "{}:{line}: {why}", path.display()),
            Self::Other(path, found, expected) => {
                write!(f, "{}: {found}, expected {expected}", path.display())
            }
            Self::Twice(path, called, index) => {
                write!(f, "{}: {called} {index} has another result elsewhere", path.display())
            }
            Self::Empty(path, called) => {
                write!(f, "{}: found no {called}, expected some", path.display())
            }
        }
    }
}

impl std::error::Error for ShardError {}

/// Work to be done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Work {
    /// Number of items.
    pub items: usize,
    /// What [`Item::work`] says of all of them.
    pub name: String,
}

/// Does the items of a shard that its file in `folder` does not have yet. `progress` gets each item
/// that is done, the number of those and how many there will be. Returns the path of the file.
///
/// # Errors
/// A file that cannot be read or written, or that belongs to other work.
pub fn run<T: Item>(
    work: &Work,
    shard: Shard,
    folder: &Path,
    item: &(dyn Fn(usize) -> T + Sync),
    progress: &(dyn Fn(&T, usize, usize) + Sync),
) -> Result<PathBuf, ShardError> {
    let path = folder.join(shard.file(T::MANY));
    let failed = |why| ShardError::File(path.clone(), why);
    std::fs::create_dir_all(folder).map_err(failed)?;
    let kept: Vec<T> = if path.exists() { keep_whole_lines(&path)? } else { Vec::new() };
    if let Some(other) = kept.iter().find(|kept| kept.work() != work.name) {
        return Err(ShardError::Other(path, other.work(), work.name.clone()));
    }
    let done = |index: usize| kept.iter().any(|kept| kept.index() == index);
    let open: Vec<usize> =
        (0..work.items).filter(|index| shard.holds(*index) && !done(*index)).collect();
    let file = OpenOptions::new().create(true).append(true).open(&path).map_err(failed)?;
    let out = Mutex::new((file, 0_usize));
    // One after the other from the front, so that stopped work has its first items.
    open.par_iter().with_max_len(1).try_for_each(|index| {
        let found = item(*index);
        let mut text = serde_json::to_string(&found).map_err(|why| failed(why.into()))?;
        text.push('\n');
        let mut out = out.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        out.0.write_all(text.as_bytes()).map_err(failed)?;
        out.1 += 1;
        progress(&found, out.1, open.len());
        Ok(())
    })?;
    Ok(path)
}

/// Reads and merges files of one work, in the order of the items.
///
/// # Errors
/// A file that cannot be read, of other work, or with another result for an item.
pub fn merge<T: Item>(paths: &[PathBuf]) -> Result<Vec<T>, ShardError> {
    let mut all: Vec<T> = Vec::new();
    for path in paths {
        for found in read::<T>(path)?.0 {
            if let Some(first) = all.first().filter(|first| first.work() != found.work()) {
                return Err(ShardError::Other(path.clone(), found.work(), first.work()));
            }
            match all.iter().find(|other| other.index() == found.index()) {
                Some(other) if other.lasting() == found.lasting() => {}
                Some(_) => {
                    return Err(ShardError::Twice(path.clone(), T::CALLED, found.index()));
                }
                None => all.push(found),
            }
        }
    }
    if all.is_empty() {
        let first = paths.first().cloned().unwrap_or_default();
        return Err(ShardError::Empty(first, T::CALLED));
    }
    all.sort_by_key(Item::index);
    Ok(all)
}

/// The items of a file and the length of the part of it that is whole, bytes.
fn read<T: Item>(path: &Path) -> Result<(Vec<T>, u64), ShardError> {
    let failed = |why| ShardError::File(path.to_owned(), why);
    let mut file = BufReader::new(File::open(path).map_err(failed)?);
    let (mut items, mut whole, mut text) = (Vec::new(), 0, String::new());
    while file.read_line(&mut text).map_err(failed)? > 0 {
        if !text.ends_with('\n') {
            // Cut off when the work was stopped.
            break;
        }
        let item = serde_json::from_str(&text)
            .map_err(|why| {
            let why = format!(
                "found no {} of this work ({why}), expected one on every line; without the line it is \
                 found anew",
                T::CALLED
            );
            ShardError::Line(path.to_owned(), items.len() + 1, why)
        })?;
        items.push(item);
        whole += text.len() as u64;
        text.clear();
    }
    Ok((items, whole))
}

fn keep_whole_lines<T: Item>(path: &Path) -> Result<Vec<T>, ShardError> {
    let (items, whole) = read(path)?;
    let failed = |why| ShardError::File(path.to_owned(), why);
    let file = OpenOptions::new().write(true).open(path).map_err(failed)?;
    file.set_len(whole).map_err(failed)?;
    Ok(items)
}
