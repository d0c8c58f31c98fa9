//! Identifiers of CAN frames.

use std::fmt;

/// An identifier of 11 or 29 bits.
///
/// ```
/// use dbc::CanId;
/// assert_eq!(CanId::Standard(0x123).to_string(), "123");
/// assert_eq!(CanId::Extended(0x18FF_0301).to_string(), "18FF0301");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CanId {
    /// 11 bits.
    Standard(u16),
    /// 29 bits.
    Extended(u32),
}

impl CanId {
    /// The number, without a mark for its kind.
    pub const fn raw(self) -> u32 {
        match self {
            Self::Standard(id) => id as u32,
            Self::Extended(id) => id,
        }
    }

    /// Whether it has 29 bits.
    pub const fn is_extended(self) -> bool {
        matches!(self, Self::Extended(_))
    }
}

/// As `candump` writes it: three digits, or eight.
impl fmt::Display for CanId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Standard(id) => write!(f, "{id:03X}"),
            Self::Extended(id) => write!(f, "{id:08X}"),
        }
    }
}
