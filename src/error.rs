//! Everything that can end a command early, and the exit code that each of it has.
//!
//! The error of another crate is one variant: one row in the table below, such as
//! `Bench(BenchError) => |why| input_or_failure(why.is_bad_input());`. Its own kind decides
//! whether the input is at fault ([`BAD_INPUT`]), the operation failed ([`FAILED`]), or the bench
//! ended in the safe state ([`SAFE_STATE`]).

use crate::exit::{BAD_INPUT, FAILED, INTERRUPTED, SAFE_STATE};
use evidence::EvidenceError;
use files::{FolderError, InputError};
use hil_host::BenchError;
use identification::IdentificationError;
use measurement::MeasurementError;
use rths::RthsError;
use scenario::source::ScenarioError;
use signal::SignalError;
use std::fmt;
use std::io;
use std::path::PathBuf;
use vehicle_studies::StudyError;
use virtual_bench::VisitError;

/// Declares [`CommandError`]: the errors of other crates with their exit codes, and the command
/// line's own.
macro_rules! command_error {
    ($($(#[$doc:meta])* $variant:ident($error:ty) => $code:expr;)*) => {
        /// Why a command ended early.
        #[derive(Debug)]
        pub(crate) enum CommandError {
            $($(#[$doc])* $variant(Box<$error>),)*
            /// An option, or two that do not go together: option with its value, what was expected.
            Option(String, String),
            /// Input that fits its format and not the command: file, found, expected.
            Input {
                /// The file.
                file: PathBuf,
                /// What was found.
                found: String,
                /// What was expected.
                expected: String,
            },
            /// A file that cannot be written: file, the system's reason.
            File(PathBuf, io::Error),
        }

        $(impl From<$error> for CommandError {
            fn from(why: $error) -> Self {
                Self::$variant(Box::new(why))
            }
        })*

        impl CommandError {
            /// The exit code that this error ends the program with.
            pub(crate) fn exit_code(&self) -> u8 {
                match self {
                    $(Self::$variant(why) => code_of(why, $code),)*
                    Self::Option(..) | Self::Input { .. } => BAD_INPUT,
                    Self::File(..) => FAILED,
                }
            }
        }

        impl fmt::Display for CommandError {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self {
                    $(Self::$variant(why) => write!(f, "{why}"),)*
                    Self::Option(option, expected) => {
                        write!(f, "{}: expected {expected}", files::quoted(option))
                    }
                    Self::Input { file, found, expected } => {
                        let file = file.display().to_string();
                        write!(f, "{}: found {found}, expected {expected}", files::quoted(&file))
                    }
                    Self::File(file, why) => {
                        write!(f, "{}: {why}", files::quoted(&file.display().to_string()))
                    }
                }
            }
        }
    };
}

command_error! {
    /// A scenario, vehicle, damper, rig or datasheet.
    Scenario(ScenarioError) => |why| input_or_failure(why.is_bad_input());
    /// A measured record.
    Measurement(MeasurementError) => |why| input_or_failure(why.is_bad_input());
    /// A file that is not read.
    InputFile(InputError) => |why| input_or_failure(why.is_bad_input());
    /// A folder that takes no result.
    Folder(FolderError) => |why| input_or_failure(why.is_bad_input());
    /// Shards that do not belong together.
    Shards(SignalError) => |why| input_or_failure(why.is_bad_input());
    /// Records that no damper follows.
    Identification(IdentificationError) => |why| input_or_failure(why.is_bad_input());
    /// A study of a vehicle that has no answer.
    Study(StudyError) => |why| input_or_failure(why.is_bad_input());
    /// A campaign, a reproduction or a reference that cannot be computed.
    Evidence(EvidenceError) => |why| input_or_failure(why.is_bad_input());
    /// A record of the ground that cannot be read.
    Rths(RthsError) => |why| input_or_failure(why.is_bad_input());
    /// A virtual visit that cannot be made.
    Visit(VisitError) => |why| input_or_failure(why.is_bad_input());
    /// A report page that is not written.
    Report(report::Error) => |_| FAILED;
    /// A run or a rig that ended early.
    Bench(BenchError) => |why| match () {
        () if why.is_safe_state() => SAFE_STATE,
        () if why.is_interrupted() => INTERRUPTED,
        () => input_or_failure(why.is_bad_input()),
    };
    /// Output that nothing takes, such as a full disk.
    Output(io::Error) => |_| FAILED;
    /// A result that is no JSON.
    Json(serde_json::Error) => |_| FAILED;
}

impl std::error::Error for CommandError {}

impl CommandError {
    /// An option with its value, and what was expected.
    pub(crate) fn option(option: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Option(option.into(), expected.into())
    }
}

/// The exit code of an error that knows whether the input is at fault.
const fn input_or_failure(is_bad_input: bool) -> u8 {
    if is_bad_input { BAD_INPUT } else { FAILED }
}

/// Applies a row's code to its error; gives the closure's argument its type.
fn code_of<E>(why: &E, code: impl Fn(&E) -> u8) -> u8 {
    code(why)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn the_exit_code_is_read_from_the_kind_of_the_error() {
        let full = || io::Error::from(io::ErrorKind::StorageFull);
        let scenario = || ScenarioError::mismatch(Path::new("a.toml"), "no");
        let silent = BenchError::SilentRigs { nodes: vec![1], bus: "memory".to_owned() };
        let folder = |error: FolderError| CommandError::from(error).exit_code();
        assert_eq!(CommandError::from(scenario()).exit_code(), BAD_INPUT);
        assert_eq!(CommandError::from(full()).exit_code(), FAILED);
        assert_eq!(CommandError::from(silent).exit_code(), SAFE_STATE);
        assert_eq!(folder(FolderError::Disk("a".into(), full())), FAILED);
        assert_eq!(folder(FolderError::Occupied("a".into())), BAD_INPUT);
        let option = CommandError::Option("--seeds 0".into(), "1 to 1000".into());
        assert_eq!(option.exit_code(), BAD_INPUT);
        assert_eq!(option.to_string(), "--seeds 0: expected 1 to 1000");
    }
}
