//! The buses of a session. Every frame that passes one of them goes to the recorder; a frame that a
//! bus did not take has not passed it.

use crate::bus::{Bus, Sent, WireFrame};
use crate::record::{BusEvent, Direction, Recorder};
use can_protocol::Frame;
use std::time::{Duration, Instant};

/// The buses of a session and the recorder that keeps their frames.
pub struct Buses<'a, 'r, B> {
    all: &'a mut [B],
    recorder: &'a mut Recorder<'r>,
    /// Time zero of the bus log.
    begin: Instant,
}

impl<'a, 'r, B: Bus> Buses<'a, 'r, B> {
    /// The buses of a session that begins now.
    pub fn new(buses: &'a mut [B], recorder: &'a mut Recorder<'r>) -> Self {
        Self { all: buses, recorder, begin: Instant::now() }
    }

    /// The same buses with the times of their log counted from `begin`.
    #[must_use]
    pub const fn counted_from(mut self, begin: Instant) -> Self {
        self.begin = begin;
        self
    }

    /// The recorder.
    pub fn recorder(&mut self) -> &mut Recorder<'r> {
        self.recorder
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.all.len()
    }

    /// The oldest frame of a bus that was not taken yet.
    pub(super) fn receive(&mut self, bus: usize) -> Option<WireFrame> {
        let frame = self.all.get_mut(bus)?.receive()?;
        self.keep(bus, Direction::Received, frame.clone());
        Some(frame)
    }

    /// Sends a frame, or drops it.
    pub(super) fn send(&mut self, bus: usize, frame: &Frame) -> Sent {
        debug_assert!(bus < self.all.len(), "there is no bus {bus}");
        let Some(on) = self.all.get_mut(bus) else { return Sent::Down };
        let sent = on.send(frame);
        if sent == Sent::Away {
            self.keep(bus, Direction::Sent, WireFrame::from(frame));
        }
        sent
    }

    /// Sends a frame to every bus, or drops it there.
    pub(super) fn send_to_all(&mut self, frame: &Frame) {
        for bus in 0..self.all.len() {
            self.send(bus, frame);
        }
    }

    /// Waits until a bus may have a frame.
    pub(super) fn wait(&mut self, bus: usize, timeout: Duration) {
        debug_assert!(bus < self.all.len(), "there is no bus {bus}");
        if let Some(bus) = self.all.get_mut(bus) {
            bus.wait(timeout);
        }
    }

    /// Whether the rigs of a bus go on in cycles that the host misses.
    pub(super) fn has_own_time(&self, bus: usize) -> bool {
        self.all.get(bus).is_some_and(Bus::has_own_time)
    }

    fn keep(&mut self, bus: usize, direction: Direction, frame: WireFrame) {
        let time_ns = self.begin.elapsed().as_nanos() as u64;
        self.recorder.event(BusEvent { time_ns, bus: bus as u8, direction, frame });
    }
}
