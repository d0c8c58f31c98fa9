//! The heartbeat: who is alive, in which state, and since which start.
//!
//! It feeds no watchdog: only commands and measurements do, and supervision starts with the run
//! state, not with the first heartbeat. Its **boot number**, 32 bits that a peer draws at each of
//! its starts, shows a peer that restarted and a second peer under the same number
//! ([`crate::arming::Quiet`]).
use crate::signal::{Field, Saturated, Word};
use crate::{Error, Frame, MessageId, PROTOCOL_VERSION, RunState, Sender, protection};
use core::fmt;

/// Sender and state, 50 times a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heartbeat {
    /// Who.
    pub sender: Sender,
    /// Sequence number of the sender's heartbeats, 0 to 14.
    pub counter: u8,
    /// In which state.
    pub state: RunState,
    /// Number that the sender drew at its start.
    pub boot: u32,
    /// What the sender says of itself.
    pub flags: HeartbeatFlags,
    /// Version of the sender's protocol, 0 to 15; [`PROTOCOL_VERSION`] is ours.
    pub version: u8,
}

bitflags::bitflags! {
    /// The flags of a heartbeat; the six bits above are spare and sent as zero.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct HeartbeatFlags: u8 {
        /// Motion is enabled by the rig's own key switch. The host sends 0.
        const ENABLED = 1;
        /// The rig is latched in SAFE or FAULT until it is reset. The host sends 0.
        const LATCHED = 1 << 1;
    }
}

impl Heartbeat {
    /// Sequence number.
    pub const COUNTER: Field = Field::new(8, 4);
    /// State.
    pub const STATE: Field = Field::new(12, 4);
    /// Boot number.
    pub const BOOT: Field = Field::new(16, 32);
    /// Flags, one bit each.
    pub const FLAGS: Field = Field::new(48, 8);
    /// Version.
    pub const VERSION: Field = Field::new(56, 4);
    /// Number of the sender, 0 for the host: the same as in the id.
    pub const SENDER: Field = Field::new(60, 4);

    /// A heartbeat of this version without flags.
    pub const fn new(sender: Sender, counter: u8, state: RunState, boot: u32) -> Self {
        let (flags, version) = (HeartbeatFlags::empty(), PROTOCOL_VERSION);
        Self { sender, counter, state, boot, flags, version }
    }

    /// The frame, and whether the counter did not fit.
    pub fn encode(&self) -> (Frame, Saturated) {
        let mut word = Word::default();
        let mut saturated = Saturated::empty();
        saturated.set(Saturated::COUNTER, word.put_counter(Self::COUNTER, Some(self.counter)));
        word.put(Self::STATE, u32::from(self.state.code()));
        word.put(Self::BOOT, self.boot);
        word.put(Self::FLAGS, u32::from(self.flags.bits()));
        word.put(Self::VERSION, u32::from(self.version).min(Self::VERSION.ones()));
        word.put(Self::SENDER, u32::from(self.sender.number()));
        (protection::protect(MessageId::Heartbeat(self.sender), word, None), saturated)
    }

    /// The heartbeat in a frame. A foreign version is not an error here: compare it.
    ///
    /// # Errors
    /// Not a heartbeat's id, a wrong length or CRC, an invalid counter, a reserved state, a sender
    /// other than the id's.
    pub fn decode(id: u16, data: &[u8]) -> Result<Self, Error> {
        let Some(message @ MessageId::Heartbeat(sender)) = MessageId::from_raw(id) else {
            return Err(Error::UnknownId { id });
        };
        let word = protection::open(message, data, None)?;
        let code = word.get(Self::SENDER);
        if code != u32::from(sender.number()) {
            return Err(Error::ReservedCode { id, field: "sender", code });
        }
        Ok(Self {
            sender,
            counter: word.counter(message, Self::COUNTER)?,
            state: word.code(message, Self::STATE)?,
            boot: word.get(Self::BOOT),
            flags: HeartbeatFlags::from_bits_truncate(word.get(Self::FLAGS) as u8),
            version: word.get(Self::VERSION) as u8,
        })
    }
}

impl fmt::Display for Heartbeat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sender, counter, state, boot, flags, version } = self;
        write!(f, "heartbeat {sender} #{counter} {state} v{version} boot {boot:08x}")?;
        flags.iter_names().try_for_each(|(name, _)| write!(f, " {name}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Node;

    const BYTES: [u8; 8] = [0x58, 0x67, 0xEF, 0xBE, 0xAD, 0xDE, 0x01, 0x32];
    const HEARTBEAT: Heartbeat = Heartbeat {
        sender: Sender::Rig(Node::ALL[2]),
        counter: 7,
        state: RunState::Safe,
        boot: 0xDEAD_BEEF,
        flags: HeartbeatFlags::ENABLED,
        version: PROTOCOL_VERSION,
    };

    #[test]
    fn deconstruct() {
        let word = Word::from_bytes(&BYTES);
        for (field, code) in [
            (Heartbeat::COUNTER, 7),
            (Heartbeat::STATE, 6),
            (Heartbeat::BOOT, 0xDEAD_BEEF),
            (Heartbeat::FLAGS, 1),
            (Heartbeat::VERSION, 2),
            (Heartbeat::SENDER, 3),
        ] {
            assert_eq!(word.get(field), code);
        }
    }

    #[test]
    fn parse() {
        assert_eq!(Heartbeat::decode(0x703, &BYTES), Ok(HEARTBEAT));
    }

    #[test]
    fn emit() {
        let (frame, saturated) = HEARTBEAT.encode();
        assert_eq!((frame.id(), frame.data()), (0x703, &BYTES[..]));
        assert!(saturated.is_empty());
    }

    #[test]
    fn a_sender_other_than_the_ids_is_refused() {
        let mut word = Word::default();
        word.put(Heartbeat::SENDER, 3);
        let frame =
            protection::protect(MessageId::Heartbeat(Sender::Rig(Node::ALL[1])), word, None);
        assert_eq!(
            Heartbeat::decode(0x702, frame.data()),
            Err(Error::ReservedCode { id: 0x702, field: "sender", code: 3 })
        );
    }
}
