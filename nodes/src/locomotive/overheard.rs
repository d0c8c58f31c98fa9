//! Frames on a bus that only a host sends: this host hears none of its own.

use crate::WireFrame;
use can_protocol::{Message, MessageId};
use firmware_core::supervision::{Frames, SecondSender};

/// What a bus has of another host.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Overheard {
    /// Id of a valid frame of another host in this cycle.
    valid: Option<u16>,
    /// Id of a command that may be sealed by another session, or damaged.
    unknown: Option<u16>,
    judge: SecondSender,
}

impl Overheard {
    /// Takes notice of a frame that is no rig's.
    pub fn take(&mut self, frame: &WireFrame) {
        let id = frame.id();
        let Some(message) = MessageId::from_raw(id).filter(|message| message.is_of_host()) else {
            return;
        };
        if Message::decode(id, frame.data()).is_ok() {
            self.valid = Some(id);
        } else if matches!(message, MessageId::Command(..)) {
            self.unknown = Some(id);
        }
    }

    /// A cycle has passed; the id under which another host sends, where there is evidence of one.
    pub fn judge(&mut self) -> Option<u16> {
        let (valid, unknown) = (self.valid.take(), self.unknown.take());
        let is_other = unknown.is_some();
        let frames = Frames { good: is_other, bad: is_other, ..Frames::default() };
        let has_evidence = self.judge.take(frames);
        valid.or(unknown.filter(|_| has_evidence))
    }
}
