//! The command: where the host wants the damper's eyes to be, once per cycle.
use crate::signal::{Field, FixedPoint, Quantity, Saturated, Word};
use crate::wire_enum::wire_enum;
use crate::{Error, Frame, MessageId, Node, Profile, RunState, Seal, protection};
use core::fmt;

/// A command from the host to one rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// The rig.
    pub node: Node,
    /// Sequence number, 0 up to [`Profile::counter_modulus`], exclusive.
    pub counter: u8,
    /// The host's run state.
    pub state: RunState,
    /// What the rig shall do with the values.
    pub mode: Mode,
    /// Counter of the last [`Measurement`](crate::Measurement) the host accepted.
    pub echo: Option<u8>,
    /// Damper displacement to reach, extension positive, m. `None`: no value, hold.
    pub displacement_m: Option<f64>,
    /// Its rate, m/s.
    pub velocity_m_per_s: Option<f64>,
    /// The host's clock, µs, modulo 2^32. FD only; the classical frame has no room.
    pub time_us: Option<u32>,
}

wire_enum! {
    /// What the rig does with a command, as the 4-bit code on the wire. Codes 4 to 15 are reserved.
    Mode in "mode" {
        /// Hold the present position; the values are not used.
        Hold = 0, "HOLD";
        /// Follow the displacement.
        Follow = 1, "FOLLOW";
        /// Follow the displacement, with the velocity as feed-forward.
        FollowWithVelocity = 2, "FOLLOW_WITH_VELOCITY";
        /// Go to mid-stroke at the rig's own slow rate; the values are not used.
        Centre = 3, "CENTRE";
    }
}

/// Where the fields of a command sit behind its CRC.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommandLayout {
    /// Sequence number.
    pub counter: Field,
    /// Run state.
    pub state: Field,
    /// Mode.
    pub mode: Field,
    /// Counter last accepted from the rig.
    pub echo: Field,
    /// Displacement.
    pub displacement: FixedPoint,
    /// Velocity.
    pub velocity: FixedPoint,
    /// Time in µs.
    pub time: Option<Field>,
}

impl CommandLayout {
    /// 8 bytes: CRC8 | counter 4, state 4 | displacement i24 | velocity i16 | echo 4, mode 4.
    pub const CLASSICAL: Self = Self {
        counter: Field::new(8, 4),
        state: Field::new(12, 4),
        displacement: FixedPoint::new(16, 24, 10_000_000, Quantity::Displacement),
        velocity: FixedPoint::new(40, 16, 100_000, Quantity::Velocity),
        echo: Field::new(56, 4),
        mode: Field::new(60, 4),
        time: None,
    };

    /// 16 bytes: CRC16 | counter 8 | echo 8 | state 4, mode 4 | displacement i32 | velocity i24 |
    /// time u32.
    pub const FD: Self = Self {
        counter: Field::new(16, 8),
        echo: Field::new(24, 8),
        state: Field::new(32, 4),
        mode: Field::new(36, 4),
        displacement: FixedPoint::new(40, 32, 100_000_000, Quantity::Displacement),
        velocity: FixedPoint::new(72, 24, 1_000_000, Quantity::Velocity),
        time: Some(Field::new(96, 32)),
    };

    /// The layout of a profile.
    pub const fn of(profile: Profile) -> &'static Self {
        match profile {
            Profile::Classical => &Self::CLASSICAL,
            Profile::Fd => &Self::FD,
        }
    }
}

impl Command {
    /// The frame, and what had to be saturated to fit it.
    pub fn encode(&self, profile: Profile) -> (Frame, Saturated) {
        self.encode_as(profile, None)
    }

    /// The frame of an armed session. Its counter is that of the seal's cycle; the `counter` here
    /// is not used.
    pub fn encode_sealed(&self, profile: Profile, seal: Seal) -> (Frame, Saturated) {
        Self { counter: seal.counter(profile), ..*self }.encode_as(profile, Some(seal))
    }

    fn encode_as(&self, profile: Profile, seal: Option<Seal>) -> (Frame, Saturated) {
        let layout = CommandLayout::of(profile);
        let mut word = Word::default();
        let mut saturated = Saturated::empty();
        saturated.set(
            Saturated::COUNTER,
            word.put_counter(layout.counter, Some(self.counter))
                | word.put_counter(layout.echo, self.echo),
        );
        word.put(layout.state, u32::from(self.state.code()));
        word.put(layout.mode, u32::from(self.mode.code()));
        saturated
            .set(Saturated::DISPLACEMENT, word.put_fixed(layout.displacement, self.displacement_m));
        saturated.set(Saturated::VELOCITY, word.put_fixed(layout.velocity, self.velocity_m_per_s));
        if let Some(time) = layout.time {
            word.put_time(time, self.time_us);
        }
        (protection::protect(MessageId::Command(profile, self.node), word, seal), saturated)
    }

    /// The command in a frame.
    ///
    /// # Errors
    /// Not a command's id, a wrong length or CRC, an invalid counter, a reserved state or mode.
    pub fn decode(id: u16, data: &[u8]) -> Result<Self, Error> {
        Self::decode_as(id, data, None)
    }

    /// The command in a frame of an armed session.
    ///
    /// # Errors
    /// As `decode`; the CRC is that of this seal, and a counter other than the seal's is wrong.
    pub fn decode_sealed(id: u16, data: &[u8], seal: Seal) -> Result<Self, Error> {
        Self::decode_as(id, data, Some(seal))
    }

    fn decode_as(id: u16, data: &[u8], seal: Option<Seal>) -> Result<Self, Error> {
        let Some(message @ MessageId::Command(profile, node)) = MessageId::from_raw(id) else {
            return Err(Error::UnknownId { id });
        };
        let layout = CommandLayout::of(profile);
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
            mode: word.code(message, layout.mode)?,
            echo: word.get_counter(layout.echo),
            displacement_m: word.get_fixed(layout.displacement),
            velocity_m_per_s: word.get_fixed(layout.velocity),
            time_us: layout.time.and_then(|time| word.get_time(time)),
        })
    }
}

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { node, counter, state, mode, .. } = self;
        write!(f, "command {node} #{counter} {state} {}", mode.name())?;
        write_value(f, " displacement", self.displacement_m, 1e3, "mm", 4)?;
        write_value(f, " velocity", self.velocity_m_per_s, 1e3, "mm/s", 2)?;
        write_echo(f, self.echo)?;
        write_time(f, self.time_us)
    }
}

/// One value of a `Display` line: `displacement +3.4600 mm`, or `displacement invalid`.
pub(crate) fn write_value(
    f: &mut fmt::Formatter<'_>,
    name: &str,
    value: Option<f64>,
    scale: f64,
    unit: &str,
    decimals: usize,
) -> fmt::Result {
    match value {
        Some(value) => write!(f, "{name} {:+.decimals$} {unit}", value * scale),
        None => write!(f, "{name} invalid"),
    }
}

/// The time in a `Display` line, when there is one.
pub(crate) fn write_time(f: &mut fmt::Formatter<'_>, time_us: Option<u32>) -> fmt::Result {
    time_us.map_or(Ok(()), |time_us| write!(f, " time {time_us} us"))
}

/// The echo in a `Display` line: `echo 7`, or `echo none`.
pub(crate) fn write_echo(f: &mut fmt::Formatter<'_>, echo: Option<u8>) -> fmt::Result {
    match echo {
        Some(echo) => write!(f, " echo {echo}"),
        None => f.write_str(" echo none"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLASSICAL: [u8; 8] = [0x18, 0x43, 0x28, 0x87, 0x00, 0x50, 0xE2, 0x22];
    const FD: [u8; 16] = [
        0x7F, 0x1E, 0xC8, 0xC7, 0x24, 0x90, 0x47, 0x05, 0x00, 0x20, 0xD7, 0xFE, 0xD2, 0x02, 0x96,
        0x49,
    ];

    fn classical() -> Command {
        Command {
            node: Node::ALL[0],
            counter: 3,
            state: RunState::Run,
            mode: Mode::FollowWithVelocity,
            echo: Some(2),
            displacement_m: Some(3.46e-3),
            velocity_m_per_s: Some(-0.076),
            time_us: None,
        }
    }

    fn fd() -> Command {
        Command {
            node: Node::ALL[3],
            counter: 200,
            echo: Some(199),
            time_us: Some(1_234_567_890),
            ..classical()
        }
    }

    #[test]
    fn deconstruct() {
        for (bytes, layout, codes) in [
            (&CLASSICAL[..], CommandLayout::CLASSICAL, [3, 2, 34_600, 0xE250]),
            (&FD[..], CommandLayout::FD, [200, 199, 346_000, 0xFE_D720]),
        ] {
            let word = Word::from_bytes(bytes);
            let [counter, echo, displacement, velocity] = codes;
            assert_eq!(word.get(layout.counter), counter);
            assert_eq!(word.get(layout.echo), echo);
            assert_eq!(word.get(layout.state), 4);
            assert_eq!(word.get(layout.mode), 2);
            assert_eq!(word.get(layout.displacement.field()), displacement);
            assert_eq!(word.get(layout.velocity.field()), velocity);
        }
        assert_eq!(Word::from_bytes(&FD).get(Field::new(96, 32)), 1_234_567_890);
    }

    #[test]
    fn construct() {
        let layout = CommandLayout::CLASSICAL;
        let mut word = Word::default();
        word.put(Field::new(0, 8), 0x18);
        word.put(layout.counter, 3);
        word.put(layout.state, 4);
        word.put(layout.displacement.field(), 34_600);
        word.put(layout.velocity.field(), 0xE250);
        word.put(layout.echo, 2);
        word.put(layout.mode, 2);
        assert_eq!(word, Word::from_bytes(&CLASSICAL));
    }

    #[test]
    fn parse() {
        assert_eq!(Command::decode(0x101, &CLASSICAL), Ok(classical()));
        assert_eq!(Command::decode(0x114, &FD), Ok(fd()));
    }

    #[test]
    fn emit() {
        for (command, profile, id, bytes) in [
            (classical(), Profile::Classical, 0x101, &CLASSICAL[..]),
            (fd(), Profile::Fd, 0x114, &FD[..]),
        ] {
            let (frame, saturated) = command.encode(profile);
            assert_eq!((frame.id(), frame.data()), (id, bytes));
            assert_eq!(frame.is_fd(), profile == Profile::Fd);
            assert!(saturated.is_empty());
        }
    }

    #[test]
    fn saturation_names_the_signal() {
        let command = Command { displacement_m: Some(1.0), ..classical() };
        let (frame, saturated) = command.encode(Profile::Classical);
        assert_eq!(saturated, Saturated::DISPLACEMENT);
        let read = Command::decode(frame.id(), frame.data()).unwrap();
        assert_eq!(read.displacement_m, Some(0.838_860_7));
        let command = Command { velocity_m_per_s: Some(f64::NAN), ..classical() };
        let (frame, saturated) = command.encode(Profile::Fd);
        assert_eq!(saturated, Saturated::VELOCITY);
        let read = Command::decode(frame.id(), frame.data()).unwrap();
        assert_eq!(read.velocity_m_per_s, None);
    }

    #[test]
    fn a_counter_beyond_the_profile_is_sent_as_invalid_and_refused() {
        let (frame, saturated) = Command { counter: 15, ..classical() }.encode(Profile::Classical);
        assert_eq!(saturated, Saturated::COUNTER);
        assert_eq!(
            Command::decode(frame.id(), frame.data()),
            Err(Error::ReservedCode { id: 0x101, field: "counter", code: 15 })
        );
    }
}
