//! A listener on the bus that follows an arming exchange and opens what is sealed after it.

use can_protocol::{
    ArmItem, ArmMessage, ArmSide, Measurement, Node, Profile, Receiver, ReceiverState, Seal,
    SessionCode,
};
use hil_host::bus::WireFrame;

/// What a listener knows of one rig.
#[derive(Debug, Default)]
pub(crate) struct Opener {
    pub(crate) host_number: Option<u32>,
    pub(crate) rig_number: Option<u32>,
    /// The session's code.
    pub(crate) code: Option<SessionCode>,
    pub(crate) receiver: ReceiverState,
}

impl Opener {
    /// Follows every frame; the seal of one that is the next measurement.
    pub(crate) fn hear(&mut self, node: Node, frame: &WireFrame) -> Option<Seal> {
        let (id, data) = (frame.id(), frame.data());
        if let Ok(message) = ArmMessage::decode(id, data) {
            match (message.side, message.item) {
                (ArmSide::Host, ArmItem::HostNumber) => self.host_number = Some(message.value),
                (ArmSide::Rig, ArmItem::RigNumber) => self.rig_number = Some(message.value),
                (ArmSide::Rig, ArmItem::Armed) => {
                    let numbers = self.host_number.zip(self.rig_number);
                    self.code = numbers.map(|(host, rig)| SessionCode::of(host, rig));
                    self.receiver = ReceiverState::default();
                }
                _ => {}
            }
            return None;
        }
        let code = self.code?;
        let receiver = Receiver::<Measurement>::new(Profile::Classical, node, 5).unwrap();
        let reception = receiver.sealed(code).accept(&mut self.receiver, id, data)?;
        let cycle = self.receiver.cycle()?;
        reception.status.delivers().then_some(Seal { code, cycle })
    }
}
