//! What is wrong with an input, in one line: file, line, key, what was found, what was expected.

use crate::equilibrium::NoEquilibrium;
use crate::kind::Kind;
use files::{InputError, did_you_mean, number, quoted};
use std::fmt;
use std::path::{Path, PathBuf};

/// Why a scenario, or a file that it names, cannot be used.
///
/// Text of a file is quoted in it: cut to a length, control characters escaped.
#[derive(Debug, Clone, PartialEq)]
pub enum ScenarioError {
    /// A file cannot be read.
    Input(InputError),
    /// A text is no TOML of the expected form.
    Syntax {
        /// Where.
        at: Place,
        /// What the parser says: the key, what it found, what it expected.
        message: String,
    },
    /// A file is of another kind: a vehicle in the place of a scenario.
    Kind {
        /// Where the first key stands that does not belong there.
        at: Place,
        /// What the file is.
        found: Kind,
        /// What was expected.
        expected: Kind,
        /// What the parser says about the key.
        message: String,
    },
    /// A number is outside its range.
    Value {
        /// Where.
        at: Place,
        /// The key of the number.
        key: Box<str>,
        /// The number.
        found: f64,
        /// The range in words.
        expected: String,
    },
    /// A number that an option of the command line gives is outside its range.
    Option {
        /// The option.
        option: &'static str,
        /// The number.
        found: f64,
        /// The range in words.
        expected: String,
    },
    /// Parts do not fit each other: a name that does not exist, a list of another length.
    Mismatch {
        /// Where.
        at: Place,
        /// What was found and what was expected.
        message: String,
    },
    /// A setting leads nowhere.
    Setting {
        /// The file it was for.
        file: PathBuf,
        /// Its key.
        key: String,
        /// Why it cannot be set.
        why: SettingError,
    },
    /// A file of points is no profile.
    Points {
        /// The file.
        file: PathBuf,
        /// Line in the file, counted from 1; none for the file as a whole.
        row: Option<usize>,
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: String,
    },
    /// A profile, or a wheel on a rail, has a dimension outside what the construction allows.
    Dimension {
        /// The file that asks for it, where one does.
        file: Option<PathBuf>,
        /// Name of the dimension, with its unit.
        name: &'static str,
        /// Its value.
        found: f64,
        /// Smallest permitted value.
        lowest: f64,
        /// Largest permitted value.
        highest: f64,
    },
    /// A vehicle has no steady motion to start from.
    Equilibrium {
        /// The file of the vehicle, or the scenario.
        file: PathBuf,
        /// The part of the scenario that asks for it, where one does.
        part: Option<&'static str>,
        /// How far off it is.
        error: NoEquilibrium,
    },
}

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: PathBuf,
    /// Line in it, from 1, where there is one.
    pub line: Option<usize>,
    /// The table, where the text is not the file's own and has no lines.
    pub table: Option<Box<str>>,
}

/// Why a setting leads nowhere.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SettingError {
    /// The key is empty.
    NoKey,
    /// No number stands there that could be multiplied.
    NoNumber,
    /// A key leads through something that is no table: its name, what it is.
    NotATable(String, &'static str),
    /// A key ends at a list.
    List(String),
    /// A list has no such table: list, table, names of its tables.
    Absent(String, String, Vec<String>),
    /// The changed file cannot be written as TOML.
    Unwritable(String),
}

impl ScenarioError {
    /// True where the user's input is at fault, false where an operation failed.
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::Input(_)
            | Self::Syntax { .. }
            | Self::Kind { .. }
            | Self::Value { .. }
            | Self::Option { .. }
            | Self::Mismatch { .. }
            | Self::Setting { .. }
            | Self::Points { .. }
            | Self::Dimension { .. }
            | Self::Equilibrium { .. } => true,
        }
    }

    /// The place in a file, where the error has one.
    pub const fn place(&self) -> Option<&Place> {
        match self {
            Self::Syntax { at, .. }
            | Self::Kind { at, .. }
            | Self::Value { at, .. }
            | Self::Mismatch { at, .. } => Some(at),
            _ => None,
        }
    }

    /// Parts of a file that do not fit each other.
    pub fn mismatch(file: &Path, message: impl Into<String>) -> Self {
        Self::Mismatch { at: Place::whole(file), message: message.into() }
    }

    /// `found` where it lies within the bounds; an error that names it where it does not.
    pub(crate) fn check_dimension(
        name: &'static str,
        found: f64,
        lowest: f64,
        highest: f64,
    ) -> Result<f64, Self> {
        if found >= lowest && found <= highest {
            Ok(found)
        } else {
            Err(Self::Dimension { file: None, name, found, lowest, highest })
        }
    }

    /// The same error, of a dimension that a file asks for.
    pub(crate) fn asked_by(self, path: &Path) -> Self {
        match self {
            Self::Dimension { file: None, name, found, lowest, highest } => {
                Self::Dimension { file: Some(path.to_owned()), name, found, lowest, highest }
            }
            other => other,
        }
    }
}

impl Place {
    /// A file as a whole.
    pub fn whole(file: &Path) -> Self {
        Self { file: file.to_owned(), line: None, table: None }
    }
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(error) => error.fmt(f),
            Self::Syntax { at, message } | Self::Mismatch { at, message } => {
                write!(f, "{at}{message}")
            }
            Self::Kind { at, found, expected, message } => {
                write!(f, "{at}found {found}, expected {expected} ({message})")
            }
            Self::Value { at, key, found, expected } => {
                write!(f, "{at}{key} = {}, expected {expected}", number(*found))
            }
            Self::Option { option, found, expected } => {
                write!(f, "{option} {}: expected {expected}", number(*found))
            }
            Self::Setting { file, key, why } => {
                write!(f, "{}: cannot set `{}`: {why}", shown(file), quoted(key))
            }
            Self::Points { file, row, found, expected } => {
                f.write_str(&shown(file))?;
                if let Some(row) = row {
                    write!(f, ", row {row}")?;
                }
                write!(f, ": found {found}, expected {expected}")
            }
            Self::Dimension { file, name, found, lowest, highest } => {
                if let Some(file) = file {
                    write!(f, "{}: ", shown(file))?;
                }
                let [found, lowest, highest] = [found, lowest, highest].map(|value| number(*value));
                write!(f, "{name} is {found}, must be within {lowest} and {highest}")
            }
            Self::Equilibrium { file, part, error } => {
                write!(f, "{}: ", shown(file))?;
                if let Some(part) = part {
                    write!(f, "{part}: ")?;
                }
                error.fmt(f)
            }
        }
    }
}

impl std::error::Error for ScenarioError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Input(error) => Some(error),
            Self::Equilibrium { error, .. } => Some(error),
            _ => None,
        }
    }
}

impl From<InputError> for ScenarioError {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&shown(&self.file))?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        f.write_str(": ")?;
        self.table.as_ref().map_or(Ok(()), |table| write!(f, "{}: ", quoted(table)))
    }
}

impl fmt::Display for SettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoKey => f.write_str("a key is expected"),
            Self::NoNumber => f.write_str("no number stands there, expected one to multiply"),
            Self::NotATable(name, found) => {
                write!(f, "{} is a {found}, expected a table", quoted(name))
            }
            Self::List(name) => {
                write!(f, "{} is a list, expected a name or a number behind it", quoted(name))
            }
            Self::Absent(list, name, known) => {
                let similar = did_you_mean(name, known.iter().map(String::as_str));
                let known: Vec<String> =
                    known.iter().map(|name| quoted(name).to_string()).collect();
                let (list, name, known) = (quoted(list), quoted(name), known.join(", "));
                write!(f, "{list} has no \"{name}\", expected one of {known}, or *{similar}")
            }
            Self::Unwritable(message) => f.write_str(message),
        }
    }
}

/// A path in a message.
fn shown(path: &Path) -> String {
    quoted(&path.display().to_string()).to_string()
}
