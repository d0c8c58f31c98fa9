//! Every frame sent and received, in the format of `candump -L -x`: can-utils, python-can and
//! SavvyCAN read it.

use super::durable::{Appender, Durable};
use super::storage::Storage;
use crate::bus::WireFrame;
use std::fmt::Write as _;
use std::fs::File;
use std::io;
use std::sync::Arc;

/// A frame that passed the bus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BusEvent {
    /// Time since the start of the log (ns).
    pub time_ns: u64,
    /// Number of the bus.
    pub bus: u8,
    /// Which way the frame went.
    pub direction: Direction,
    /// The frame.
    pub frame: WireFrame,
}

/// Which way a frame went, seen from the host.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// The host received it.
    Received,
    /// The host sent it.
    Sent,
}

impl Direction {
    /// The letter that `candump -x` writes.
    const fn letter(self) -> char {
        match self {
            Self::Received => 'R',
            Self::Sent => 'T',
        }
    }
}

/// Writes bus events to a file.
#[derive(Debug)]
pub struct BusLog<S = File> {
    file: Appender<S>,
    start_ns: u64,
    names: Vec<String>,
    lines: String,
}

impl<S: Storage> BusLog<S> {
    /// Begins a new file; times count from `start_ns` since the epoch, `names` are those of the
    /// buses.
    pub fn begin(file: S, start_ns: u64, names: Vec<String>) -> Self {
        Self { file: Appender::new(file), start_ns, names, lines: String::new() }
    }

    /// The file, for the thread that has the disk hold it.
    pub(crate) fn file(&self) -> Arc<Durable<S>> {
        self.file.file()
    }

    /// Appends events: all of them or none.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub fn write<'a>(&mut self, events: impl IntoIterator<Item = &'a BusEvent>) -> io::Result<()> {
        self.lines.clear();
        for event in events {
            let time_us = (self.start_ns + event.time_ns) / 1000;
            let (seconds, micros) = (time_us / 1_000_000, time_us % 1_000_000);
            let name = self.names.get(usize::from(event.bus));
            debug_assert!(name.is_some(), "bus {} has no name", event.bus);
            let name = name.map_or("can", String::as_str);
            let (frame, way) = (&event.frame, event.direction.letter());
            // Writing to a string cannot fail.
            let _ = writeln!(self.lines, "({seconds:010}.{micros:06}) {name} {frame} {way}");
        }
        self.file.append(self.lines.as_bytes())
    }

    /// Waits until the disk holds the log.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub fn finish(self) -> io::Result<()> {
        self.file.finish()
    }
}
