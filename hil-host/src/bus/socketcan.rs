//! A CAN interface of Linux as the bus of rigs that speak this protocol.

use super::can_socket::CanSocket;
use super::error::BusError;
use super::raw_frame::RawFrame;
use super::{Bus, BusCounters, Sent};
use can_protocol::{Frame, MessageId, Profile};
use dbc::CanId;
use nodes::WireFrame;
use std::time::Duration;

/// A bus on a CAN interface. `bus/can_socket.rs` has what it asks of the kernel.
#[derive(Debug)]
pub struct SocketCanBus {
    socket: CanSocket,
}

impl SocketCanBus {
    /// Opens an interface for the messages that are to be received.
    ///
    /// # Errors
    /// The kernel has no CAN, or the interface does not exist, is down, or cannot do the profile.
    pub fn open(interface: &str, accept: &[MessageId], profile: Profile) -> Result<Self, BusError> {
        let ids = accept.iter().map(|message| CanId::Standard(message.raw()));
        Ok(Self { socket: CanSocket::open(interface, ids, profile == Profile::Fd)? })
    }
}

impl Bus for SocketCanBus {
    fn send(&mut self, frame: &Frame) -> Sent {
        self.socket.send(&RawFrame::from(frame))
    }

    fn receive(&mut self) -> Option<WireFrame> {
        // The filters let nothing else through.
        self.socket.receive()?.standard()
    }

    fn wait(&mut self, timeout: Duration) -> bool {
        self.socket.wait(timeout)
    }

    fn counters(&self) -> BusCounters {
        self.socket.counters()
    }
}
