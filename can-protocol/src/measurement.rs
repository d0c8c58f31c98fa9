//! The measurement: what a rig felt, once per cycle.
use crate::command::{write_echo, write_time, write_value};
use crate::signal::{Field, FixedPoint, Quantity, Saturated, Word};
use crate::{Error, Frame, MessageId, Node, Profile, RunState, Seal, protection};
use core::fmt;

/// A rig's answer to a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// The rig.
    pub node: Node,
    /// Sequence number, 0 up to [`Profile::counter_modulus`], exclusive.
    pub counter: u8,
    /// The rig's run state.
    pub state: RunState,
    /// What the rig says about its values.
    pub flags: MeasurementFlags,
    /// Counter of the last [`Command`](crate::Command) the rig accepted.
    pub echo: Option<u8>,
    /// Damper force, tension positive, N.
    pub force_n: Option<f64>,
    /// Damper displacement, extension positive, m.
    pub displacement_m: Option<f64>,
    /// The rig's clock, µs, modulo 2^24. FD only; the classical frame has no room.
    pub time_us: Option<u32>,
}

bitflags::bitflags! {
    /// The four flags of a measurement.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct MeasurementFlags: u8 {
        /// A value of this frame is at the end of its range on the wire. Set by
        /// [`Measurement::encode`] itself when it had to saturate.
        const SATURATED = 1;
        /// A limit of the rig (stroke, rate, force) changed the command.
        const LIMIT_REACHED = 1 << 1;
        /// A sensor failed its own check; its value is invalid or not to be trusted.
        const SENSOR_INVALID = 1 << 2;
        /// The actuator is further behind its command than the rig allows.
        const ACTUATOR_LAGGING = 1 << 3;
    }
}

/// Where the fields of a measurement sit behind its CRC.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasurementLayout {
    /// Sequence number.
    pub counter: Field,
    /// Run state.
    pub state: Field,
    /// Flags.
    pub flags: Field,
    /// Counter last accepted from the host.
    pub echo: Field,
    /// Force.
    pub force: FixedPoint,
    /// Displacement.
    pub displacement: FixedPoint,
    /// Time in µs.
    pub time: Option<Field>,
}

impl MeasurementLayout {
    /// 8 bytes: CRC8 | counter 4, state 4 | force i20 | displacement i20 | echo 4, flags 4.
    pub const CLASSICAL: Self = Self {
        counter: Field::new(8, 4),
        state: Field::new(12, 4),
        force: FixedPoint::new(16, 20, 5, Quantity::Force),
        displacement: FixedPoint::new(36, 20, 5_000_000, Quantity::Displacement),
        echo: Field::new(56, 4),
        flags: Field::new(60, 4),
        time: None,
    };

    /// 16 bytes: CRC16 | counter 8 | echo 8 | state 4, flags 4 | force i32 | displacement i32 |
    /// time u24.
    pub const FD: Self = Self {
        counter: Field::new(16, 8),
        echo: Field::new(24, 8),
        state: Field::new(32, 4),
        flags: Field::new(36, 4),
        force: FixedPoint::new(40, 32, 100, Quantity::Force),
        displacement: FixedPoint::new(72, 32, 100_000_000, Quantity::Displacement),
        time: Some(Field::new(104, 24)),
    };

    /// The layout of a profile.
    pub const fn of(profile: Profile) -> &'static Self {
        match profile {
            Profile::Classical => &Self::CLASSICAL,
            Profile::Fd => &Self::FD,
        }
    }
}

impl Measurement {
    /// The frame, and what had to be saturated to fit it; the frame then carries
    /// [`MeasurementFlags::SATURATED`], so that the peer knows too.
    pub fn encode(&self, profile: Profile) -> (Frame, Saturated) {
        self.encode_as(profile, None)
    }

    /// The frame of an armed session. Its counter is that of the seal's cycle; the `counter` here
    /// is not used.
    pub fn encode_sealed(&self, profile: Profile, seal: Seal) -> (Frame, Saturated) {
        Self { counter: seal.counter(profile), ..*self }.encode_as(profile, Some(seal))
    }

    fn encode_as(&self, profile: Profile, seal: Option<Seal>) -> (Frame, Saturated) {
        let layout = MeasurementLayout::of(profile);
        let mut word = Word::default();
        let mut saturated = Saturated::empty();
        saturated.set(
            Saturated::COUNTER,
            word.put_counter(layout.counter, Some(self.counter))
                | word.put_counter(layout.echo, self.echo),
        );
        word.put(layout.state, u32::from(self.state.code()));
        saturated.set(Saturated::FORCE, word.put_fixed(layout.force, self.force_n));
        saturated
            .set(Saturated::DISPLACEMENT, word.put_fixed(layout.displacement, self.displacement_m));
        let mut flags = self.flags;
        if saturated.intersects(Saturated::FORCE | Saturated::DISPLACEMENT) {
            flags |= MeasurementFlags::SATURATED;
        }
        word.put(layout.flags, u32::from(flags.bits()));
        if let Some(time) = layout.time {
            word.put_time(time, self.time_us);
        }
        (protection::protect(MessageId::Measurement(profile, self.node), word, seal), saturated)
    }

    /// The measurement in a frame.
    ///
    /// # Errors
    /// Not a measurement's id, a wrong length or CRC, an invalid counter, a reserved state.
    pub fn decode(id: u16, data: &[u8]) -> Result<Self, Error> {
        Self::decode_as(id, data, None)
    }

    /// The measurement in a frame of an armed session.
    ///
    /// # Errors
    /// As `decode`; the CRC is that of this seal, and a counter other than the seal's is wrong.
    pub fn decode_sealed(id: u16, data: &[u8], seal: Seal) -> Result<Self, Error> {
        Self::decode_as(id, data, Some(seal))
    }

    fn decode_as(id: u16, data: &[u8], seal: Option<Seal>) -> Result<Self, Error> {
        let Some(message @ MessageId::Measurement(profile, node)) = MessageId::from_raw(id) else {
            return Err(Error::UnknownId { id });
        };
        let layout = MeasurementLayout::of(profile);
        let word = protection::open(message, data, seal)?;
        let counter = word.counter(message, layout.counter)?;
        if let Some(expected) = seal.map(|seal| seal.counter(profile))
            && counter != expected
        {
            return Err(Error::Counter { id, found: counter, expected });
        }
        Ok(Self {
            node,
            counter,
            state: word.code(message, layout.state)?,
            flags: MeasurementFlags::from_bits_truncate(word.get(layout.flags) as u8),
            echo: word.get_counter(layout.echo),
            force_n: word.get_fixed(layout.force),
            displacement_m: word.get_fixed(layout.displacement),
            time_us: layout.time.and_then(|time| word.get_time(time)),
        })
    }
}

impl fmt::Display for Measurement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { node, counter, state, .. } = self;
        write!(f, "measurement {node} #{counter} {state}")?;
        write_value(f, " force", self.force_n, 1.0, "N", 1)?;
        write_value(f, " displacement", self.displacement_m, 1e3, "mm", 4)?;
        write_echo(f, self.echo)?;
        write_time(f, self.time_us)?;
        self.flags.iter_names().try_for_each(|(name, _)| write!(f, " {name}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLASSICAL: [u8; 8] = [0x03, 0x42, 0x71, 0xA0, 0xBE, 0x38, 0x04, 0xA3];
    const FD: [u8; 16] = [
        0x5F, 0x10, 0x07, 0xFF, 0x42, 0x00, 0x00, 0x00, 0x80, 0x10, 0xB6, 0xFD, 0xFF, 0x56, 0x34,
        0x12,
    ];

    fn classical() -> Measurement {
        Measurement {
            node: Node::ALL[0],
            counter: 2,
            state: RunState::Run,
            flags: MeasurementFlags::LIMIT_REACHED | MeasurementFlags::ACTUATOR_LAGGING,
            echo: Some(3),
            force_n: Some(-17_999.8),
            displacement_m: Some(3.4582e-3),
            time_us: None,
        }
    }

    fn fd() -> Measurement {
        Measurement {
            node: Node::ALL[3],
            counter: 7,
            state: RunState::Armed,
            flags: MeasurementFlags::SENSOR_INVALID,
            echo: None,
            force_n: None,
            displacement_m: Some(-1.5e-3),
            time_us: Some(0x0012_3456),
        }
    }

    #[test]
    fn deconstruct() {
        let (word, layout) = (Word::from_bytes(&CLASSICAL), MeasurementLayout::CLASSICAL);
        assert_eq!(word.get(layout.counter), 2);
        assert_eq!(word.get(layout.state), 4);
        assert_eq!(word.get(layout.force.field()), 0xE_A071); // -89 999 in 20 bits
        assert_eq!(word.get(layout.displacement.field()), 17_291);
        assert_eq!(word.get(layout.echo), 3);
        assert_eq!(word.get(layout.flags), 0b1010);
        let (word, layout) = (Word::from_bytes(&FD), MeasurementLayout::FD);
        assert_eq!(word.get(layout.counter), 7);
        assert_eq!(word.get(layout.echo), 255);
        assert_eq!(word.get(layout.state), 2);
        assert_eq!(word.get(layout.flags), 0b0100);
        assert_eq!(word.get(layout.force.field()), 0x8000_0000);
        assert_eq!(word.get(layout.displacement.field()) as i32, -150_000);
        assert_eq!(word.get(Field::new(104, 24)), 0x0012_3456);
    }

    #[test]
    fn construct() {
        let layout = MeasurementLayout::CLASSICAL;
        let mut word = Word::default();
        word.put(Field::new(0, 8), 0x03);
        word.put(layout.counter, 2);
        word.put(layout.state, 4);
        word.put(layout.force.field(), -89_999_i32 as u32);
        word.put(layout.displacement.field(), 17_291);
        word.put(layout.echo, 3);
        word.put(layout.flags, 0b1010);
        assert_eq!(word, Word::from_bytes(&CLASSICAL));
    }

    #[test]
    fn parse() {
        assert_eq!(Measurement::decode(0x201, &CLASSICAL), Ok(classical()));
        assert_eq!(Measurement::decode(0x214, &FD), Ok(fd()));
    }

    #[test]
    fn emit() {
        for (measurement, profile, id, bytes) in [
            (classical(), Profile::Classical, 0x201, &CLASSICAL[..]),
            (fd(), Profile::Fd, 0x214, &FD[..]),
        ] {
            let (frame, saturated) = measurement.encode(profile);
            assert_eq!((frame.id(), frame.data()), (id, bytes));
            assert_eq!(frame.is_fd(), profile == Profile::Fd);
            assert!(saturated.is_empty());
        }
    }

    #[test]
    fn saturation_travels_in_the_flags() {
        let (frame, saturated) =
            Measurement { force_n: Some(200e3), ..classical() }.encode(Profile::Classical);
        assert_eq!(saturated, Saturated::FORCE);
        let read = Measurement::decode(frame.id(), frame.data()).unwrap();
        assert_eq!(read.force_n, Some(104_857.4));
        assert_eq!(read.flags, classical().flags | MeasurementFlags::SATURATED);
    }
}
