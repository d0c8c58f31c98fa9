//! What is wrong with a message database.

use files::{InputError, quoted};
use std::fmt;
use std::path::PathBuf;

/// Why a DBC, or a signal of it, cannot be used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DbcError {
    /// The file is not read.
    Input(InputError),
    /// The text is no DBC.
    Syntax {
        /// The file.
        file: PathBuf,
        /// The line, where the parser names one.
        line: Option<usize>,
        /// What the parser expected.
        message: String,
    },
    /// A signal whose bits or values cannot be used.
    Signal {
        /// The file.
        file: PathBuf,
        /// Its line.
        line: Option<usize>,
        /// Message and signal.
        signal: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: &'static str,
    },
    /// A message whose name or identifier another one has too.
    Twice {
        /// The file.
        file: PathBuf,
        /// Its line.
        line: Option<usize>,
        /// The message.
        message: String,
        /// What was found.
        found: String,
    },
    /// A name that no signal has.
    NoSignal {
        /// The file.
        file: PathBuf,
        /// The name.
        name: String,
        /// A similar name, in words.
        similar: String,
    },
    /// A name that several signals have.
    Ambiguous {
        /// The file.
        file: PathBuf,
        /// The name.
        name: String,
        /// Their names with their messages.
        signals: Vec<String>,
    },
}

impl DbcError {
    /// True: the file that the user named is at fault.
    pub const fn is_bad_input(&self) -> bool {
        true
    }
}

impl From<InputError> for DbcError {
    fn from(why: InputError) -> Self {
        Self::Input(why)
    }
}

/// A file, with its line where it is known.
fn place(file: &std::path::Path, line: Option<usize>) -> String {
    let file = quoted(&file.display().to_string()).to_string();
    line.map_or(file.clone(), |line| format!("{file}:{line}"))
}

impl fmt::Display for DbcError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(why) => why.fmt(f),
            Self::Syntax { file, line, message } => {
                write!(f, "{}: found no DBC, {}", place(file, *line), quoted(message))
            }
            Self::Signal { file, line, signal, found, expected } => write!(
                f,
                "{}: signal {}: found {}, expected {expected}",
                place(file, *line),
                quoted(signal),
                quoted(found)
            ),
            Self::Twice { file, line, message, found } => write!(
                f,
                "{}: message {}: found {}, expected a name and an identifier of its own",
                place(file, *line),
                quoted(message),
                quoted(found)
            ),
            Self::NoSignal { file, name, similar } => write!(
                f,
                "{}: found no signal \"{}\", expected the name of one{similar}",
                place(file, None),
                quoted(name)
            ),
            Self::Ambiguous { file, name, signals } => {
                let signals: Vec<String> =
                    signals.iter().map(|name| quoted(name).to_string()).collect();
                write!(
                    f,
                    "{}: found several signals \"{}\", expected one of {}",
                    place(file, None),
                    quoted(name),
                    signals.join(", ")
                )
            }
        }
    }
}

impl std::error::Error for DbcError {}
