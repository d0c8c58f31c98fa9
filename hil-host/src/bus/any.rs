//! A bus of any kind, chosen when a run begins.

use super::{Bus, BusCounters, CanSocket, MemoryBus, Sent, SocketCanBus, WireFrame};
use crate::gateway::Gateway;
use can_protocol::Frame;
use std::time::Duration;

/// A bus of any kind. The loop calls it by a match and not through a pointer.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "at most four, made once")]
pub(crate) enum AnyBus {
    Memory(MemoryBus),
    SocketCan(SocketCanBus),
    /// A CAN interface with a rig that speaks its own messages.
    Gateway(Gateway<CanSocket>),
}

impl Bus for AnyBus {
    fn send(&mut self, frame: &Frame) -> Sent {
        match self {
            Self::Memory(bus) => bus.send(frame),
            Self::SocketCan(bus) => bus.send(frame),
            Self::Gateway(bus) => bus.send(frame),
        }
    }

    fn receive(&mut self) -> Option<WireFrame> {
        match self {
            Self::Memory(bus) => bus.receive(),
            Self::SocketCan(bus) => bus.receive(),
            Self::Gateway(bus) => bus.receive(),
        }
    }

    fn wait(&mut self, timeout: Duration) -> bool {
        match self {
            Self::Memory(bus) => bus.wait(timeout),
            Self::SocketCan(bus) => bus.wait(timeout),
            Self::Gateway(bus) => bus.wait(timeout),
        }
    }

    fn has_own_time(&self) -> bool {
        match self {
            Self::Memory(bus) => bus.has_own_time(),
            Self::SocketCan(bus) => bus.has_own_time(),
            Self::Gateway(bus) => bus.has_own_time(),
        }
    }

    fn counters(&self) -> BusCounters {
        match self {
            Self::Memory(bus) => bus.counters(),
            Self::SocketCan(bus) => bus.counters(),
            Self::Gateway(bus) => bus.counters(),
        }
    }
}
