//! What an operator asks of a session, from any thread.

use std::sync::atomic::{AtomicBool, Ordering};

/// Requests of an operator. Each is made once and stays.
#[derive(Debug, Default)]
pub struct Requests {
    arm: AtomicBool,
    end: AtomicBool,
    stop: AtomicBool,
}

impl Requests {
    /// Nothing is asked for.
    pub const fn new() -> Self {
        Self {
            arm: AtomicBool::new(false),
            end: AtomicBool::new(false),
            stop: AtomicBool::new(false),
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

    /// Asks for an orderly end: rigs are ramped out.
    pub fn end(&self) {
        self.end.store(true, Ordering::Relaxed);
    }

    /// Asks for the safe state at once.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
        self.end();
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

    /// The request for an end, for work that knows no other.
    pub const fn end_flag(&self) -> &AtomicBool {
        &self.end
    }
}
