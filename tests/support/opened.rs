//! Frames of a bus, opened: those of an armed session with the numbers that were exchanged before
//! it. For one rig, node 1.

use can_protocol::arming::FollowedExchange;
use can_protocol::{
    Command, Cyclic, Measurement, Message, MessageId, Node, Profile, Receiver, ReceiverState,
    SessionCode,
};

/// What a listener knows so far.
#[derive(Debug, Default)]
pub(crate) struct Opened {
    exchange: FollowedExchange,
    code: Option<SessionCode>,
    commands: ReceiverState,
    measurements: ReceiverState,
}

impl Opened {
    /// The message in the next frame; none where it is damaged, repeated or of nobody known.
    pub(crate) fn hear(&mut self, id: u16, data: &[u8]) -> Option<Message> {
        match (MessageId::from_raw(id)?, self.code) {
            (MessageId::Command(profile, _), Some(code)) => {
                opened::<Command>(&mut self.commands, profile, code, id, data).map(Message::Command)
            }
            (MessageId::Measurement(profile, _), Some(code)) => {
                opened::<Measurement>(&mut self.measurements, profile, code, id, data)
                    .map(Message::Measurement)
            }
            _ => {
                let message = Message::decode(id, data).ok()?;
                if let Message::Arm(message) = &message {
                    self.code = self.exchange.hear(message).or(self.code);
                }
                Some(message)
            }
        }
    }
}

fn opened<M: Cyclic>(
    state: &mut ReceiverState,
    profile: Profile,
    code: SessionCode,
    id: u16,
    data: &[u8],
) -> Option<M> {
    let receiver = Receiver::<M>::new(profile, Node::ALL[0], 5).expect("a receiver");
    receiver.sealed(code).accept(state, id, data)?.data
}
