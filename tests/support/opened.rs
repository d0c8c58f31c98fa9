//! Frames of a bus, opened: those of an armed session with the numbers that were exchanged before
//! it. For one rig, node 1.

use can_protocol::{
    ArmItem, ArmMessage, ArmSide, Command, Cyclic, Measurement, Message, MessageId, Node, Profile,
    Receiver, ReceiverState, SessionCode,
};

/// What a listener knows so far.
#[derive(Debug, Default)]
pub(crate) struct Opened {
    host_number: Option<u32>,
    rig_number: Option<u32>,
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
                    self.follow(message);
                }
                Some(message)
            }
        }
    }

    fn follow(&mut self, message: &ArmMessage) {
        match (message.side, message.item) {
            (ArmSide::Host, ArmItem::HostNumber) => self.host_number = Some(message.value),
            (ArmSide::Rig, ArmItem::RigNumber) => self.rig_number = Some(message.value),
            (ArmSide::Rig, ArmItem::Armed) => {
                let numbers = self.host_number.zip(self.rig_number);
                self.code = numbers.map(|(host, rig)| SessionCode::of(host, rig));
            }
            _ => {}
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
