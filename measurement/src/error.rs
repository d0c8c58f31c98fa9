//! Why a measured record cannot be used, in one line.

use files::{InputError, quoted};
use scenario::source::ScenarioError;
use std::fmt;
use std::path::{Path, PathBuf};

/// Why a record cannot be used.
///
/// Text of a file inside `found` and `expected` is quoted: cut to a length, control characters
/// escaped.
#[derive(Debug)]
pub enum MeasurementError {
    /// The file cannot be read.
    Input(InputError),
    /// The mapping does not fit: file, line, message.
    Mapping(ScenarioError),
    /// The file as a whole.
    File {
        /// The file.
        file: PathBuf,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// One cell, or one row, of a file.
    Cell {
        /// The file.
        file: PathBuf,
        /// Its line, from one.
        row: usize,
        /// The column by its name in the file.
        column: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// One test of a file.
    Test {
        /// The file.
        file: PathBuf,
        /// Name of the test.
        test: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
}

impl MeasurementError {
    /// True where the user's input is at fault, false where an operation failed.
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::Input(_)
            | Self::Mapping(_)
            | Self::File { .. }
            | Self::Cell { .. }
            | Self::Test { .. } => true,
        }
    }
}

impl fmt::Display for MeasurementError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |file: &Path| quoted(&file.display().to_string()).to_string();
        match self {
            Self::Input(error) => write!(f, "{error}"),
            Self::Mapping(error) => write!(f, "{error}"),
            Self::File { file, found, expected } => {
                write!(f, "{}: found {found}, expected {expected}", shown(file))
            }
            Self::Cell { file, row, column, found, expected } => {
                let (file, column) = (shown(file), quoted(column));
                write!(f, "{file}:{row}: {column}: found {found}, expected {expected}")
            }
            Self::Test { file, test, found, expected } => {
                let (file, test) = (shown(file), quoted(test));
                write!(f, "{file}: test {test}: found {found}, expected {expected}")
            }
        }
    }
}

impl std::error::Error for MeasurementError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Input(error) => Some(error),
            Self::Mapping(error) => Some(error),
            Self::File { .. } | Self::Cell { .. } | Self::Test { .. } => None,
        }
    }
}

impl From<InputError> for MeasurementError {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}

impl From<ScenarioError> for MeasurementError {
    fn from(error: ScenarioError) -> Self {
        Self::Mapping(error)
    }
}
