//! Why a study cannot be asked, or a point has no answer.

use files::{InputError, quoted};
use firmware_core::damper::DamperError;
use scenario::equilibrium::NoEquilibrium;
use scenario::source::ScenarioError;
use signal::SignalError;
use std::fmt;
use std::path::{Path, PathBuf};

/// Everything that can go wrong in this crate.
#[derive(Debug)]
pub enum StudyError {
    /// A scenario that cannot be read.
    Scenario(ScenarioError),
    /// A table of a user that cannot be read.
    Input(InputError),
    /// A table of a user that does not fit.
    Table {
        /// The file.
        file: PathBuf,
        /// Its line, from one; none for the file as a whole.
        line: Option<usize>,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// A damper that cannot be.
    Damper(DamperError),
    /// A vehicle that does not run steadily.
    NoSteadyRunning(NoEquilibrium),
    /// A signal that cannot be analysed, or the file of a shard.
    Signal(SignalError),
    /// The vehicle left the track: where (m).
    OffTheTrack(f64),
    /// An error on one of several tracks: its number from 1.
    OnTrack(usize, Box<Self>),
    /// A study without any track.
    NoTrack,
    /// A vehicle without a damper.
    NoDamper,
    /// The rig of one bogie stands for a damper of another: place of the damper, of the rig.
    OtherBogie(String, String),
    /// A delay that no rig keeps (s).
    NoDelay(f64),
    /// A track without a curve.
    NoCurve,
    /// A track without irregularity.
    NoIrregularity,
    /// A vehicle that does not do what it is compared with: its dampers, what it should do.
    NoReference(&'static str, &'static str),
    /// No body with this name: expected, the names there are.
    NoBody(&'static str, Vec<String>),
    /// An error in a file that does not name it.
    InFile(PathBuf, Box<Self>),
    /// The content of files changed while the study ran: scenario, what changed.
    Changed(PathBuf, Vec<String>),
    /// Text that is no axis of a grid: found.
    NoAxis(String),
    /// An axis with too few values or too many: number of values, axis, most values.
    AxisCount(usize, String, usize),
    /// An axis that holds a value twice: the axis.
    ValueTwice(String),
    /// Two axes of the same key: the key.
    KeyTwice(String),
    /// A grid with too many points: number of points, most points.
    TooManyPoints(usize, usize),
    /// A question that cannot be serialised: reason.
    NotSerialised(String),
    /// Stopped on request.
    Stopped,
}

impl StudyError {
    /// The same error on one of several tracks, by its number from 1. Work that is stopped is
    /// stopped on all of them.
    pub(crate) fn on_track(self, number: usize) -> Self {
        match self {
            Self::Stopped => Self::Stopped,
            why => Self::OnTrack(number, Box::new(why)),
        }
    }

    /// True where the user's input is at fault, false where the operation failed.
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::OnTrack(_, why) | Self::InFile(_, why) => why.is_bad_input(),
            Self::Signal(
                SignalError::TooShort(..) | SignalError::Parameter(..) | SignalError::NotFinite(_),
            )
            | Self::NoSteadyRunning(_)
            | Self::OffTheTrack(_)
            | Self::NoTrack
            | Self::NotSerialised(_)
            | Self::Stopped
            | Self::Changed(..) => false,
            Self::Signal(why) => why.is_bad_input(),
            Self::Scenario(_)
            | Self::Input(_)
            | Self::Table { .. }
            | Self::Damper(_)
            | Self::NoDamper
            | Self::OtherBogie(..)
            | Self::NoDelay(_)
            | Self::NoCurve
            | Self::NoIrregularity
            | Self::NoReference(..)
            | Self::NoBody(..)
            | Self::NoAxis(_)
            | Self::AxisCount(..)
            | Self::ValueTwice(_)
            | Self::KeyTwice(_)
            | Self::TooManyPoints(..) => true,
        }
    }
}

impl fmt::Display for StudyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |path: &Path| path.display().to_string();
        match self {
            Self::Scenario(why) => why.fmt(f),
            Self::Input(why) => why.fmt(f),
            Self::Table { file, line, found, expected } => {
                let file = shown(file);
                let place = line.map_or_else(String::new, |line| format!(":{line}"));
                write!(f, "{}{place}: found {found}, expected {expected}", quoted(&file))
            }
            Self::Damper(why) => why.fmt(f),
            Self::NoSteadyRunning(why) => why.fmt(f),
            Self::Signal(why) => why.fmt(f),
            Self::OffTheTrack(at_m) => write!(f, "off the track at {at_m:.0} m"),
            Self::OnTrack(number, why) => write!(f, "track {number}: {why}"),
            Self::NoTrack => write!(f, "found no track, expected at least one"),
            Self::NoDamper => write!(f, "found no damper slot, expected one that can be on a rig"),
            Self::OtherBogie(place, of) => write!(
                f,
                "slot \"{place}\" is on = \"other_bogie\" of \"{of}\", expected a model, a rig or \
                 its partner: a force that another bogie has made gives no critical speed and no \
                 ride"
            ),
            Self::NoDelay(delay_s) => {
                let found_ms = files::number(1e3 * delay_s);
                write!(f, "found a rig that is late by {found_ms} ms, expected at most 63.5 ms")
            }
            Self::NoCurve => write!(f, "the track has no curve, expected [track.curve]"),
            Self::NoIrregularity => {
                write!(f, "the track has no irregularity, expected [track.irregularity]")
            }
            Self::NoReference(damper, regime) => write!(
                f,
                "all-model run, {damper} dampers, {regime}: found no steady motion to compare with, \
                 expected one on the track"
            ),
            Self::NoBody(name, names) => {
                write!(f, "no body is named \"{name}\", found {}", quoted(&names.join(", ")))
            }
            Self::InFile(path, why) => write!(f, "{}: {why}", quoted(&shown(path))),
            Self::Changed(path, changes) => write!(
                f,
                "{}: changed while the study ran ({}), expected the same content throughout: run the \
                 study again",
                quoted(&shown(path)),
                changes.join(", ")
            ),
            Self::NoAxis(text) => write!(
                f,
                "found \"{}\", expected KEY=from:to:n, KEY=value,value or KEY*=factors",
                quoted(text)
            ),
            Self::AxisCount(count, text, most) => {
                write!(f, "found {count} values in \"{}\", expected 2 to {most}", quoted(text))
            }
            Self::ValueTwice(text) => {
                write!(f, "found a value twice in \"{}\", expected each once", quoted(text))
            }
            Self::KeyTwice(key) => {
                write!(f, "`{}` is varied twice, expected each key once", quoted(key))
            }
            Self::TooManyPoints(points, most) => {
                write!(f, "found {points} points of all keys together, expected at most {most}")
            }
            Self::NotSerialised(why) => write!(f, "the question cannot be serialised: {why}"),
            Self::Stopped => write!(f, "interrupted"),
        }
    }
}

impl std::error::Error for StudyError {}

impl From<ScenarioError> for StudyError {
    fn from(why: ScenarioError) -> Self {
        Self::Scenario(why)
    }
}

impl From<InputError> for StudyError {
    fn from(why: InputError) -> Self {
        Self::Input(why)
    }
}

impl From<DamperError> for StudyError {
    fn from(why: DamperError) -> Self {
        Self::Damper(why)
    }
}

impl From<NoEquilibrium> for StudyError {
    fn from(why: NoEquilibrium) -> Self {
        Self::NoSteadyRunning(why)
    }
}

impl From<SignalError> for StudyError {
    fn from(why: SignalError) -> Self {
        Self::Signal(why)
    }
}
