//! A listener that follows an arming exchange and knows the seal of what comes after it.

use crate::bus::WireFrame;
use can_protocol::{
    ArmItem, ArmMessage, ArmSide, Measurement, Node, Profile, Receiver, ReceiverState, Seal,
    SessionCode,
};

/// Follows the arming exchange, to know the seal of every measurement: a fault of a sensor lies
/// before its frame is sealed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Opener {
    host_number: Option<u32>,
    rig_number: Option<u32>,
    code: Option<SessionCode>,
    receiver: ReceiverState,
}

impl Opener {
    /// A listener that knows the code of a session whose arming it did not hear.
    pub fn of(code: SessionCode) -> Self {
        Self { code: Some(code), ..Self::default() }
    }

    /// Takes a frame; the seal of one that is the next measurement.
    pub fn hear(&mut self, node: Node, frame: &WireFrame) -> Option<Seal> {
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
        let receiver = Receiver::<Measurement>::new(Profile::Classical, node, 5).ok()?;
        let reception = receiver.sealed(code).accept(&mut self.receiver, id, data)?;
        let cycle = self.receiver.cycle()?;
        reception.status.delivers().then_some(Seal { code, cycle })
    }
}
