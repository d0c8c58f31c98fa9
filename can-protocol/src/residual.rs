//! The residual: how far a rig's damper is from its model, as the host sees it.
use crate::command::write_value;
use crate::signal::{Field, FixedPoint, Quantity, Saturated, Word};
use crate::wire_enum::wire_enum;
use crate::{Error, Frame, MessageId, Node, RunState, protection};
use core::fmt;

/// What the host's watch over a rig says, 20 times a second while there is one. For displays and
/// logs: no rig acts on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// The rig that is watched.
    pub node: Node,
    /// Sequence number of the messages about this rig, 0 to 14.
    pub counter: u8,
    /// The host's run state.
    pub state: RunState,
    /// Running rms of measured less modelled force, N, to 0.1 N; `None` before there is one.
    pub rms_n: Option<f64>,
    /// What that means.
    pub watch: Watch,
}

wire_enum! {
    /// State of a watch, as the 4-bit code on the wire. Codes 4 to 15 are reserved.
    Watch in "watch" {
        /// Nothing has been compared yet.
        None = 0, "NONE";
        /// The usual residual is being learnt.
        Learning = 1, "LEARNING";
        /// Within its limit.
        Steady = 2, "STEADY";
        /// Above its limit: the damper is no longer what the model says.
        Drift = 3, "DRIFT";
    }
}

impl Residual {
    /// Sequence number.
    pub const COUNTER: Field = Field::new(8, 4);
    /// Run state.
    pub const STATE: Field = Field::new(12, 4);
    /// Running rms.
    pub const RMS: FixedPoint = FixedPoint::new(16, 24, 10, Quantity::Force);
    /// State of the watch. The four bits behind it are spare and sent as zero.
    pub const WATCH: Field = Field::new(40, 4);

    /// The frame, and what had to be saturated to fit it.
    pub fn encode(&self) -> (Frame, Saturated) {
        let mut word = Word::default();
        let mut saturated = Saturated::empty();
        saturated.set(Saturated::COUNTER, word.put_counter(Self::COUNTER, Some(self.counter)));
        word.put(Self::STATE, u32::from(self.state.code()));
        saturated.set(Saturated::FORCE, word.put_fixed(Self::RMS, self.rms_n));
        word.put(Self::WATCH, u32::from(self.watch.code()));
        (protection::protect(MessageId::Residual(self.node), word, None), saturated)
    }

    /// The residual in a frame.
    ///
    /// # Errors
    /// Not a residual's id, a wrong length or CRC, an invalid counter, a reserved state or watch.
    pub fn decode(id: u16, data: &[u8]) -> Result<Self, Error> {
        let Some(message @ MessageId::Residual(node)) = MessageId::from_raw(id) else {
            return Err(Error::UnknownId { id });
        };
        let word = protection::open(message, data, None)?;
        Ok(Self {
            node,
            counter: word.counter(message, Self::COUNTER)?,
            state: word.code(message, Self::STATE)?,
            rms_n: word.get_fixed(Self::RMS),
            watch: word.code(message, Self::WATCH)?,
        })
    }
}

impl fmt::Display for Residual {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { node, counter, state, watch, .. } = self;
        write!(f, "residual {node} #{counter} {state}")?;
        write_value(f, " rms", self.rms_n, 1.0, "N", 1)?;
        write!(f, " {}", watch.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RESIDUAL: Residual = Residual {
        node: Node::ALL[1],
        counter: 7,
        state: RunState::Run,
        rms_n: Some(412.3),
        watch: Watch::Drift,
    };

    #[test]
    fn construct_and_deconstruct() {
        let (frame, saturated) = RESIDUAL.encode();
        assert!(saturated.is_empty());
        // 412.3 N are 4123 = 0x00101B; counter 7, run 4.
        assert_eq!((frame.id(), &frame.data()[1..]), (0x502, &[0x47, 0x1B, 0x10, 0x00, 0x03][..]));
        assert_eq!(Residual::decode(0x502, frame.data()), Ok(RESIDUAL));
    }

    #[test]
    fn what_does_not_fit_or_is_reserved_is_reported() {
        let (frame, saturated) = Residual { rms_n: Some(1e6), ..RESIDUAL }.encode();
        assert_eq!(saturated, Saturated::FORCE);
        assert_eq!(Residual::decode(0x502, frame.data()).unwrap().rms_n, Some(838_860.7));
        let mut word = Word::default();
        word.put(Residual::STATE, 4);
        word.put(Residual::WATCH, 4);
        let reserved = protection::protect(MessageId::Residual(Node::ALL[1]), word, None);
        assert_eq!(
            Residual::decode(0x502, reserved.data()),
            Err(Error::ReservedCode { id: 0x502, field: "watch", code: 4 })
        );
        let (none, _) = Residual { rms_n: None, ..RESIDUAL }.encode();
        assert_eq!(Residual::decode(0x502, none.data()).unwrap().rms_n, None);
    }
}
