//! Long work in shards: which items are computed here, where their lines go, and how stopped work
//! goes on.
//!
//! Work is a number of independent items. A shard `i/n` computes the items with the numbers i - 1,
//! i - 1 + n, i - 1 + 2n and so on, and appends one line of JSON for each to its file as soon as it
//! is done. Every line holds its item and what it was computed from; lines that were computed from
//! something else are refused. Items that the file holds are not computed again; a last line that
//! was cut off is. Lines are in the order in which items were done; merging sorts them, so the
//! result is the same on one core or many, in one shard or several.

use crate::error::SignalError;
use crate::origin::Origin;
pub use crate::shard::Shard;
use files::input::{self, Limit};
use files::{Identity, ResultFolder};
use rayon::prelude::*;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// The result of one item.
pub trait Item: Serialize + DeserializeOwned + Clone + PartialEq + Send + Sync {
    /// What an item is called.
    const SINGULAR: &'static str;
    /// What items are called; files are named after it.
    const PLURAL: &'static str;

    /// Its number in the work.
    fn index(&self) -> usize;

    /// The work that it belongs to, in words: the same for all items of one work.
    fn work(&self) -> String;

    /// The item without what may differ from run to run, such as the time it took.
    #[must_use]
    fn lasting(&self) -> Self {
        self.clone()
    }
}

/// Work to be done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Work<'a> {
    /// Number of items.
    pub items: usize,
    /// What [`Item::work`] says of all of them.
    pub name: String,
    /// What the items are computed from.
    pub identity: &'a Identity,
}

/// A shard after [`run`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Computed {
    /// Its file.
    pub path: PathBuf,
    /// Number of its items that the file holds.
    pub done: usize,
    /// Number of its items.
    pub of: usize,
    /// The file ended in an incomplete line, as that of a process that was killed does; its item is
    /// computed again.
    pub cut_off: bool,
}

impl Computed {
    /// True when items are missing because the work was stopped.
    pub const fn is_stopped(&self) -> bool {
        self.done < self.of
    }
}

/// An item in its file, with what it was computed from.
#[derive(Serialize, Deserialize)]
struct StoredItem<T> {
    #[serde(flatten)]
    item: T,
    /// None in files that were written before results had an identity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    origin: Option<Origin>,
}

/// Computes the items of a shard that its file in `folder` does not hold yet. `progress` gets each
/// item when it is done, the number of items done now and the number to do. Once `stop` is set no
/// further item begins; an item at work that reads the flag too gives none, and is computed by the
/// next process.
///
/// # Errors
/// An item that fails; a file that cannot be read or written, or that holds lines of another
/// origin; a second process at the same shard. The file then holds the items that were done.
pub fn run<T: Item, E: From<SignalError> + Send>(
    work: &Work<'_>,
    shard: Shard,
    folder: &ResultFolder,
    stop: &AtomicBool,
    item: &(dyn Fn(usize) -> Result<Option<T>, E> + Sync),
    progress: &(dyn Fn(&T, usize, usize) + Sync),
) -> Result<Computed, E> {
    let path = folder.listed(&shard.file_name(T::PLURAL)).map_err(SignalError::from)?;
    let file = locked(&path)?;
    let origin = Origin::from(work.identity);
    let (kept, cut_off) = keep_whole_lines::<T>(&path, &file, &origin, &work.name)?;
    let of = (0..work.items).filter(|index| shard.holds(*index)).count();
    let open: Vec<usize> =
        (0..work.items).filter(|index| shard.holds(*index) && !kept.contains(index)).collect();
    let failed = |why| SignalError::File(path.clone(), why);
    let out = Mutex::new((file, 0_usize));
    // In ascending order, so that stopped work holds its first items.
    open.par_iter().with_max_len(1).try_for_each(|index| -> Result<(), E> {
        if stop.load(Ordering::Relaxed) {
            return Ok(());
        }
        let Some(found) = item(*index)? else { return Ok(()) };
        debug_assert_eq!(found.index(), *index);
        let line = StoredItem { item: found, origin: Some(origin.clone()) };
        let mut text = serde_json::to_string(&line).map_err(|why| failed(why.into()))?;
        text.push('\n');
        let mut out = out.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        out.0.write_all(text.as_bytes()).map_err(failed)?;
        out.1 += 1;
        progress(&line.item, out.1, open.len());
        Ok(())
    })?;
    let (_, new) = out.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    debug_assert!(new <= open.len() && open.len() <= of, "{new} of {} of {of}", open.len());
    Ok(Computed { done: of - open.len() + new, of, path, cut_off })
}

/// Reads and merges files of one work, in the order of the items. Where an identity is given, every
/// item has to be computed from it; otherwise all items from the same one.
///
/// # Errors
/// A file that cannot be read, is of other work or of another origin, or has another result for an
/// item.
pub fn merge<T: Item>(
    paths: &[PathBuf],
    identity: Option<&Identity>,
) -> Result<Vec<T>, SignalError> {
    let mut all: BTreeMap<usize, T> = BTreeMap::new();
    let mut expected: Option<Option<Origin>> = identity.map(|identity| Some(identity.into()));
    let mut name: Option<String> = None;
    for path in paths {
        for (number, stored) in read::<T>(path)?.0.into_iter().enumerate() {
            let origin = expected.get_or_insert_with(|| stored.origin.clone());
            refuse_other_origin(path, number + 1, stored.origin.as_ref(), origin.as_ref())?;
            let found = stored.item;
            let name = name.get_or_insert_with(|| found.work());
            if found.work() != *name {
                return Err(SignalError::OtherWork(path.clone(), found.work(), name.clone()));
            }
            match all.get(&found.index()) {
                Some(other) if other.lasting() == found.lasting() => {}
                Some(_) => {
                    return Err(SignalError::Conflict(path.clone(), T::SINGULAR, found.index()));
                }
                None => {
                    all.insert(found.index(), found);
                }
            }
        }
    }
    if all.is_empty() {
        let first = paths.first().cloned().unwrap_or_default();
        return Err(SignalError::NoItems(first, T::SINGULAR));
    }
    Ok(all.into_values().collect())
}

/// Opens the file of a shard for appending; no other process has it as long as the value lives.
fn locked(path: &Path) -> Result<File, SignalError> {
    let failed = |why| SignalError::File(path.to_owned(), why);
    let file = OpenOptions::new().create(true).append(true).open(path).map_err(failed)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(SignalError::InUse(path.to_owned())),
        Err(TryLockError::Error(why)) => Err(failed(why)),
    }
}

fn refuse_other_origin(
    path: &Path,
    line: usize,
    found: Option<&Origin>,
    expected: Option<&Origin>,
) -> Result<(), SignalError> {
    let differences = Origin::differences(found, expected);
    if differences.is_empty() {
        return Ok(());
    }
    Err(SignalError::OtherOrigin(path.to_owned(), line, differences))
}

/// The items of a file and the length of its complete lines, bytes.
fn read<T: Item>(path: &Path) -> Result<(Vec<StoredItem<T>>, u64), SignalError> {
    let failed = |why| SignalError::File(path.to_owned(), why);
    let mut file = BufReader::new(input::open(path, Limit::Table)?);
    let (mut items, mut whole, mut text) = (Vec::new(), 0, String::new());
    while file.read_line(&mut text).map_err(failed)? > 0 {
        if !text.ends_with('\n') {
            // Cut off when the work was stopped.
            break;
        }
        let item = serde_json::from_str(&text).map_err(|why| {
            let why = files::quote::message(&why.to_string());
            SignalError::Line(path.to_owned(), items.len() + 1, T::SINGULAR, why)
        })?;
        items.push(item);
        whole += text.len() as u64;
        text.clear();
    }
    Ok((items, whole))
}

/// Removes an incomplete last line; gives the numbers of the items that the file holds, and whether
/// there was such a line.
fn keep_whole_lines<T: Item>(
    path: &Path,
    file: &File,
    origin: &Origin,
    work: &str,
) -> Result<(BTreeSet<usize>, bool), SignalError> {
    let (stored, whole) = read::<T>(path)?;
    for (number, stored) in stored.iter().enumerate() {
        refuse_other_origin(path, number + 1, stored.origin.as_ref(), Some(origin))?;
        if stored.item.work() != work {
            let (found, expected) = (stored.item.work(), work.to_owned());
            return Err(SignalError::OtherWork(path.to_owned(), found, expected));
        }
    }
    let failed = |why| SignalError::File(path.to_owned(), why);
    let cut_off = file.metadata().map_err(failed)?.len() > whole;
    file.set_len(whole).map_err(failed)?;
    Ok((stored.iter().map(|stored| stored.item.index()).collect(), cut_off))
}

#[cfg(test)]
mod tests;
