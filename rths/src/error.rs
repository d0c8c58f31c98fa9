//! Why the benchmark has no result.

use files::{InputError, quoted};
use std::fmt;
use std::path::PathBuf;

/// Everything that can go wrong in this crate.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RthsError {
    /// A record that cannot be read.
    Input(InputError),
    /// A line of a record.
    Line {
        /// The file.
        file: PathBuf,
        /// Its line, from one.
        line: usize,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// A record as a whole.
    Record {
        /// The file.
        file: PathBuf,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// Stopped on request.
    Stopped,
}

impl RthsError {
    /// True where the user's input is at fault, false where the operation ended early.
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::Input(_) | Self::Line { .. } | Self::Record { .. } => true,
            Self::Stopped => false,
        }
    }
}

impl fmt::Display for RthsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(error) => error.fmt(f),
            Self::Line { file, line, found, expected } => {
                let file = file.display().to_string();
                write!(f, "{}:{line}: found {found}, expected {expected}", quoted(&file))
            }
            Self::Record { file, found, expected } => {
                let file = file.display().to_string();
                write!(f, "{}: found {found}, expected {expected}", quoted(&file))
            }
            Self::Stopped => write!(f, "stopped"),
        }
    }
}

impl std::error::Error for RthsError {}

impl From<InputError> for RthsError {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}
