//! A frame as it was received.

use can_protocol::Frame;
use core::fmt;

/// Most bytes in a frame, those of CAN FD.
pub const MAX_BYTES: usize = 64;

/// A data frame with a standard id as it was received: of this protocol or not, valid or not.
///
/// It is [`Frame`] without the promise that an encoder made it. `Display` writes it the way
/// `cansend` takes and `candump -L` logs it.
///
/// ```
/// use nodes::WireFrame;
/// let frame = WireFrame::new(0x101, false, &[0x18, 0x43]).unwrap();
/// assert_eq!(frame.to_string(), "101#1843");
/// assert!(WireFrame::new(0x101, false, &[0; 9]).is_none());
/// ```
#[derive(Clone, PartialEq, Eq)]
pub struct WireFrame {
    id: u16,
    fd: bool,
    len: u8,
    bytes: [u8; MAX_BYTES],
}

impl WireFrame {
    /// A frame; `None` for an id beyond 11 bits or too many bytes for its kind.
    pub fn new(id: u16, fd: bool, data: &[u8]) -> Option<Self> {
        let most = if fd { MAX_BYTES } else { 8 };
        if id > 0x7FF || data.len() > most {
            return None;
        }
        let mut bytes = [0; MAX_BYTES];
        for (to, from) in bytes.iter_mut().zip(data) {
            *to = *from;
        }
        Some(Self { id, fd, len: data.len() as u8, bytes })
    }

    /// The 11-bit id.
    pub fn id(&self) -> u16 {
        self.id
    }

    /// The payload.
    pub fn data(&self) -> &[u8] {
        self.bytes.get(..usize::from(self.len)).unwrap_or(&self.bytes)
    }

    /// Whether it came as a CAN FD frame.
    pub fn is_fd(&self) -> bool {
        self.fd
    }
}

impl From<&Frame> for WireFrame {
    fn from(frame: &Frame) -> Self {
        let mut bytes = [0; MAX_BYTES];
        for (to, from) in bytes.iter_mut().zip(frame.data()) {
            *to = *from;
        }
        Self { id: frame.id(), fd: frame.is_fd(), len: frame.data().len() as u8, bytes }
    }
}

impl fmt::Display for WireFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:03X}{}", self.id, if self.fd { "##1" } else { "#" })?;
        self.data().iter().try_for_each(|byte| write!(f, "{byte:02X}"))
    }
}

impl fmt::Debug for WireFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use can_protocol::{Command, Mode, Node, Profile, RunState};

    extern crate std;
    use std::string::ToString;

    #[test]
    fn a_frame_of_the_protocol_reads_the_same_off_the_wire() {
        for profile in [Profile::Classical, Profile::Fd] {
            let command = Command {
                node: Node::ALL[2],
                counter: 7,
                state: RunState::Run,
                mode: Mode::Follow,
                echo: None,
                displacement_m: Some(1.0e-3),
                velocity_m_per_s: None,
                time_us: Some(12),
            };
            let (frame, _) = command.encode(profile);
            let wire = WireFrame::from(&frame);
            assert_eq!(wire.to_string(), frame.to_string());
            assert_eq!(
                (wire.id(), wire.data(), wire.is_fd()),
                (frame.id(), frame.data(), frame.is_fd())
            );
            assert_eq!(WireFrame::new(frame.id(), frame.is_fd(), frame.data()), Some(wire));
        }
    }
}
