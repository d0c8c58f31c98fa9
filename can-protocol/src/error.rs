//! What can be wrong with a frame or a parameter: one closed list for the crate.
use core::fmt;

/// Why a frame was not decoded, or a parameter not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// A node number outside 1 to 4.
    NodeRange {
        /// The number given.
        value: u8,
    },
    /// The largest accepted counter step is outside its bounds.
    MaxDeltaRange {
        /// The number given.
        value: u8,
        /// The largest step that an old frame cannot imitate.
        upper: u8,
    },
    /// The id is none of this protocol, or not of the message asked for.
    UnknownId {
        /// The frame's id.
        id: u16,
    },
    /// The payload has the wrong length.
    Length {
        /// The frame's id.
        id: u16,
        /// Bytes found.
        found: usize,
        /// Bytes that this message has.
        expected: usize,
    },
    /// The CRC over `DataID` and payload does not match.
    Checksum {
        /// The frame's id.
        id: u16,
        /// The CRC in the frame.
        found: u16,
        /// The CRC of what the frame holds.
        expected: u16,
    },
    /// The counter is not that of the cycle which the frame should be of.
    Counter {
        /// The frame's id.
        id: u16,
        /// The counter in the frame.
        found: u8,
        /// The counter of the cycle.
        expected: u8,
    },
    /// A field holds a code that has no meaning (yet).
    ReservedCode {
        /// The frame's id.
        id: u16,
        /// The field.
        field: &'static str,
        /// The code found.
        code: u32,
    },
}

impl Error {
    /// Whether the user's input is at fault, a number in a file or on the command line; false where
    /// a frame on the bus is.
    ///
    /// ```
    /// use can_protocol::{Error, Node};
    /// assert!(Node::new(7).unwrap_err().is_bad_input());
    /// assert!(!Error::UnknownId { id: 0x123 }.is_bad_input());
    /// ```
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::NodeRange { .. } | Self::MaxDeltaRange { .. } => true,
            Self::UnknownId { .. }
            | Self::Length { .. }
            | Self::Checksum { .. }
            | Self::Counter { .. }
            | Self::ReservedCode { .. } => false,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NodeRange { value } => write!(f, "node is {value}, must be 1 to 4"),
            Self::MaxDeltaRange { value, upper } => {
                write!(f, "max_delta is {value}, must be 1 to {upper}")
            }
            Self::UnknownId { id } => write!(f, "frame id {id:#05x} is not expected here"),
            Self::Length { id, found, expected } => {
                write!(f, "frame {id:#05x} has {found} bytes, must have {expected}")
            }
            Self::Checksum { id, found, expected } => {
                write!(f, "frame {id:#05x} has crc {found:#x}, its content gives {expected:#x}")
            }
            Self::Counter { id, found, expected } => {
                write!(f, "frame {id:#05x} has counter {found}, its cycle gives {expected}")
            }
            Self::ReservedCode { id, field, code } => {
                write!(f, "frame {id:#05x} has reserved code {code} in {field}")
            }
        }
    }
}

impl core::error::Error for Error {}
