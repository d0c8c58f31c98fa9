//! Ctrl-C and SIGTERM: the first one asks a command to end with what it has, the second one ends
//! the process at once. A run of rigs is ramped out by the first, brought to the safe state by the
//! second, and ended by the third.
//!
//! A command that has begun its work reads the flag ([`flag`], [`requests`]). Before that, while a
//! command reads its files, there is nothing to keep, and the first signal ends the process too.

use crate::exit;
use hil_host::control::{Asker, Requests};
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

/// Set by the signals.
static REQUESTS: Requests = Requests::new();
/// The command reads the requests.
static READ: AtomicBool = AtomicBool::new(false);
/// The command can stop at once in a way of its own.
static CAN_STOP: AtomicBool = AtomicBool::new(false);
/// Signals so far.
static SIGNALS: AtomicU8 = AtomicU8::new(0);

/// Installs the handler.
pub(crate) fn listen() {
    if let Err(why) = ctrlc::set_handler(on_signal) {
        files::say!("warning: Ctrl-C ends the program without its files: {why}");
    }
}

/// The flag that the first Ctrl-C or SIGTERM sets; from this call on such a signal does nothing
/// else.
///
/// A command that calls this checks the flag at least every few hundred milliseconds, writes what
/// it has, and ends with [`exit::INTERRUPTED`]. One that only has files left to write ignores it.
pub(crate) fn flag() -> &'static AtomicBool {
    end_requests().end_flag()
}

/// The same with whoever else may ask for the end.
pub(crate) fn end_requests() -> &'static Requests {
    READ.store(true, Ordering::SeqCst);
    &REQUESTS
}

/// The same for a run of rigs: the first signal asks for an orderly end, the second one for the
/// safe state.
pub(crate) fn requests() -> &'static Requests {
    CAN_STOP.store(true, Ordering::SeqCst);
    READ.store(true, Ordering::SeqCst);
    &REQUESTS
}

/// Runs on a thread of its own, not inside the signal's handler.
fn on_signal() {
    let before = SIGNALS.fetch_add(1, Ordering::SeqCst);
    let can_stop = CAN_STOP.load(Ordering::SeqCst);
    let message = match (before, READ.load(Ordering::SeqCst)) {
        (0, true) => return REQUESTS.end(Asker::Signal),
        (0, false) => "interrupted before the first result: no result is written",
        (1, true) if can_stop => return REQUESTS.stop(),
        (_, _) if can_stop => "interrupted three times: ended at once, files may be missing",
        (_, _) => "interrupted twice: ended at once, files may be missing",
    };
    // Where nothing takes the message, the exit code still says it.
    let _ = writeln!(io::stderr(), "{message}");
    std::process::exit(i32::from(exit::INTERRUPTED));
}
