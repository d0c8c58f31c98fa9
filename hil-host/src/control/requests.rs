//! What an operator asks of a session, from any thread.

use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

/// Who has asked for the end of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Asker {
    /// An operator at the terminal, by key.
    Key,
    /// An operator at the page of the run.
    Page,
    /// Ctrl-C, or SIGTERM.
    Signal,
    /// The recorder: the disk took nothing for too long.
    Record,
}

impl Asker {
    /// All of them, in the order of their codes.
    const ALL: [Self; 4] = [Self::Key, Self::Page, Self::Signal, Self::Record];

    /// Whether it is an operator, who ends a run on purpose.
    pub const fn is_operator(self) -> bool {
        matches!(self, Self::Key | Self::Page)
    }
}

/// Requests of an operator. Each is made once and stays.
#[derive(Debug, Default)]
pub struct Requests {
    arm: AtomicBool,
    end: AtomicBool,
    stop: AtomicBool,
    /// Code of the first that asked for the end, from 1; 0 before.
    asker: AtomicU8,
    /// The session waits for somebody who arms the rigs.
    waits: AtomicBool,
}

impl Requests {
    /// Nothing is asked for.
    pub const fn new() -> Self {
        Self {
            arm: AtomicBool::new(false),
            end: AtomicBool::new(false),
            stop: AtomicBool::new(false),
            asker: AtomicU8::new(0),
            waits: AtomicBool::new(false),
        }
    }

    /// The rigs may be armed as soon as they are ready.
    pub const fn armed() -> Self {
        Self { arm: AtomicBool::new(true), ..Self::new() }
    }

    /// Asks for the rigs to be armed.
    pub fn arm(&self) {
        self.arm.store(true, Ordering::Relaxed);
    }

    /// Asks for an orderly end: rigs are ramped out. The first asker is kept.
    pub fn end(&self, asker: Asker) {
        let code = asker as u8 + 1;
        // A later one asks for what is asked for already.
        let _first = self.asker.compare_exchange(0, code, Ordering::Relaxed, Ordering::Relaxed);
        self.end.store(true, Ordering::Release);
    }

    /// Asks for the safe state at once.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
        self.end(Asker::Signal);
    }

    /// Whether the rigs may be armed.
    pub fn may_arm(&self) -> bool {
        self.arm.load(Ordering::Relaxed)
    }

    /// Whether the session is to end.
    pub fn is_ending(&self) -> bool {
        self.end.load(Ordering::Relaxed)
    }

    /// Whether the session is to stop at once.
    pub fn is_stopping(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Who has asked for the end first; none while nobody has.
    ///
    /// ```
    /// use hil_host::control::{Asker, Requests};
    /// let requests = Requests::new();
    /// assert_eq!(requests.asker(), None);
    /// requests.end(Asker::Page);
    /// requests.end(Asker::Signal);
    /// assert_eq!(requests.asker(), Some(Asker::Page));
    /// ```
    pub fn asker(&self) -> Option<Asker> {
        let code = self.asker.load(Ordering::Relaxed);
        code.checked_sub(1).and_then(|code| Asker::ALL.get(usize::from(code)).copied())
    }

    /// Says that the rigs are ready and wait for somebody who arms them.
    pub(crate) fn wait_for_arming(&self) {
        self.waits.store(true, Ordering::Relaxed);
    }

    /// Whether the rigs are ready and nobody has armed them yet.
    pub fn are_awaited(&self) -> bool {
        self.waits.load(Ordering::Relaxed) && !self.may_arm() && !self.is_ending()
    }

    /// The request for an end, for work that knows no other.
    pub const fn end_flag(&self) -> &AtomicBool {
        &self.end
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn askers_are_listed_in_their_own_order() {
        assert!(Asker::ALL.iter().enumerate().all(|(n, asker)| *asker as usize == n));
    }
}
