//! The fault: what went wrong, sent when it changes, by either side.
use crate::signal::{Field, Saturated, Word};
use crate::{Error, Frame, MessageId, RunState, Sender, protection};
use core::fmt;

/// A fault, or its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Who reports.
    pub sender: Sender,
    /// Sequence number of the sender's fault messages, 0 to 14.
    pub counter: u8,
    /// The sender's run state.
    pub state: RunState,
    /// What.
    pub code: FaultCode,
    /// How much; the meaning depends on the code.
    pub detail: u16,
}

macro_rules! fault_codes {
    ($($(#[$doc:meta])* $variant:ident = $code:literal, $name:literal;)*) => {
        /// What went wrong. Limits give `detail` in per mille of the limit.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum FaultCode {
            $($(#[$doc])* $variant,)*
            /// A code that this version does not list: a fault is never dropped for its number.
            Other(u16),
        }

        impl FaultCode {
            /// All listed codes.
            pub const LISTED: &'static [Self] = &[$(Self::$variant),*];

            /// The code on the wire.
            pub const fn code(self) -> u16 {
                match self {
                    $(Self::$variant => $code,)*
                    Self::Other(code) => code,
                }
            }

            /// The fault of a code.
            pub const fn from_code(code: u16) -> Self {
                match code {
                    $($code => Self::$variant,)*
                    _ => Self::Other(code),
                }
            }

            /// The name in the DBC.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                    Self::Other(_) => "OTHER",
                }
            }
        }
    };
}

fault_codes! {
    /// No fault any more. Detail 0.
    Cleared = 0, "CLEARED";
    /// Nothing valid from the peer. Detail: cycles.
    PeerSilent = 1, "PEER_SILENT";
    /// Too many frames of the peer failed their protection. Detail: frames.
    Protection = 2, "PROTECTION";
    /// The peer's run state does not fit ours. Detail: the peer's state code.
    StateMismatch = 3, "STATE_MISMATCH";
    /// Protocol version, profile or pace is not ours. Detail: the peer's version.
    ConfigurationMismatch = 4, "CONFIGURATION_MISMATCH";
    /// The controller went bus-off. Detail 0.
    BusOff = 5, "BUS_OFF";
    /// The cycle took too long. Detail: slots missed.
    Overrun = 6, "OVERRUN";
    /// Force limit. Detail: per mille of the limit.
    ForceLimit = 16, "FORCE_LIMIT";
    /// Stroke limit. Detail: per mille of the limit.
    StrokeLimit = 17, "STROKE_LIMIT";
    /// Velocity limit. Detail: per mille of the limit.
    VelocityLimit = 18, "VELOCITY_LIMIT";
    /// Temperature limit. Detail: per mille of the limit.
    TemperatureLimit = 19, "TEMPERATURE_LIMIT";
    /// The actuator is too far from its command. Detail: µm.
    Tracking = 20, "TRACKING";
    /// The exchanged energy has the wrong sign. Detail: J.
    Energy = 21, "ENERGY";
    /// A sensor failed. Detail: 1 force, 2 displacement of the ram, 3 displacement across the
    /// eyes, 4 temperature.
    Sensor = 32, "SENSOR";
    /// The actuator or its controller failed. Detail: the controller's own number.
    Actuator = 33, "ACTUATOR";
    /// Supply pressure lost. Detail 0.
    PressureLost = 34, "PRESSURE_LOST";
    /// A guard door opened. Detail 0.
    GuardOpen = 35, "GUARD_OPEN";
    /// The emergency stop, which is outside all software, was seen open. Detail 0.
    EmergencyStop = 36, "EMERGENCY_STOP";
    /// A program error. Detail: the sender's own number.
    Internal = 48, "INTERNAL";
}

impl Fault {
    /// Sequence number.
    pub const COUNTER: Field = Field::new(8, 4);
    /// Run state.
    pub const STATE: Field = Field::new(12, 4);
    /// Fault code.
    pub const CODE: Field = Field::new(16, 16);
    /// Detail.
    pub const DETAIL: Field = Field::new(32, 16);

    /// The frame, and whether the counter did not fit.
    pub fn encode(&self) -> (Frame, Saturated) {
        let Self { sender, counter, state, code, detail } = *self;
        Report { counter, state, code, detail }.encode(MessageId::Fault(sender))
    }

    /// The fault in a frame.
    ///
    /// # Errors
    /// Not a fault's id, a wrong length or CRC, an invalid counter, a reserved state.
    pub fn decode(id: u16, data: &[u8]) -> Result<Self, Error> {
        let Some(message @ MessageId::Fault(sender)) = MessageId::from_raw(id) else {
            return Err(Error::UnknownId { id });
        };
        let Report { counter, state, code, detail } = Report::decode(message, data)?;
        Ok(Self { sender, counter, state, code, detail })
    }
}

/// What went wrong, as a fault and a request for pressure off have it on the wire.
pub(crate) struct Report {
    pub(crate) counter: u8,
    pub(crate) state: RunState,
    pub(crate) code: FaultCode,
    pub(crate) detail: u16,
}

impl Report {
    pub(crate) fn encode(&self, message: MessageId) -> (Frame, Saturated) {
        let mut word = Word::default();
        let mut saturated = Saturated::empty();
        saturated.set(Saturated::COUNTER, word.put_counter(Fault::COUNTER, Some(self.counter)));
        word.put(Fault::STATE, u32::from(self.state.code()));
        word.put(Fault::CODE, u32::from(self.code.code()));
        word.put(Fault::DETAIL, u32::from(self.detail));
        (protection::protect(message, word, None), saturated)
    }

    pub(crate) fn decode(message: MessageId, data: &[u8]) -> Result<Self, Error> {
        let word = protection::open(message, data, None)?;
        Ok(Self {
            counter: word.counter(message, Fault::COUNTER)?,
            state: word.code(message, Fault::STATE)?,
            code: FaultCode::from_code(word.get(Fault::CODE) as u16),
            detail: word.get(Fault::DETAIL) as u16,
        })
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sender, counter, state, code, detail } = self;
        write!(f, "fault {sender} #{counter} {state} {} ({}) {detail}", code.name(), code.code())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Node;

    const BYTES: [u8; 6] = [0x7B, 0x65, 0x01, 0x00, 0x05, 0x00];
    const FAULT: Fault = Fault {
        sender: Sender::Rig(Node::ALL[1]),
        counter: 5,
        state: RunState::Safe,
        code: FaultCode::PeerSilent,
        detail: 5,
    };

    #[test]
    fn deconstruct() {
        let word = Word::from_bytes(&BYTES);
        let fields = [Fault::COUNTER, Fault::STATE, Fault::CODE, Fault::DETAIL];
        assert_eq!(fields.map(|field| word.get(field)), [5, 6, 1, 5]);
    }

    #[test]
    fn construct() {
        let mut word = Word::default();
        word.put(Field::new(0, 8), 0x7B);
        word.put(Fault::COUNTER, 5);
        word.put(Fault::STATE, 6);
        word.put(Fault::CODE, 1);
        word.put(Fault::DETAIL, 5);
        assert_eq!(word, Word::from_bytes(&BYTES));
    }

    #[test]
    fn parse() {
        assert_eq!(Fault::decode(0x302, &BYTES), Ok(FAULT));
    }

    #[test]
    fn emit() {
        let (frame, saturated) = FAULT.encode();
        assert_eq!((frame.id(), frame.data()), (0x302, &BYTES[..]));
        assert!(saturated.is_empty());
    }

    #[test]
    fn every_code_survives_listed_or_not() {
        for code in 0..=u16::MAX {
            assert_eq!(FaultCode::from_code(code).code(), code);
        }
        assert!(FaultCode::LISTED.is_sorted_by_key(|fault| fault.code()));
    }
}
