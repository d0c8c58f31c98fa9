//! Ctrl-C and SIGTERM: the first one asks a command to end with what it has, the second one ends
//! the process at once.

use crate::exit;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by the first signal.
static STOP: AtomicBool = AtomicBool::new(false);

/// The flag that the first Ctrl-C or SIGTERM sets. The first call installs the handler; until then
/// a signal ends the process as usual.
///
/// A command that calls this checks the flag at least every few hundred milliseconds, writes what
/// it has, and ends with [`exit::INTERRUPTED`].
pub(crate) fn flag() -> &'static AtomicBool {
    static INSTALLED: OnceLock<()> = OnceLock::new();
    INSTALLED.get_or_init(|| {
        if let Err(why) = ctrlc::set_handler(on_signal) {
            eprintln!("warning: Ctrl-C ends the program without its files: {why}");
        }
    });
    &STOP
}

/// Runs on a thread of its own, not inside the signal's handler.
fn on_signal() {
    if STOP.swap(true, Ordering::Relaxed) {
        std::process::exit(i32::from(exit::INTERRUPTED));
    }
}
