//! Why a rig cannot be driven by its own messages.

use super::loss::{Loss, names};
use dbc::DbcError;
use files::quoted;
use scenario::source::ScenarioError;
use std::fmt;
use std::path::{Path, PathBuf};

/// Why a rig cannot be driven by its own messages.
#[derive(Debug)]
pub enum GatewayError {
    /// The DBC, or a signal of it.
    Dbc(DbcError),
    /// The map is no map.
    Map(ScenarioError),
    /// A key of the map that does not fit the DBC or the rest of the map.
    Key {
        /// The map.
        file: PathBuf,
        /// Its line.
        line: Option<usize>,
        /// Table and key, `[command] velocity`.
        key: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// A signal whose unit is not known.
    Unit {
        /// The DBC.
        file: PathBuf,
        /// Its line.
        line: Option<usize>,
        /// Message and signal.
        signal: String,
        /// The unit.
        unit: String,
        /// The units that are known.
        expected: &'static str,
    },
    /// The rig neither counts its measurements nor stops by itself.
    OpenLoopOnly {
        /// The map.
        file: PathBuf,
    },
    /// Losses that nobody has accepted.
    Unaccepted {
        /// The map.
        file: PathBuf,
        /// All losses, accepted ones included.
        all: Vec<Loss>,
        /// Those that are not accepted.
        missing: Vec<Loss>,
    },
    /// The bus is not one CAN interface with one rig.
    Bus {
        /// What was found.
        found: String,
    },
    /// Slow-down, which the messages of the rig cannot say.
    SlowDown {
        /// The factor.
        found: u8,
    },
    /// A rate above the usual one: the preparation and the time-outs of the rig are made for it.
    Rate {
        /// The rate (Hz).
        found_hz: u32,
    },
}

impl GatewayError {
    /// True: files or options that the user gave are at fault.
    pub const fn is_bad_input(&self) -> bool {
        true
    }
}

impl From<DbcError> for GatewayError {
    fn from(why: DbcError) -> Self {
        Self::Dbc(why)
    }
}

impl From<ScenarioError> for GatewayError {
    fn from(why: ScenarioError) -> Self {
        Self::Map(why)
    }
}

fn shown(file: &Path) -> String {
    quoted(&file.display().to_string()).to_string()
}

/// A file, with its line where it is known.
fn place(file: &Path, line: Option<usize>) -> String {
    line.map_or_else(|| shown(file), |line| format!("{}:{line}", shown(file)))
}

impl fmt::Display for GatewayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Dbc(why) => why.fmt(f),
            Self::Map(why) => why.fmt(f),
            Self::Key { file, line, key, found, expected } => {
                let (place, found) = (place(file, *line), quoted(found));
                write!(f, "{place}: {key}: found {found}, expected {expected}")
            }
            Self::Unit { file, line, signal, unit, expected } => write!(
                f,
                "{}: signal {}: found unit \"{}\", expected {expected}, or unit or scale in the map",
                place(file, *line),
                quoted(signal),
                quoted(unit)
            ),
            Self::OpenLoopOnly { file } => write!(
                f,
                "{}: found neither [measurement] counter nor [status] timeout_s, expected one of \
                 them: a rig that neither counts its measurements nor stops by itself may only be \
                 moved in OPEN_LOOP, and is not coupled to a vehicle",
                shown(file)
            ),
            Self::Unaccepted { file, all, missing } => write!(
                f,
                "{}: found losses that are not accepted ({}), expected --accept {}",
                shown(file),
                names(missing),
                names(all)
            ),
            Self::Bus { found } => write!(
                f,
                "--dbc: found {}, expected one rig on --bus socketcan:INTERFACE",
                quoted(found)
            ),
            Self::SlowDown { found } => write!(
                f,
                "--slow-down: found {found}, expected 1 with --dbc: the rig's own messages cannot \
                 say it"
            ),
            Self::Rate { found_hz } => {
                write!(f, "rate_hz: found {found_hz}, expected 1000 with --dbc")
            }
        }
    }
}

impl std::error::Error for GatewayError {}
