//! Ctrl-C and SIGTERM: the first one asks a command to end with what it has, the second one ends
//! the process at once.

use crate::exit;
use crate::output;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Set by the first signal.
static STOP: AtomicBool = AtomicBool::new(false);
/// Finished items are on disk: the process may end at any moment.
static SAVED: AtomicBool = AtomicBool::new(false);
/// How long items at work may take to finish after the first signal.
const GRACE: Duration = Duration::from_secs(3);

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

/// The same for a command whose finished items are on disk at once: the items at work have
/// [`GRACE`] to finish, and are lost after it.
pub(crate) fn flag_of_saved_work() -> &'static AtomicBool {
    SAVED.store(true, Ordering::Relaxed);
    flag()
}

/// Runs on a thread of its own, not inside the signal's handler.
fn on_signal() {
    if STOP.swap(true, Ordering::Relaxed) {
        std::process::exit(i32::from(exit::INTERRUPTED));
    }
    if SAVED.load(Ordering::Relaxed) {
        std::thread::spawn(|| {
            std::thread::sleep(GRACE);
            output::complain("interrupted: what is finished is saved; the same command continues");
            std::process::exit(i32::from(exit::INTERRUPTED));
        });
    }
}
