//! "Did you mean" for names: keys, values of options, files.

pub use crate::similarity::closest;

use crate::quote::quoted;
use crate::similarity::SIMILAR;
use std::path::{Path, PathBuf};

/// A folder with more entries than this is not searched.
const ENTRIES_MAX: usize = 2_000;

/// `; did you mean NAME?` where a known name is close to `word`, else nothing.
///
/// ```
/// assert_eq!(files::did_you_mean("shrt", ["full", "short"]), "; did you mean short?");
/// assert_eq!(files::did_you_mean("xyz", ["full", "short"]), "");
/// ```
pub fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    closest(word, known).map_or(String::new(), |name| format!("; did you mean {}?", quoted(name)))
}

/// The file in the folder of an absent one that was probably meant: another ending of the same
/// name, or another name with the same ending.
pub(crate) fn file_like(path: &Path) -> Option<PathBuf> {
    let (stem, ending) = (path.file_stem()?.to_str()?, path.extension().unwrap_or_default());
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?;
    let names = entries.take(ENTRIES_MAX).flatten().map(|entry| PathBuf::from(entry.file_name()));
    // A link to nothing is listed and absent.
    let names = names.filter(|name| path.file_name() != Some(name.as_os_str()));
    let score = |name: PathBuf| {
        let (other, other_ending) = (name.file_stem()?.to_str()?, name.extension()?);
        let score = if other == stem {
            1.0 + strsim::jaro(ending.to_str()?, other_ending.to_str()?)
        } else if other_ending == ending {
            strsim::jaro(stem, other)
        } else {
            return None;
        };
        (score >= SIMILAR).then_some((score, name))
    };
    let best = names.filter_map(score).max_by(|(one, first), (other, second)| {
        // The first one of equals by name: a folder has no order of its own.
        one.total_cmp(other).then_with(|| second.cmp(first))
    });
    best.map(|(_, name)| path.with_file_name(name))
}
