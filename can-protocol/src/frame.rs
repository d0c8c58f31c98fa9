//! A frame ready for the wire.
use crate::MessageId;
use core::fmt;
use heapless::Vec;

/// One of our frames: standard id, payload, and whether it goes as FD with bit-rate switch.
///
/// `Display` writes it the way `cansend` takes and `candump -L` logs it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    id: u16,
    fd: bool,
    payload: Vec<u8, 64>,
}

impl Frame {
    /// The frame of `message` with the first bytes of `bytes`, as many as the message has.
    pub(crate) fn new(message: MessageId, bytes: [u8; 16]) -> Self {
        let mut payload = Vec::from_array(bytes);
        payload.truncate(message.payload_len());
        debug_assert!(
            payload.len() == message.payload_len(),
            "{message:?} is longer than 16 bytes"
        );
        debug_assert!(message.raw() < 0x800, "{message:?} has no standard id");
        Self { id: message.raw(), fd: message.profile() == crate::Profile::Fd, payload }
    }

    /// The 11-bit id.
    pub fn id(&self) -> u16 {
        self.id
    }

    /// The payload: 6, 8 or 16 bytes.
    pub fn data(&self) -> &[u8] {
        &self.payload
    }

    /// Whether to send it as a CAN FD frame, with bit-rate switch.
    pub fn is_fd(&self) -> bool {
        self.fd
    }
}

impl fmt::Display for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // In the FD form the digit behind ## holds the FD flags; 1 is the bit-rate switch.
        write!(f, "{:03X}{}", self.id, if self.fd { "##1" } else { "#" })?;
        self.payload.iter().try_for_each(|byte| write!(f, "{byte:02X}"))
    }
}
