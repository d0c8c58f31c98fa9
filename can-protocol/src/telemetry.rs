//! Telemetry: a rig's slow values, to read and never to set.
use crate::command::write_value;
use crate::signal::{Field, FixedPoint, Quantity, Saturated, Word};
use crate::wire_enum::wire_enum;
use crate::{Error, Frame, MessageId, Node, RunState, protection};
use core::fmt;

/// Slow values of a rig, 20 times a second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Telemetry {
    /// The rig.
    pub node: Node,
    /// Sequence number of the rig's telemetry, 0 to 14.
    pub counter: u8,
    /// The rig's run state.
    pub state: RunState,
    /// Temperature of the damper, °C, to 0.01 °C.
    pub temperature_degc: Option<f64>,
    /// State of the supply pressure.
    pub pressure: Pressure,
    /// Guards and limits that have tripped.
    pub trips: Trips,
}

wire_enum! {
    /// State of the supply pressure, as the 4-bit code on the wire. Codes 5 to 15 are reserved.
    Pressure in "pressure" {
        /// The rig does not know, or has none to know of.
        Unknown = 0, "UNKNOWN";
        /// Off.
        Off = 1, "OFF";
        /// Rising, not yet usable.
        Rising = 2, "RISING";
        /// In range.
        Ready = 3, "READY";
        /// Out of range.
        OutOfRange = 4, "OUT_OF_RANGE";
    }
}

bitflags::bitflags! {
    /// Guards and limits of the rig that have tripped. They are the rig's own; no message of this
    /// protocol sets or resets one.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct Trips: u8 {
        /// Force limit.
        const FORCE_LIMIT = 1;
        /// Stroke limit.
        const STROKE_LIMIT = 1 << 1;
        /// Velocity limit.
        const VELOCITY_LIMIT = 1 << 2;
        /// Temperature limit.
        const TEMPERATURE_LIMIT = 1 << 3;
        /// The actuator was too far from its command.
        const TRACKING = 1 << 4;
        /// The rig's watchdog: nothing valid from the host.
        const WATCHDOG = 1 << 5;
        /// A guard door is open.
        const GUARD_OPEN = 1 << 6;
        /// The emergency stop is open.
        const EMERGENCY_STOP = 1 << 7;
    }
}

impl Telemetry {
    /// Sequence number.
    pub const COUNTER: Field = Field::new(8, 4);
    /// Run state.
    pub const STATE: Field = Field::new(12, 4);
    /// Temperature.
    pub const TEMPERATURE: FixedPoint = FixedPoint::new(16, 16, 100, Quantity::Temperature);
    /// Pressure state. The four bits behind it are spare and sent as zero.
    pub const PRESSURE: Field = Field::new(32, 4);
    /// Trips, one bit each.
    pub const TRIPS: Field = Field::new(40, 8);

    /// The frame, and what had to be saturated to fit it.
    pub fn encode(&self) -> (Frame, Saturated) {
        let mut word = Word::default();
        let mut saturated = Saturated::empty();
        saturated.set(Saturated::COUNTER, word.put_counter(Self::COUNTER, Some(self.counter)));
        word.put(Self::STATE, u32::from(self.state.code()));
        saturated
            .set(Saturated::TEMPERATURE, word.put_fixed(Self::TEMPERATURE, self.temperature_degc));
        word.put(Self::PRESSURE, u32::from(self.pressure.code()));
        word.put(Self::TRIPS, u32::from(self.trips.bits()));
        (protection::protect(MessageId::Telemetry(self.node), word, None), saturated)
    }

    /// The telemetry in a frame.
    ///
    /// # Errors
    /// Not a telemetry id, a wrong length or CRC, an invalid counter, a reserved state or pressure.
    pub fn decode(id: u16, data: &[u8]) -> Result<Self, Error> {
        let Some(message @ MessageId::Telemetry(node)) = MessageId::from_raw(id) else {
            return Err(Error::UnknownId { id });
        };
        let word = protection::open(message, data, None)?;
        Ok(Self {
            node,
            counter: word.counter(message, Self::COUNTER)?,
            state: word.code(message, Self::STATE)?,
            temperature_degc: word.get_fixed(Self::TEMPERATURE),
            pressure: word.code(message, Self::PRESSURE)?,
            trips: Trips::from_bits_truncate(word.get(Self::TRIPS) as u8),
        })
    }
}

impl fmt::Display for Telemetry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { node, counter, state, pressure, .. } = self;
        write!(f, "telemetry {node} #{counter} {state}")?;
        write_value(f, " temperature", self.temperature_degc, 1.0, "degC", 2)?;
        write!(f, " pressure {}", pressure.name())?;
        self.trips.iter_names().try_for_each(|(name, _)| write!(f, " {name}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BYTES: [u8; 6] = [0x5C, 0x4E, 0x1D, 0x10, 0x03, 0x22];

    fn telemetry() -> Telemetry {
        Telemetry {
            node: Node::ALL[2],
            counter: 14,
            state: RunState::Run,
            temperature_degc: Some(41.25),
            pressure: Pressure::Ready,
            trips: Trips::STROKE_LIMIT | Trips::WATCHDOG,
        }
    }

    #[test]
    fn deconstruct() {
        let word = Word::from_bytes(&BYTES);
        let fields = [
            Telemetry::COUNTER,
            Telemetry::STATE,
            Telemetry::TEMPERATURE.field(),
            Telemetry::PRESSURE,
            Telemetry::TRIPS,
        ];
        assert_eq!(fields.map(|field| word.get(field)), [14, 4, 4125, 3, 0x22]);
    }

    #[test]
    fn construct() {
        let mut word = Word::default();
        word.put(Field::new(0, 8), 0x5C);
        word.put(Telemetry::COUNTER, 14);
        word.put(Telemetry::STATE, 4);
        word.put(Telemetry::TEMPERATURE.field(), 4125);
        word.put(Telemetry::PRESSURE, 3);
        word.put(Telemetry::TRIPS, 0x22);
        assert_eq!(word, Word::from_bytes(&BYTES));
    }

    #[test]
    fn parse() {
        assert_eq!(Telemetry::decode(0x403, &BYTES), Ok(telemetry()));
    }

    #[test]
    fn emit() {
        let (frame, saturated) = telemetry().encode();
        assert_eq!((frame.id(), frame.data()), (0x403, &BYTES[..]));
        assert!(saturated.is_empty());
        let (_, saturated) = Telemetry { temperature_degc: Some(400.0), ..telemetry() }.encode();
        assert_eq!(saturated, Saturated::TEMPERATURE);
    }
}
