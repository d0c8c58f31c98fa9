//! Pressure off: the host asks one rig, or all, to drop the pressure.
//!
//! It has the lowest id of the protocol and a plain CRC, and a rig obeys it in every state: nothing
//! has to be armed or agreed for it. A host sends it where a displacement is not believed, so that
//! holding a position would be no safe state. It is a request over a bus and no safety function:
//! the pressure dump of the emergency stop is hard-wired.
use crate::fault::Report;
use crate::signal::{Field, Saturated};
use crate::{Error, Fault, FaultCode, Frame, MessageId, Node, RunState};
use core::fmt;

/// The host's request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PressureOff {
    /// The rig; `None` for all rigs.
    pub node: Option<Node>,
    /// Sequence number of the host's requests under this id, 0 to 14. A request counts whatever
    /// its number is; a repeat is the same request.
    pub counter: u8,
    /// The host's run state.
    pub state: RunState,
    /// Why.
    pub code: FaultCode,
    /// How much, as in a [`Fault`].
    pub detail: u16,
}

impl PressureOff {
    /// Sequence number.
    pub const COUNTER: Field = Fault::COUNTER;
    /// Run state.
    pub const STATE: Field = Fault::STATE;
    /// Fault code.
    pub const CODE: Field = Fault::CODE;
    /// Detail.
    pub const DETAIL: Field = Fault::DETAIL;

    /// The frame, and whether the counter did not fit.
    pub fn encode(&self) -> (Frame, Saturated) {
        let Self { node, counter, state, code, detail } = *self;
        Report { counter, state, code, detail }.encode(MessageId::PressureOff(node))
    }

    /// The request in a frame.
    ///
    /// # Errors
    /// Not a pressure-off id, a wrong length or CRC, an invalid counter, a reserved state.
    pub fn decode(id: u16, data: &[u8]) -> Result<Self, Error> {
        let Some(message @ MessageId::PressureOff(node)) = MessageId::from_raw(id) else {
            return Err(Error::UnknownId { id });
        };
        let Report { counter, state, code, detail } = Report::decode(message, data)?;
        Ok(Self { node, counter, state, code, detail })
    }

    /// Whether the request is for this rig.
    ///
    /// ```
    /// use can_protocol::{FaultCode, Node, PressureOff, RunState};
    /// let (counter, state, code) = (0, RunState::Safe, FaultCode::Sensor);
    /// let to = |node| PressureOff { node, counter, state, code, detail: 2 };
    /// let (two, three) = (Node::new(2)?, Node::new(3)?);
    /// assert!(to(None).is_for(two) && to(Some(two)).is_for(two));
    /// assert!(!to(Some(three)).is_for(two));
    /// # Ok::<(), can_protocol::Error>(())
    /// ```
    pub fn is_for(&self, node: Node) -> bool {
        self.node.is_none_or(|addressed| addressed == node)
    }
}

impl fmt::Display for PressureOff {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { node, counter, state, code, detail } = self;
        f.write_str("pressure off ")?;
        match node {
            Some(node) => write!(f, "{node}")?,
            None => f.write_str("ALL")?,
        }
        write!(f, " #{counter} {state} {} ({}) {detail}", code.name(), code.code())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Word;

    const BYTES: [u8; 6] = [0x83, 0x63, 0x20, 0x00, 0x02, 0x00];
    const PRESSURE_OFF: PressureOff = PressureOff {
        node: Some(Node::ALL[1]),
        counter: 3,
        state: RunState::Safe,
        code: FaultCode::Sensor,
        detail: 2,
    };

    #[test]
    fn deconstruct() {
        let word = Word::from_bytes(&BYTES);
        let fields =
            [PressureOff::COUNTER, PressureOff::STATE, PressureOff::CODE, PressureOff::DETAIL];
        assert_eq!(fields.map(|field| word.get(field)), [3, 6, 32, 2]);
    }

    #[test]
    fn parse() {
        assert_eq!(PressureOff::decode(0x042, &BYTES), Ok(PRESSURE_OFF));
    }

    #[test]
    fn emit() {
        let (frame, saturated) = PRESSURE_OFF.encode();
        assert_eq!((frame.id(), frame.data()), (0x042, &BYTES[..]));
        assert!(saturated.is_empty());
        let (to_all, _) = PressureOff { node: None, ..PRESSURE_OFF }.encode();
        assert_eq!(to_all.id(), 0x040);
    }
}
