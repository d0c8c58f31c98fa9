//! Buses: how a frame gets from the host to a rig and back.
//!
//! One trait, two kinds: [`MemoryBus`] holds emulated rigs in this process and needs nothing from
//! the kernel; [`SocketCanBus`] is a CAN interface of Linux, real or virtual. Neither waits in
//! [`Bus::send`] or [`Bus::receive`], and neither uses the heap there.
//!
//! A frame that cannot be sent at once is dropped and counted. With a cycle per millisecond an old
//! command is worse than none.

mod any;
mod can_socket;
mod choice;
mod error;
mod memory;
mod raw_frame;
mod serial_line;
mod socketcan;

pub(crate) use any::AnyBus;
pub(crate) use can_socket::CanSocket;
pub use choice::{BusChoice, InvalidBus};
pub use error::BusError;
pub use memory::{MAX_RIGS, MemoryBus, QUEUE_FRAMES};
pub use nodes::WireFrame;
pub use raw_frame::RawFrame;
pub(crate) use serial_line::SerialLineBus;
pub use socketcan::SocketCanBus;

use can_protocol::Frame;
use std::time::Duration;

/// A CAN bus as the loop sees it.
pub trait Bus {
    /// Hands a frame to the bus at once, or drops it.
    fn send(&mut self, frame: &Frame) -> Sent;

    /// The oldest frame not yet taken; `None` when the bus is drained. Never waits.
    fn receive(&mut self) -> Option<WireFrame>;

    /// Waits until a frame may be there, for at most `timeout`; false when that has passed. A bus
    /// in memory returns at once: a wait is one cycle of its rigs that nobody commands.
    fn wait(&mut self, timeout: Duration) -> bool;

    /// Whether its rigs go on in cycles that the host misses, as every rig with a clock does.
    fn has_own_time(&self) -> bool {
        true
    }

    /// What went over the bus so far.
    fn counters(&self) -> BusCounters;
}

/// Whether the bus took a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sent {
    /// The bus has it.
    Away,
    /// The bus had no room; the frame is dropped and counted.
    Dropped,
    /// The interface is down or no longer there.
    Down,
}

/// What went over a bus so far, seen from this end of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BusCounters {
    /// Frames that the bus took.
    pub sent: u64,
    /// Frames that [`Bus::receive`] returned.
    pub received: u64,
    /// Frames that the bus did not take: no room, or the interface was down.
    pub send_dropped: u64,
    /// Frames that arrived and were lost for want of room in the receive queue.
    pub receive_dropped: u64,
    /// Error frames of the controller: bus errors, passive state, bus-off.
    pub error_frames: u64,
}

impl BusCounters {
    /// The sum of two buses.
    #[must_use]
    pub const fn plus(self, other: Self) -> Self {
        Self {
            sent: self.sent + other.sent,
            received: self.received + other.received,
            send_dropped: self.send_dropped + other.send_dropped,
            receive_dropped: self.receive_dropped + other.receive_dropped,
            error_frames: self.error_frames + other.error_frames,
        }
    }
}
