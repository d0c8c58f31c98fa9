//! An exchange that somebody else listens to: a bus log, a tool, a test.
use super::item::ArmItem;
use super::message::{ArmMessage, ArmSide};
use crate::SessionCode;

/// Follows the exchange of one rig and knows the code of the session that begins with it.
///
/// ```
/// use can_protocol::arming::FollowedExchange;
/// use can_protocol::{ArmItem, ArmMessage, ArmSide, Node, RunState, SessionCode};
/// let mut exchange = FollowedExchange::default();
/// let mut hear = |side, item, value| {
///     let (node, state) = (Node::ALL[0], RunState::Standby);
///     exchange.hear(&ArmMessage { side, node, counter: 0, state, item, value })
/// };
/// assert_eq!(hear(ArmSide::Host, ArmItem::HostNumber, 0x1234_5678), None);
/// assert_eq!(hear(ArmSide::Rig, ArmItem::RigNumber, 0xDEAD_BEEF), None);
/// let code = SessionCode::of(0x1234_5678, 0xDEAD_BEEF);
/// assert_eq!(hear(ArmSide::Rig, ArmItem::Armed, 0), Some(code));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FollowedExchange {
    host_number: Option<u32>,
    rig_number: Option<u32>,
}

impl FollowedExchange {
    /// Takes notice of a message; the code of the session, where it says that the rig is armed.
    pub fn hear(&mut self, message: &ArmMessage) -> Option<SessionCode> {
        match (message.side, message.item) {
            (ArmSide::Host, ArmItem::HostNumber) => self.host_number = Some(message.value),
            (ArmSide::Rig, ArmItem::RigNumber) => self.rig_number = Some(message.value),
            (ArmSide::Rig, ArmItem::Armed) => {
                let numbers = self.host_number.zip(self.rig_number);
                return numbers.map(|(host, rig)| SessionCode::of(host, rig));
            }
            _ => {}
        }
        None
    }
}
