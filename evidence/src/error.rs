//! Why a campaign, a figure or a reference has no numbers.

use files::quoted;
use firmware_core::damper::DamperError;
use identification::IdentificationError;
use measurement::MeasurementError;
use scenario::equilibrium::NoEquilibrium;
use scenario::source::ScenarioError;
use signal::SignalError;
use std::fmt;
use std::num::ParseFloatError;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use vehicle_studies::StudyError;

/// Everything that can go wrong in this crate.
#[derive(Debug)]
pub enum EvidenceError {
    /// A study of a vehicle that fails.
    Study(StudyError),
    /// A file that cannot be read.
    Scenario(ScenarioError),
    /// Records that cannot be evaluated.
    Measurement(MeasurementError),
    /// An identification without a result.
    Identification(IdentificationError),
    /// A vehicle without a yaw damper to vary: scenario.
    NoYawDamper(PathBuf),
    /// The content of files changed while the figures were computed: scenario.
    Changed(PathBuf),
    /// An error in one figure of the study: its number.
    InFigure(&'static str, Box<Self>),
    /// The vehicle left the track.
    OffTheTrack,
    /// A specimen that no strength makes possible: what it has.
    NotSimulated(&'static str),
    /// A fit without a result: what it gives.
    NoFit(&'static str),
    /// A reference that cannot be computed: what happened.
    NotComputed(&'static str),
    /// A limit cycle that does not end inside the range of speeds: where it does.
    NoFold(String),
    /// A table of published numbers without a column: expected.
    NoColumn(&'static str),
    /// A table of published numbers that cannot be read: reason.
    Table(String),
    /// A cell of a table that is no number.
    NoNumber(ParseFloatError),
    /// A question that cannot be serialised: reason.
    NotSerialised(String),
    /// Stopped on request.
    Stopped,
}

impl EvidenceError {
    /// The same error in a figure of the study, by its number. Work that is stopped is no error of
    /// a figure.
    pub(crate) fn in_figure(self, number: &'static str) -> Self {
        match self {
            Self::Stopped => Self::Stopped,
            why => Self::InFigure(number, Box::new(why)),
        }
    }

    /// Fails once a flag is set.
    ///
    /// # Errors
    /// [`EvidenceError::Stopped`].
    pub(crate) fn check(stop: &AtomicBool) -> Result<(), Self> {
        if stop.load(Ordering::Relaxed) { Err(Self::Stopped) } else { Ok(()) }
    }

    /// True where the user's input is at fault, false where the operation failed.
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::Study(why) => why.is_bad_input(),
            Self::InFigure(_, why) => why.is_bad_input(),
            Self::Scenario(why) => why.is_bad_input(),
            Self::NoYawDamper(_) => true,
            Self::Measurement(_)
            | Self::Identification(_)
            | Self::Changed(_)
            | Self::OffTheTrack
            | Self::NotSimulated(_)
            | Self::NoFit(_)
            | Self::NotComputed(_)
            | Self::NoFold(_)
            | Self::NoColumn(_)
            | Self::Table(_)
            | Self::NoNumber(_)
            | Self::NotSerialised(_)
            | Self::Stopped => false,
        }
    }
}

impl fmt::Display for EvidenceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Study(why) => why.fmt(f),
            Self::Scenario(why) => why.fmt(f),
            Self::Measurement(why) => why.fmt(f),
            Self::Identification(why) => why.fmt(f),
            Self::NoYawDamper(path) => write!(
                f,
                "{}: the vehicle has no yaw damper to vary",
                quoted(&path.display().to_string())
            ),
            Self::Changed(path) => write!(
                f,
                "{}: its files changed while the figures were computed, expected the same content \
                 throughout: run the command again",
                quoted(&path.display().to_string())
            ),
            Self::InFigure(number, why) => write!(f, "figure {number}: {why}"),
            Self::OffTheTrack => write!(f, "off the track"),
            Self::NotSimulated(what) => write!(f, "{what} cannot be simulated"),
            Self::NoFit(what) => write!(f, "no damper {what}"),
            Self::NotComputed(what) => write!(f, "{what}"),
            Self::NoFold(dies) => write!(f, "the limit cycle ends {dies} km/h"),
            Self::NoColumn(head) => write!(f, "no column {head}"),
            Self::Table(why) => write!(f, "{}", quoted(why)),
            Self::NoNumber(why) => why.fmt(f),
            Self::NotSerialised(why) => write!(f, "the question cannot be serialised: {why}"),
            Self::Stopped => write!(f, "interrupted"),
        }
    }
}

impl std::error::Error for EvidenceError {}

impl From<StudyError> for EvidenceError {
    fn from(why: StudyError) -> Self {
        match why {
            StudyError::Stopped => Self::Stopped,
            why => Self::Study(why),
        }
    }
}

impl From<ScenarioError> for EvidenceError {
    fn from(why: ScenarioError) -> Self {
        Self::Scenario(why)
    }
}

impl From<MeasurementError> for EvidenceError {
    fn from(why: MeasurementError) -> Self {
        Self::Measurement(why)
    }
}

impl From<IdentificationError> for EvidenceError {
    fn from(why: IdentificationError) -> Self {
        match why {
            IdentificationError::Interrupted => Self::Stopped,
            why => Self::Identification(why),
        }
    }
}

impl From<DamperError> for EvidenceError {
    fn from(why: DamperError) -> Self {
        Self::Study(why.into())
    }
}

impl From<NoEquilibrium> for EvidenceError {
    fn from(why: NoEquilibrium) -> Self {
        Self::Study(why.into())
    }
}

impl From<SignalError> for EvidenceError {
    fn from(why: SignalError) -> Self {
        Self::Study(why.into())
    }
}

impl From<ParseFloatError> for EvidenceError {
    fn from(why: ParseFloatError) -> Self {
        Self::NoNumber(why)
    }
}
