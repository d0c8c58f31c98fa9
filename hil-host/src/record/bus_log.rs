//! Every frame sent and received, in the format of `candump -L`: can-utils, python-can and SavvyCAN
//! read it.

use crate::bus::WireFrame;
use std::fs::File;
use std::io::{self, BufWriter, Write};

/// A frame that passed the bus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BusEvent {
    /// Time since the start of the run (ns).
    pub time_ns: u64,
    /// Number of the bus.
    pub bus: u8,
    /// The frame.
    pub frame: WireFrame,
}

/// Writes bus events to a file.
#[derive(Debug)]
pub struct BusLog {
    file: BufWriter<File>,
    start_ns: u64,
    names: Vec<String>,
}

impl BusLog {
    /// Begins a new file; times count from `start_ns` since the epoch, `names` are those of the
    /// buses.
    pub fn begin(file: File, start_ns: u64, names: Vec<String>) -> Self {
        Self { file: BufWriter::with_capacity(1 << 20, file), start_ns, names }
    }

    /// Appends events.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub fn write(&mut self, events: &[BusEvent]) -> io::Result<()> {
        for event in events {
            let time_us = (self.start_ns + event.time_ns) / 1000;
            let (seconds, micros) = (time_us / 1_000_000, time_us % 1_000_000);
            let name = self.names.get(usize::from(event.bus));
            debug_assert!(name.is_some(), "bus {} has no name", event.bus);
            let name = name.map_or("can", String::as_str);
            writeln!(self.file, "({seconds:010}.{micros:06}) {name} {}", event.frame)?;
        }
        Ok(())
    }

    /// Closes the file.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub fn finish(mut self) -> io::Result<()> {
        self.file.flush()
    }
}
