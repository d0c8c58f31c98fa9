//! Why a result is not written where it should be.

use crate::quote::quoted;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a result has no place.
#[derive(Debug)]
pub enum FolderError {
    /// The folder cannot be made: its path, the system's word.
    NoPlace(PathBuf, io::Error),
    /// It holds a result: folder, of which command.
    Holds(PathBuf, String),
    /// It holds the result of another kind of command, which is never replaced: folder, the kind
    /// found, the kind expected.
    OtherCommand(PathBuf, String, &'static str),
    /// It holds no result of the command: folder, the command whose result it holds, the command
    /// expected.
    NoResult(PathBuf, Option<String>, &'static str),
    /// It holds the result of another question: folder, name found, name expected, what differs.
    Other(PathBuf, String, String, Vec<String>),
    /// A file is in the way that the program did not write.
    Occupied(PathBuf),
    /// The result to be replaced is an input of the command: the input.
    IsInput(PathBuf),
    /// The folder's manifest cannot be believed: file, why.
    Manifest(PathBuf, String),
    /// A disk that fails: file, the system's word.
    Disk(PathBuf, io::Error),
}

impl fmt::Display for FolderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |path: &Path| path.display().to_string();
        match self {
            Self::NoPlace(path, why) => {
                let path = shown(path);
                write!(f, "{}: found no place for a folder ({why}), expected one", quoted(&path))
            }
            Self::Holds(path, command) => write!(
                f,
                "--out {}: holds a result of `{}`, expected a new folder; --overwrite replaces it",
                quoted(&shown(path)),
                quoted(command)
            ),
            Self::OtherCommand(path, found, expected) => write!(
                f,
                "--out {}: holds a result of `{}`, expected one of `{expected}` or a new folder; \
                 --overwrite replaces results of the same command only",
                quoted(&shown(path)),
                quoted(found)
            ),
            Self::NoResult(path, found, expected) => {
                let found = found.as_ref().map_or("no result".to_owned(), |found| {
                    format!("a result of `{}`", quoted(found))
                });
                let path = shown(path);
                write!(f, "{}: found {found}, expected one of `{expected}`", quoted(&path))
            }
            Self::Other(path, found, expected, changes) => write!(
                f,
                "--out {}: holds {found}, expected {expected} or a new folder; changed: {}",
                quoted(&shown(path)),
                changes.join(", ")
            ),
            Self::Occupied(path) => write!(
                f,
                "{}: is there already and was not written by this program, expected another --out",
                quoted(&shown(path))
            ),
            Self::IsInput(path) => write!(
                f,
                "{}: is an input of this command and part of the result to be replaced, expected \
                 another --out",
                quoted(&shown(path))
            ),
            Self::Manifest(path, why) => write!(f, "{}: {why}", quoted(&shown(path))),
            Self::Disk(path, why) => write!(f, "{}: {why}", quoted(&shown(path))),
        }
    }
}

impl FolderError {
    /// True where the user named a folder that cannot take the result, false where a disk fails.
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::NoPlace(..)
            | Self::Holds(..)
            | Self::OtherCommand(..)
            | Self::NoResult(..)
            | Self::Other(..)
            | Self::Occupied(..)
            | Self::IsInput(..)
            | Self::Manifest(..) => true,
            Self::Disk(..) => false,
        }
    }
}

impl std::error::Error for FolderError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::NoPlace(_, why) | Self::Disk(_, why) => Some(why),
            _ => None,
        }
    }
}
