//! What can be wrong with a measured record, in one line.

use scenario::source::ScenarioError;
use std::fmt;
use std::path::PathBuf;

/// Why a record cannot be used.
#[derive(Debug, Clone, PartialEq)]
pub enum MeasurementError {
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

impl fmt::Display for MeasurementError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mapping(error) => write!(f, "{error}"),
            Self::File { file, found, expected } => {
                write!(f, "{}: found {found}, expected {expected}", file.display())
            }
            Self::Cell { file, row, column, found, expected } => {
                let file = file.display();
                write!(f, "{file}:{row}: {column}: found {found}, expected {expected}")
            }
            Self::Test { file, test, found, expected } => {
                let file = file.display();
                write!(f, "{file}: test {test}: found {found}, expected {expected}")
            }
        }
    }
}

impl std::error::Error for MeasurementError {}

impl From<ScenarioError> for MeasurementError {
    fn from(error: ScenarioError) -> Self {
        Self::Mapping(error)
    }
}
