//! The keys of a run: an operator arms rigs on a real bus and ends the run from the terminal.
//!
//! Software cannot know whether a terminal is local: whoever reaches this one can arm the rigs. The
//! key switch at the rig and what is hard-wired keep people safe.

use crate::error::CommandError;
use hil_host::control::{Asker, Requests};
use rustix::process;
use rustix::termios::{self, LocalModes, OptionalActions, SpecialCodeIndex, Termios};
use std::io::{self, IsTerminal, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};

/// Reads keys until it is dropped.
#[derive(Debug)]
pub(crate) struct Keys {
    before: Termios,
    done: Arc<AtomicBool>,
    reader: Option<JoinHandle<()>>,
}

impl Keys {
    /// The keys of whoever may arm the rigs; where nobody is asked, the rigs may be armed at once.
    ///
    /// # Errors
    /// Somebody is to be asked, and there is no terminal.
    pub(crate) fn of_operator(
        requests: &'static Requests,
        arms_at_once: bool,
    ) -> Result<Option<Self>, CommandError> {
        if arms_at_once {
            requests.arm();
        }
        let keys = Self::listen(requests);
        if keys.is_none() && !requests.may_arm() {
            return Err(CommandError::option(
                "no terminal and no --arm",
                "a terminal, whose key a arms the rigs, or --arm",
            ));
        }
        Ok(keys)
    }

    /// Takes over the terminal; none where there is no terminal.
    fn listen(requests: &'static Requests) -> Option<Self> {
        // A process in the background would be stopped by the terminal that it changes.
        let is_foreground = || termios::tcgetpgrp(io::stdin()) == Ok(process::getpgrp());
        if !io::stdin().is_terminal() || !is_foreground() {
            return None;
        }
        let before = termios::tcgetattr(io::stdin()).ok()?;
        let mut single = before.clone();
        single.local_modes.remove(LocalModes::ICANON | LocalModes::ECHO);
        // A read comes back after a tenth of a second, with or without a key.
        single.special_codes[SpecialCodeIndex::VMIN] = 0;
        single.special_codes[SpecialCodeIndex::VTIME] = 1;
        termios::tcsetattr(io::stdin(), OptionalActions::Now, &single).ok()?;
        let done = Arc::new(AtomicBool::new(false));
        let reader = {
            let done = Arc::clone(&done);
            thread::spawn(move || read(requests, &done))
        };
        files::say!("keys: a arms the rigs, s ends the run in order");
        Some(Self { before, done, reader: Some(reader) })
    }
}

impl Drop for Keys {
    fn drop(&mut self) {
        self.done.store(true, Ordering::Relaxed);
        if let Some(reader) = self.reader.take() {
            // A reader that has panicked reads no more.
            let _ = reader.join();
        }
        // A terminal that is gone needs its modes no more.
        let _ = termios::tcsetattr(io::stdin(), OptionalActions::Now, &self.before);
    }
}

fn read(requests: &Requests, done: &AtomicBool) {
    let mut key = [0];
    while !done.load(Ordering::Relaxed) {
        match io::stdin().lock().read(&mut key) {
            Ok(1) if key == *b"a" => requests.arm(),
            Ok(1) if key == *b"s" => requests.end(Asker::Key),
            Ok(_) => {}
            Err(why) if why.kind() == io::ErrorKind::Interrupted => {}
            Err(_) => return,
        }
    }
}
