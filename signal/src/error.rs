//! Why a signal is not analysed, or long work does not go on.

use files::{FolderError, InputError, quoted};
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Everything that can go wrong in this crate.
#[derive(Debug)]
pub enum SignalError {
    /// Fewer samples than the analysis needs: given, least.
    TooShort(usize, usize),
    /// A parameter outside its bounds: name, value, expected.
    Parameter(&'static str, f64, &'static str),
    /// A sample that is not a number: its index.
    NotFinite(usize),
    /// Text that names no shard: found.
    NoShard(String),
    /// A file that is not read.
    Input(InputError),
    /// A folder that takes no file.
    Folder(FolderError),
    /// A file that cannot be written or locked: file, the system's reason.
    File(PathBuf, io::Error),
    /// Another process computes the same shard: its file.
    InUse(PathBuf),
    /// A line that is no item: file, line, name of an item, reason.
    Line(PathBuf, usize, &'static str, String),
    /// Items of other work: file, found, expected.
    OtherWork(PathBuf, String, String),
    /// Items with another origin: file, line, what differs.
    OtherOrigin(PathBuf, usize, Vec<String>),
    /// Two results for one item: file, name of an item, number.
    Conflict(PathBuf, &'static str, usize),
    /// Files without any item: the first file, name of an item.
    NoItems(PathBuf, &'static str),
}

impl SignalError {
    /// True where the user's input is at fault, false where the operation failed.
    pub const fn is_bad_input(&self) -> bool {
        !matches!(self, Self::File(..) | Self::Folder(FolderError::Disk(..)))
    }
}

impl fmt::Display for SignalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |path: &Path| path.display().to_string();
        match self {
            Self::TooShort(given, least) => {
                write!(f, "signal has {given} samples, expected at least {least}")
            }
            Self::Parameter(name, value, expected) => {
                write!(f, "{name} = {value}, expected {expected}")
            }
            Self::NotFinite(index) => write!(f, "sample {index} of the signal is not finite"),
            Self::NoShard(found) => {
                write!(f, "found \"{}\", expected part/parts, such as 1/4", quoted(found))
            }
            Self::Input(why) => why.fmt(f),
            Self::Folder(why) => why.fmt(f),
            Self::File(path, why) => write!(f, "{}: {why}", quoted(&shown(path))),
            Self::InUse(path) => write!(
                f,
                "{}: another process is computing this shard, expected one process per shard",
                quoted(&shown(path))
            ),
            Self::Line(path, line, item, why) => write!(
                f,
                "{}:{line}: found no {item} ({why}), expected one {item} per line; without the line it \
                 is computed again",
                quoted(&shown(path))
            ),
            Self::OtherWork(path, found, expected) => write!(
                f,
                "{}: found {}, expected {}",
                quoted(&shown(path)),
                quoted(found),
                quoted(expected)
            ),
            Self::OtherOrigin(path, line, differences) => write!(
                f,
                "{}:{line}: found a result {}, expected one identity: run the shards again",
                quoted(&shown(path)),
                quoted(&differences.join(" and "))
            ),
            Self::Conflict(path, item, index) => write!(
                f,
                "{}: {item} {index} has another result in another file, expected the same",
                quoted(&shown(path))
            ),
            Self::NoItems(path, item) => {
                write!(f, "{}: found no {item}, expected at least one", quoted(&shown(path)))
            }
        }
    }
}

impl std::error::Error for SignalError {}

impl From<InputError> for SignalError {
    fn from(why: InputError) -> Self {
        Self::Input(why)
    }
}

impl From<FolderError> for SignalError {
    fn from(why: FolderError) -> Self {
        Self::Folder(why)
    }
}
