//! Ctrl-C and SIGTERM: the first one asks a command to end with what it has, the second one ends
//! the process at once.
//!
//! A command that has begun its work reads the flag ([`flag`]). Before that, while a command reads
//! its files, there is nothing to keep, and the first signal ends the process too.

use crate::exit;
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by the first signal.
static STOP: AtomicBool = AtomicBool::new(false);
/// The command reads [`STOP`].
static READ: AtomicBool = AtomicBool::new(false);

/// Installs the handler.
pub(crate) fn listen() {
    if let Err(why) = ctrlc::set_handler(on_signal) {
        eprintln!("warning: Ctrl-C ends the program without its files: {why}");
    }
}

/// The flag that the first Ctrl-C or SIGTERM sets; from this call on such a signal does nothing
/// else.
///
/// A command that calls this checks the flag at least every few hundred milliseconds, writes what
/// it has, and ends with [`exit::INTERRUPTED`]. One that only has files left to write ignores it.
pub(crate) fn flag() -> &'static AtomicBool {
    READ.store(true, Ordering::SeqCst);
    &STOP
}

/// Runs on a thread of its own, not inside the signal's handler.
fn on_signal() {
    let again = STOP.swap(true, Ordering::SeqCst);
    let message = match (again, READ.load(Ordering::SeqCst)) {
        (false, true) => return,
        (false, false) => "interrupted before the first result: no result is written",
        (true, _) => "interrupted twice: ended at once, files may be missing",
    };
    // Where nothing takes the message, the exit code still says it.
    let _ = writeln!(io::stderr(), "{message}");
    std::process::exit(i32::from(exit::INTERRUPTED));
}
