//! The heartbeat: one byte that says who is alive and in which state.
//!
//! It serves people and tools. It has no CRC and feeds no watchdog: only commands and measurements
//! do, and supervision starts with the run state, not with the first heartbeat.
use crate::signal::{Field, Word};
use crate::{Error, Frame, MessageId, RunState, Sender, protection};
use core::fmt;

/// Sender and state, 50 times a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heartbeat {
    /// Who.
    pub sender: Sender,
    /// In which state.
    pub state: RunState,
}

impl Heartbeat {
    /// State, low nibble.
    pub const STATE: Field = Field::new(0, 4);
    /// Number of the sender, high nibble, 0 for the host: the same as in the id.
    pub const SENDER: Field = Field::new(4, 4);

    /// The frame.
    pub fn encode(&self) -> Frame {
        let mut word = Word::default();
        word.put(Self::STATE, u32::from(self.state.code()));
        word.put(Self::SENDER, u32::from(self.sender.number()));
        protection::seal(MessageId::Heartbeat(self.sender), word)
    }

    /// The heartbeat in a frame.
    ///
    /// # Errors
    /// Not a heartbeat's id, a wrong length, a reserved state, a sender other than the id's.
    pub fn decode(id: u16, data: &[u8]) -> Result<Self, Error> {
        let Some(message @ MessageId::Heartbeat(sender)) = MessageId::from_raw(id) else {
            return Err(Error::UnknownId { id });
        };
        let word = protection::open(message, data)?;
        let code = word.get(Self::SENDER);
        if code != u32::from(sender.number()) {
            return Err(Error::ReservedCode { id, field: "sender", code });
        }
        Ok(Self { sender, state: word.code(message, Self::STATE)? })
    }
}

impl fmt::Display for Heartbeat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "heartbeat {} {}", self.sender, self.state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Node;

    const BYTES: [u8; 1] = [0x36];
    const HEARTBEAT: Heartbeat =
        Heartbeat { sender: Sender::Rig(Node::ALL[2]), state: RunState::Safe };

    #[test]
    fn deconstruct() {
        let word = Word::from_bytes(&BYTES);
        assert_eq!(word.get(Heartbeat::STATE), 6);
        assert_eq!(word.get(Heartbeat::SENDER), 3);
    }

    #[test]
    fn construct() {
        let mut word = Word::default();
        word.put(Heartbeat::STATE, 6);
        word.put(Heartbeat::SENDER, 3);
        assert_eq!(word, Word::from_bytes(&BYTES));
    }

    #[test]
    fn parse() {
        assert_eq!(Heartbeat::decode(0x703, &BYTES), Ok(HEARTBEAT));
        assert_eq!(
            Heartbeat::decode(0x702, &BYTES),
            Err(Error::ReservedCode { id: 0x702, field: "sender", code: 3 })
        );
    }

    #[test]
    fn emit() {
        let frame = HEARTBEAT.encode();
        assert_eq!((frame.id(), frame.data()), (0x703, &BYTES[..]));
    }
}
