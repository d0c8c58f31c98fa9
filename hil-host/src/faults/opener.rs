//! A listener that follows an arming exchange and knows the seal of what comes after it.

use crate::bus::WireFrame;
use can_protocol::arming::FollowedExchange;
use can_protocol::{
    ArmMessage, Measurement, Node, Profile, Receiver, ReceiverState, Seal, SessionCode,
};

/// Follows the arming exchange, to know the seal of every measurement: a fault of a sensor lies
/// before its frame is sealed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Opener {
    exchange: FollowedExchange,
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
            // Other rigs are armed on the same bus.
            if message.node == node
                && let Some(code) = self.exchange.hear(&message)
            {
                (self.code, self.receiver) = (Some(code), ReceiverState::default());
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
