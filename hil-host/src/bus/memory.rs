//! The bus in memory: up to four emulated rigs in line with the host.
//!
//! A frame that the host sends is in every rig at once, in the order of the rigs; what they answer
//! waits in a bounded queue. A wait is one cycle of every rig that nobody commands, and a command
//! advances its rig by one cycle at every pace that the
//! host announces, so real time never enters a trajectory.

use super::{Bus, BusCounters, Sent, WireFrame};
use crate::rig::RigNode;
use can_protocol::{Frame, MessageId, Pace};
use heapless::{Deque, Vec};
use std::time::Duration;

/// Frames that wait for the host before the bus drops: more than four rigs send in two cycles.
pub const QUEUE_FRAMES: usize = 64;

/// Rigs on one bus.
pub const MAX_RIGS: usize = 4;

/// Emulated rigs and the frames on their way back. A clone is a snapshot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MemoryBus {
    rigs: Vec<RigNode, MAX_RIGS>,
    queue: Deque<WireFrame, QUEUE_FRAMES>,
    counters: BusCounters,
}

impl MemoryBus {
    /// A bus with these rigs, at most [`MAX_RIGS`].
    pub fn new(rigs: impl IntoIterator<Item = RigNode>) -> Self {
        let mut bus = Self::default();
        for rig in rigs {
            let fits = bus.rigs.push(rig).is_ok();
            debug_assert!(fits, "more than {MAX_RIGS} rigs on one bus");
        }
        bus
    }

    /// The rigs.
    pub fn rigs(&self) -> &[RigNode] {
        &self.rigs
    }

    /// The rigs, for a test that changes one.
    pub fn rigs_mut(&mut self) -> &mut [RigNode] {
        &mut self.rigs
    }

    /// Puts any frame on the bus, as `cansend` would: garbage, foreign ids, old frames.
    pub fn inject(&mut self, frame: &WireFrame) {
        let message = MessageId::from_raw(frame.id());
        for number in 0..self.rigs.len() {
            let Some(rig) = self.rigs.get_mut(number) else { continue };
            rig.on_frame(frame);
            // In clock pace a rig has its own time; here a command, good or bad, stands for it.
            let commanded =
                matches!(message, Some(MessageId::Command(_, node)) if node == rig.node());
            if commanded && rig.pace() == Pace::Clock {
                rig.cycle();
            }
            self.take_answers(number);
        }
    }

    /// Queues what a rig has to send.
    fn take_answers(&mut self, number: usize) {
        let Some(rig) = self.rigs.get_mut(number) else { return };
        while let Some(answer) = rig.take_frame() {
            if self.queue.push_back(WireFrame::from(&answer)).is_err() {
                self.counters.receive_dropped += 1;
            }
        }
    }
}

impl Bus for MemoryBus {
    fn send(&mut self, frame: &Frame) -> Sent {
        self.counters.sent += 1;
        self.inject(&WireFrame::from(frame));
        Sent::Away
    }

    fn receive(&mut self) -> Option<WireFrame> {
        let frame = self.queue.pop_front();
        self.counters.received += u64::from(frame.is_some());
        frame
    }

    fn wait(&mut self, _timeout: Duration) -> bool {
        for number in 0..self.rigs.len() {
            if let Some(rig) = self.rigs.get_mut(number) {
                rig.idle();
            }
            self.take_answers(number);
        }
        !self.queue.is_empty()
    }

    fn has_own_time(&self) -> bool {
        false
    }

    fn counters(&self) -> BusCounters {
        self.counters
    }
}
