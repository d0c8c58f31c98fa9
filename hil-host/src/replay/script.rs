//! The bus log of a run as the buses of its replay.
//!
//! A cycle of the host first drains its buses and then sends. The log holds both in this order, so
//! the frames up to the next one that was sent are those that the cycle found. What the replay
//! sends is compared with what was sent.

use super::Difference;
use crate::bus::{Bus, BusCounters, Sent, WireFrame};
use crate::record::{Direction, LogFault, LogLine, LogReader};
use can_protocol::Frame;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::time::Duration;

/// A frame of the log on the bus of this number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Entry {
    pub(super) bus: usize,
    pub(super) direction: Direction,
    pub(super) frame: WireFrame,
}

/// The log, read on as the replay needs it.
#[derive(Debug)]
pub(super) struct Script {
    log: LogReader,
    /// Names of the buses by their numbers.
    names: Vec<String>,
    /// Entries that are not used yet.
    ahead: VecDeque<Entry>,
    /// Entries that were used since the last mark.
    used: Vec<Entry>,
    /// Frames that were sent as they are in the log.
    sent: u64,
    sent_at_mark: u64,
    /// The first frame that was sent otherwise: its bus, what the log holds and what was sent.
    other: Option<(usize, WireFrame, WireFrame)>,
    /// Why the log cannot be read on.
    fault: Option<LogFault>,
}

impl Script {
    pub(super) fn new(log: LogReader, names: Vec<String>) -> Self {
        Self {
            log,
            names,
            ahead: VecDeque::new(),
            used: Vec::new(),
            sent: 0,
            sent_at_mark: 0,
            other: None,
            fault: None,
        }
    }

    /// The next entry, which stays the next one.
    pub(super) fn peek(&mut self) -> Option<&Entry> {
        while self.ahead.is_empty() && self.fault.is_none() {
            match self.log.next_line() {
                Ok(Some(line)) => self.ahead.extend(self.entry(line)),
                Ok(None) => break,
                Err(why) => self.fault = Some(why),
            }
        }
        self.ahead.front()
    }

    /// Takes the next entry.
    pub(super) fn take(&mut self) -> Option<Entry> {
        self.peek()?;
        let entry = self.ahead.pop_front()?;
        self.used.push(entry.clone());
        Some(entry)
    }

    /// Puts entries in front of the others, the first one first.
    pub(super) fn put_back(&mut self, entries: Vec<Entry>) {
        entries.into_iter().rev().for_each(|entry| self.ahead.push_front(entry));
    }

    /// Marks this place.
    pub(super) fn mark(&mut self) {
        self.used.clear();
        self.sent_at_mark = self.sent;
    }

    /// Goes back to the mark.
    pub(super) fn go_back(&mut self) {
        let used = std::mem::take(&mut self.used);
        self.put_back(used);
        (self.sent, self.other) = (self.sent_at_mark, None);
    }

    /// Whether the next entry was received.
    pub(super) fn is_received_next(&mut self) -> bool {
        self.peek().is_some_and(|entry| entry.direction == Direction::Received)
    }

    /// Frames that were sent as they are in the log.
    pub(super) const fn sent(&self) -> u64 {
        self.sent
    }

    /// The first frame that differs, if one does.
    pub(super) fn difference(&self) -> Option<Difference> {
        let (bus, recorded, replayed) = self.other.as_ref()?;
        let bus = self.names.get(*bus).cloned().unwrap_or_default();
        let (recorded, replayed) = (recorded.to_string(), replayed.to_string());
        Some(Difference::Frame { bus, recorded, replayed })
    }

    /// Whether the log could not be read on.
    pub(super) const fn has_fault(&self) -> bool {
        self.fault.is_some()
    }

    /// Why the log could not be read on.
    pub(super) fn take_fault(&mut self) -> Option<LogFault> {
        self.fault.take()
    }

    /// An entry of a line; none of a bus that the run did not use, or without a direction.
    fn entry(&self, line: LogLine) -> Option<Entry> {
        let bus = self.names.iter().position(|name| *name == line.bus)?;
        Some(Entry { bus, direction: line.direction?, frame: line.frame })
    }

    fn receive(&mut self, bus: usize) -> Option<WireFrame> {
        let next = self.peek()?;
        let is_here = next.direction == Direction::Received && next.bus == bus;
        is_here.then(|| self.take())?.map(|entry| entry.frame)
    }

    /// Compares a frame with the log. One that the log does not hold was dropped by its bus.
    fn send(&mut self, bus: usize, frame: WireFrame) -> Sent {
        let is_sent = |entry: &Entry| {
            let is_same = entry.bus == bus && entry.frame.id() == frame.id();
            entry.direction == Direction::Sent && is_same
        };
        if !self.peek().is_some_and(is_sent) {
            return Sent::Dropped;
        }
        match self.take() {
            Some(entry) if entry.frame != frame => {
                self.other.get_or_insert((bus, entry.frame, frame));
            }
            _ => self.sent += 1,
        }
        Sent::Away
    }
}

/// One bus of a replay.
#[derive(Debug)]
pub(super) struct ReplayedBus<'a> {
    pub(super) number: usize,
    pub(super) script: &'a RefCell<Script>,
    pub(super) has_own_time: bool,
}

impl Bus for ReplayedBus<'_> {
    fn send(&mut self, frame: &Frame) -> Sent {
        self.script.borrow_mut().send(self.number, WireFrame::from(frame))
    }

    fn receive(&mut self) -> Option<WireFrame> {
        self.script.borrow_mut().receive(self.number)
    }

    fn wait(&mut self, _timeout: Duration) -> bool {
        self.script.borrow_mut().is_received_next()
    }

    fn has_own_time(&self) -> bool {
        self.has_own_time
    }

    fn counters(&self) -> BusCounters {
        BusCounters::default()
    }
}
