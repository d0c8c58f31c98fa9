//! Exit codes: 0 done; 1 a check or target failed, or an operation failed; 2 bad input, nothing
//! written; 3 ended in the safe state; 130 interrupted by Ctrl-C or SIGTERM.

use hil_host::run::SilentRigs;

/// Something failed that is not the input's fault.
pub(crate) const FAILED: u8 = 1;
/// Bad input.
pub(crate) const BAD_INPUT: u8 = 2;
/// The run ended in the safe state.
pub(crate) const SAFE_STATE: u8 = 3;
/// Ctrl-C or SIGTERM ended the command; what it had is written.
pub(crate) const INTERRUPTED: u8 = 130;

/// The exit code of an error.
pub(crate) fn code(error: &anyhow::Error) -> u8 {
    match () {
        () if error.is::<SilentRigs>() => SAFE_STATE,
        // The run itself went on; its files could not be written.
        () if error.is::<std::io::Error>() => FAILED,
        () => BAD_INPUT,
    }
}
