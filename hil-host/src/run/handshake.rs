//! The frames of the handshake, for the bus log.

use crate::bus::{Bus, BusCounters, Sent, WireFrame};
use crate::record::{BusEvent, Direction};
use can_protocol::Frame;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Time zero of a bus log.
#[derive(Debug, Clone, Copy)]
pub(super) struct Epoch {
    pub(super) begin: Instant,
    /// The same since 1970 (ns).
    pub(super) unix_ns: u64,
}

impl Epoch {
    pub(super) fn now() -> Self {
        let unix = SystemTime::now().duration_since(UNIX_EPOCH);
        Self { begin: Instant::now(), unix_ns: unix.map_or(0, |time| time.as_nanos() as u64) }
    }
}

/// A bus whose frames are kept.
#[derive(Debug)]
pub(super) struct Heard<'a, B> {
    bus: &'a mut B,
    number: u8,
    begin: Instant,
    events: Vec<BusEvent>,
}

impl<'a, B: Bus> Heard<'a, B> {
    /// All buses of a run.
    pub(super) fn all(buses: &'a mut [B], epoch: Epoch) -> Vec<Self> {
        let number = (0..=u8::MAX).zip(buses);
        let heard = |(number, bus)| Self { bus, number, begin: epoch.begin, events: Vec::new() };
        number.map(heard).collect()
    }

    /// What was heard on all of them, in the order of time.
    pub(super) fn events(buses: Vec<Self>) -> Vec<BusEvent> {
        let mut events: Vec<BusEvent> = buses.into_iter().flat_map(|bus| bus.events).collect();
        events.sort_by_key(|event| event.time_ns);
        events
    }

    fn keep(&mut self, direction: Direction, frame: WireFrame) {
        let time_ns = self.begin.elapsed().as_nanos() as u64;
        self.events.push(BusEvent { time_ns, bus: self.number, direction, frame });
    }
}

impl<B: Bus> Bus for Heard<'_, B> {
    fn send(&mut self, frame: &Frame) -> Sent {
        let sent = self.bus.send(frame);
        if sent == Sent::Away {
            self.keep(Direction::Sent, WireFrame::from(frame));
        }
        sent
    }

    fn receive(&mut self) -> Option<WireFrame> {
        let frame = self.bus.receive()?;
        self.keep(Direction::Received, frame.clone());
        Some(frame)
    }

    fn wait(&mut self, timeout: Duration) -> bool {
        self.bus.wait(timeout)
    }

    fn has_own_time(&self) -> bool {
        self.bus.has_own_time()
    }

    fn counters(&self) -> BusCounters {
        self.bus.counters()
    }
}
