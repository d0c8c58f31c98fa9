//! Any data frame, with an identifier of 11 or 29 bits.

use super::WireFrame;
use can_protocol::Frame;
use dbc::CanId;
use nodes::MAX_BYTES;
use std::fmt;

/// A data frame of any protocol. `Display` writes it the way `cansend` takes it.
///
/// ```
/// use dbc::CanId;
/// use hil_host::bus::RawFrame;
/// let frame = RawFrame::new(CanId::Extended(0x18FF_0301), false, &[1, 2]).unwrap();
/// assert_eq!(frame.to_string(), "18FF0301#0102");
/// assert!(RawFrame::new(CanId::Standard(0x800), false, &[]).is_none());
/// ```
#[derive(Clone, PartialEq, Eq)]
pub struct RawFrame {
    id: CanId,
    fd: bool,
    len: u8,
    bytes: [u8; MAX_BYTES],
}

impl RawFrame {
    /// A frame; `None` for an identifier beyond its bits, or too many bytes for its kind.
    pub fn new(id: CanId, fd: bool, data: &[u8]) -> Option<Self> {
        let most_bytes = if fd { MAX_BYTES } else { 8 };
        let most_id = if id.is_extended() { 0x1FFF_FFFF } else { 0x7FF };
        if id.raw() > most_id || data.len() > most_bytes {
            return None;
        }
        let mut bytes = [0; MAX_BYTES];
        for (to, from) in bytes.iter_mut().zip(data) {
            *to = *from;
        }
        Some(Self { id, fd, len: data.len() as u8, bytes })
    }

    /// Its identifier.
    pub fn id(&self) -> CanId {
        self.id
    }

    /// The payload.
    pub fn data(&self) -> &[u8] {
        self.bytes.get(..usize::from(self.len)).unwrap_or(&self.bytes)
    }

    /// The payload, to be written.
    pub fn data_mut(&mut self) -> &mut [u8] {
        let len = usize::from(self.len).min(MAX_BYTES);
        self.bytes.split_at_mut(len).0
    }

    /// Whether it is a CAN FD frame.
    pub fn is_fd(&self) -> bool {
        self.fd
    }

    /// The same as a frame with an identifier of 11 bits; `None` for one of 29.
    pub(super) fn standard(&self) -> Option<WireFrame> {
        match self.id {
            CanId::Standard(id) => WireFrame::new(id, self.fd, self.data()),
            CanId::Extended(_) => None,
        }
    }
}

impl From<&Frame> for RawFrame {
    fn from(frame: &Frame) -> Self {
        let mut bytes = [0; MAX_BYTES];
        for (to, from) in bytes.iter_mut().zip(frame.data()) {
            *to = *from;
        }
        let len = frame.data().len() as u8;
        Self { id: CanId::Standard(frame.id()), fd: frame.is_fd(), len, bytes }
    }
}

impl fmt::Display for RawFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.id, if self.fd { "##1" } else { "#" })?;
        self.data().iter().try_for_each(|byte| write!(f, "{byte:02X}"))
    }
}

impl fmt::Debug for RawFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
