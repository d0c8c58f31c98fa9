//! One message of the arming exchange, either way.
use super::item::ArmItem;
use crate::signal::{Field, Saturated, Word};
use crate::{Error, Frame, MessageId, Node, RunState, protection};
use core::fmt;

/// Which side sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ArmSide {
    /// The host asks, `0x600 + n`.
    Host,
    /// The rig answers, `0x610 + n`.
    Rig,
}

/// An item and its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArmMessage {
    /// Who sends.
    pub side: ArmSide,
    /// The rig that is to be armed.
    pub node: Node,
    /// Sequence number of the sender's arming messages with this rig, 0 to 14. It is for people
    /// and logs: a message counts by its item and value.
    pub counter: u8,
    /// The sender's run state.
    pub state: RunState,
    /// What.
    pub item: ArmItem,
    /// Its value.
    pub value: u32,
}

impl ArmMessage {
    /// Sequence number.
    pub const COUNTER: Field = Field::new(8, 4);
    /// Run state.
    pub const STATE: Field = Field::new(12, 4);
    /// Item: page in the high byte, place on the page in the low byte.
    pub const ITEM: Field = Field::new(16, 16);
    /// Value.
    pub const VALUE: Field = Field::new(32, 32);

    /// The frame, and whether the counter did not fit.
    pub fn encode(&self) -> (Frame, Saturated) {
        let mut word = Word::default();
        let mut saturated = Saturated::empty();
        saturated.set(Saturated::COUNTER, word.put_counter(Self::COUNTER, Some(self.counter)));
        word.put(Self::STATE, u32::from(self.state.code()));
        word.put(Self::ITEM, u32::from(self.item.code()));
        word.put(Self::VALUE, self.value);
        let message = match self.side {
            ArmSide::Host => MessageId::ArmRequest(self.node),
            ArmSide::Rig => MessageId::ArmAnswer(self.node),
        };
        (protection::protect(message, word, None), saturated)
    }

    /// The message in a frame.
    ///
    /// # Errors
    /// Not an arming id, a wrong length or CRC, an invalid counter, a reserved state or item.
    pub fn decode(id: u16, data: &[u8]) -> Result<Self, Error> {
        let message = MessageId::from_raw(id).ok_or(Error::UnknownId { id })?;
        let (side, node) = match message {
            MessageId::ArmRequest(node) => (ArmSide::Host, node),
            MessageId::ArmAnswer(node) => (ArmSide::Rig, node),
            _ => return Err(Error::UnknownId { id }),
        };
        let word = protection::open(message, data, None)?;
        Ok(Self {
            side,
            node,
            counter: word.counter(message, Self::COUNTER)?,
            state: word.code(message, Self::STATE)?,
            item: word.code(message, Self::ITEM)?,
            value: word.get(Self::VALUE),
        })
    }
}

impl fmt::Display for ArmMessage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { side, node, counter, state, item, value } = self;
        let side = if *side == ArmSide::Host { "request" } else { "answer" };
        write!(f, "arming {side} {node} #{counter} {state} {item} {value:#010x}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BYTES: [u8; 8] = [0x15, 0x14, 0x01, 0x05, 0xEF, 0xBE, 0xAD, 0xDE];
    const ARM: ArmMessage = ArmMessage {
        side: ArmSide::Host,
        node: Node::ALL[1],
        counter: 4,
        state: RunState::Standby,
        item: ArmItem::Arm,
        value: 0xDEAD_BEEF,
    };

    #[test]
    fn deconstruct() {
        let word = Word::from_bytes(&BYTES);
        for (field, code) in [
            (ArmMessage::COUNTER, 4),
            (ArmMessage::STATE, 1),
            (ArmMessage::ITEM, 0x0501),
            (ArmMessage::VALUE, 0xDEAD_BEEF),
        ] {
            assert_eq!(word.get(field), code);
        }
    }

    #[test]
    fn parse() {
        assert_eq!(ArmMessage::decode(0x602, &BYTES), Ok(ARM));
        assert_eq!(ArmMessage::decode(0x702, &BYTES), Err(Error::UnknownId { id: 0x702 }));
    }

    #[test]
    fn emit() {
        let (frame, saturated) = ARM.encode();
        assert_eq!((frame.id(), frame.data()), (0x602, &BYTES[..]));
        assert!(saturated.is_empty());
        assert_eq!(ArmMessage { side: ArmSide::Rig, ..ARM }.encode().0.id(), 0x612);
    }
}
