//! The side of the gateway on which the rig is.

use crate::bus::{BusCounters, CanSocket, RawFrame, Sent};
use std::time::Duration;

/// A bus with frames of any protocol. As with [`Bus`](crate::bus::Bus), neither `send` nor
/// `receive` waits or allocates.
pub trait Wire {
    /// Hands a frame to the bus at once, or drops it.
    fn send(&mut self, frame: &RawFrame) -> Sent;

    /// The oldest frame not yet taken; `None` when there is none.
    fn receive(&mut self) -> Option<RawFrame>;

    /// Waits until a frame may be there, for at most `timeout`; false when that has passed. In
    /// virtual time it is one cycle of the rig.
    fn wait(&mut self, timeout: Duration) -> bool;

    /// Whether the rig goes on in cycles that the host misses; false in virtual time.
    fn has_own_time(&self) -> bool {
        true
    }

    /// What went over the bus so far.
    fn counters(&self) -> BusCounters;

    /// The time of the rig, from any beginning: that of a clock, or of its cycles in virtual time.
    fn time(&self) -> Duration;
}

impl Wire for CanSocket {
    fn send(&mut self, frame: &RawFrame) -> Sent {
        CanSocket::send(self, frame)
    }

    fn receive(&mut self) -> Option<RawFrame> {
        CanSocket::receive(self)
    }

    fn wait(&mut self, timeout: Duration) -> bool {
        CanSocket::wait(self, timeout)
    }

    fn counters(&self) -> BusCounters {
        CanSocket::counters(self)
    }

    fn time(&self) -> Duration {
        CanSocket::time(self)
    }
}
