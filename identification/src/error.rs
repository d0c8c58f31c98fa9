//! Why there is no identification.

use measurement::MeasurementError;
use scenario::source::ScenarioError;
use std::fmt;
use std::path::{Path, PathBuf};

/// Why there is no identification, in one line.
#[derive(Debug)]
pub enum IdentificationError {
    /// A record or its mapping is at fault.
    Record(Box<MeasurementError>),
    /// The datasheet is at fault.
    Datasheet(ScenarioError),
    /// A file is a training record and a hold-out record.
    TrainAndHoldout(PathBuf),
    /// A file is given twice.
    GivenTwice(PathBuf),
    /// Two files hold the same numbers.
    SameNumbers {
        /// The later of them.
        file: PathBuf,
        /// The earlier one.
        of: PathBuf,
    },
    /// No training test has samples beyond its run-in.
    NothingToFit,
    /// No damper follows the records at all.
    NoFit,
    /// No body follows the records at all.
    NoBody,
    /// A record of a body has another output than the first one.
    OtherOutput {
        /// The file.
        file: PathBuf,
        /// Its output.
        found: &'static str,
        /// That of the first record.
        expected: &'static str,
    },
    /// The work was stopped before the nominal damper was fitted.
    Interrupted,
}

impl IdentificationError {
    /// True where the input is at fault; false where the work was interrupted.
    pub const fn is_bad_input(&self) -> bool {
        !matches!(self, Self::Interrupted)
    }
}

impl fmt::Display for IdentificationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let quoted = |path: &Path| files::quoted(&path.display().to_string()).to_string();
        match self {
            Self::Record(error) => write!(f, "{error}"),
            Self::Datasheet(error) => write!(f, "{error}"),
            Self::TrainAndHoldout(file) => {
                let file = quoted(file);
                write!(f, "{file}: both in --train and in --holdout, expected in one of them")
            }
            Self::GivenTwice(file) => {
                write!(f, "{}: given twice, expected each record once", quoted(file))
            }
            Self::SameNumbers { file, of } => {
                let (file, of) = (quoted(file), quoted(of));
                write!(f, "{file}: found the same numbers as in {of}, expected each record once")
            }
            Self::NothingToFit => {
                write!(f, "found no training test with samples beyond its run-in, expected one")
            }
            Self::NoFit => write!(f, "found no damper that follows these records at all"),
            Self::NoBody => write!(f, "found no body that follows these records at all"),
            Self::OtherOutput { file, found, expected } => {
                write!(
                    f,
                    "{}: found {found} as the output, expected {expected} as in the first record",
                    quoted(file)
                )
            }
            Self::Interrupted => {
                write!(f, "interrupted before the nominal damper was fitted, nothing was written")
            }
        }
    }
}

impl std::error::Error for IdentificationError {}

impl From<MeasurementError> for IdentificationError {
    fn from(error: MeasurementError) -> Self {
        Self::Record(Box::new(error))
    }
}

impl From<ScenarioError> for IdentificationError {
    fn from(error: ScenarioError) -> Self {
        Self::Datasheet(error)
    }
}
