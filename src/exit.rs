//! Exit codes. An early end has the code of its error ([`CommandError::exit_code`]).
//!
//! [`CommandError::exit_code`]: crate::error::CommandError::exit_code

/// Everything that was asked for is done.
pub(crate) const DONE: u8 = 0;
/// A check or target failed, or an operation failed.
pub(crate) const FAILED: u8 = 1;
/// Bad input; nothing was written.
pub(crate) const BAD_INPUT: u8 = 2;
/// A fault ended the run: in the safe state, or ramped out.
pub(crate) const SAFE_STATE: u8 = 3;
/// Ctrl-C or SIGTERM ended the command; what it had is written.
pub(crate) const INTERRUPTED: u8 = 130;

/// The codes for `--help`.
pub(crate) const HELP: &str = "\
Exit codes:
  0    done
  1    a check or target failed, or an operation failed (a full disk, a bus that went down)
  2    bad input; nothing was written
  3    the run was ended by a fault: in the safe state, or ramped out
  130  interrupted by Ctrl-C or SIGTERM; what there was is written; a second signal
       ends at once (a run of rigs: in the safe state)";
