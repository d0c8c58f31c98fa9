//! Why a virtual bench cannot do what it is asked, in one line.

use files::quoted;
use measurement::MeasurementError;
use scenario::source::ScenarioError;
use std::fmt;
use std::path::PathBuf;

/// Why there is no visit, or no figures.
#[derive(Debug)]
pub enum VisitError {
    /// A damper, a list of tests or a datasheet does not fit.
    Scenario(ScenarioError),
    /// A record does not fit.
    Measurement(MeasurementError),
    /// A test leads beyond the stroke of a damper.
    Reach {
        /// The file of the damper.
        file: PathBuf,
        /// Name of the test.
        test: String,
        /// How far the test leads from mid-stroke, m.
        reach_m: f64,
        /// How far the damper goes, m.
        half_stroke_m: f64,
    },
}

impl VisitError {
    /// True where the user's input is at fault, false where an operation failed.
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::Scenario(_) | Self::Reach { .. } => true,
            Self::Measurement(error) => error.is_bad_input(),
        }
    }
}

impl fmt::Display for VisitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scenario(error) => write!(f, "{error}"),
            Self::Measurement(error) => write!(f, "{error}"),
            Self::Reach { file, test, reach_m, half_stroke_m } => {
                let file = file.display().to_string();
                let (file, test) = (quoted(&file), quoted(test));
                write!(
                    f,
                    "{file}: test \"{test}\" goes to {reach_m} m, expected within \
                     half_stroke_m = {half_stroke_m}"
                )
            }
        }
    }
}

impl std::error::Error for VisitError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Scenario(error) => Some(error),
            Self::Measurement(error) => Some(error),
            Self::Reach { .. } => None,
        }
    }
}

impl From<ScenarioError> for VisitError {
    fn from(error: ScenarioError) -> Self {
        Self::Scenario(error)
    }
}

impl From<MeasurementError> for VisitError {
    fn from(error: MeasurementError) -> Self {
        Self::Measurement(error)
    }
}
