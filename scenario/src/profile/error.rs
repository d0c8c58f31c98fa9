//! What can be wrong with a profile or with a wheel on a rail.

use core::fmt;
use files::InputError;
use std::path::PathBuf;

/// A profile, or the pair of a wheel and a rail, that cannot be used.
#[derive(Debug)]
pub enum ProfileError {
    /// A file of points does not read as one.
    File {
        /// The file.
        path: PathBuf,
        /// Line in the file, counted from 1; 0 when it is about the whole file.
        row: usize,
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: String,
    },
    /// A file is not read.
    Input(InputError),
    /// A number is outside what the construction allows.
    OutOfRange {
        /// Name of the parameter, with its unit.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// Smallest permitted value.
        lowest: f64,
        /// Largest permitted value.
        highest: f64,
    },
}

impl fmt::Display for ProfileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { path, row: 0, found, expected } => {
                write!(f, "{}: found {found}, expected {expected}", path.display())
            }
            Self::File { path, row, found, expected } => {
                write!(f, "{}, row {row}: found {found}, expected {expected}", path.display())
            }
            Self::Input(error) => error.fmt(f),
            Self::OutOfRange { parameter, value, lowest, highest } => {
                write!(f, "{parameter} is {value}, must be within {lowest} and {highest}")
            }
        }
    }
}

impl core::error::Error for ProfileError {}

impl From<InputError> for ProfileError {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}

impl ProfileError {
    /// `value` when it lies within the bounds, an error that names it when not.
    pub(crate) fn check(
        parameter: &'static str,
        value: f64,
        lowest: f64,
        highest: f64,
    ) -> Result<f64, Self> {
        if value >= lowest && value <= highest {
            Ok(value)
        } else {
            Err(Self::OutOfRange { parameter, value, lowest, highest })
        }
    }
}
