//! The sync: how long a cycle is, who waits for whom, and what time the host has.
//!
//! A cycle has two lengths: `period_us` in the model, and that times `slow_down` in real time. A
//! real rig cannot slow down its oil: it must refuse a sync whose `slow_down` is not 1 or whose
//! pace is lock-step. An emulated rig advances `period_us` per cycle in any case.
use crate::signal::{Field, Word};
use crate::wire_enum::wire_enum;
use crate::{Error, Frame, MessageId, Profile, protection};
use core::fmt;
use core::num::{NonZeroU8, NonZeroU16};

/// Version of the frames described by this crate. Peers of different versions must not arm.
pub const PROTOCOL_VERSION: u8 = 2;

/// The host's announcement to all rigs, 10 times a second. It has no counter: its time advances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sync {
    /// Version of the sender's protocol, 0 to 15; [`PROTOCOL_VERSION`] is ours.
    pub version: u8,
    /// The profile that the host sends commands in and expects measurements in.
    pub profile: Profile,
    /// Who waits for whom.
    pub pace: Pace,
    /// Length of a cycle in the model, µs.
    pub period_us: NonZeroU16,
    /// How many times longer a cycle takes in real time; 1 for a run in real time.
    pub slow_down: NonZeroU8,
    /// The host's clock, µs; the low 24 bits travel (16.8 s).
    pub time_us: u32,
}

wire_enum! {
    /// Who waits for whom.
    Pace in "pace" {
        /// The clock rules: a command every period, a rig that hears nothing for 5 goes safe.
        Clock = 0, "CLOCK";
        /// The echo rules: the next command comes when every rig has echoed the last one, and a rig
        /// advances one cycle per new command.
        LockStep = 1, "LOCK_STEP";
    }
}

impl Sync {
    /// Version, 4 bits, the same place in every version.
    pub const VERSION: Field = Field::new(8, 4);
    /// Profile, 2 bits: 0 classical, 1 FD.
    pub const PROFILE: Field = Field::new(12, 2);
    /// Pace, 2 bits.
    pub const PACE: Field = Field::new(14, 2);
    /// Model period in µs.
    pub const PERIOD: Field = Field::new(16, 16);
    /// Real time over model time.
    pub const SLOW_DOWN: Field = Field::new(32, 8);
    /// Time in µs.
    pub const TIME: Field = Field::new(40, 24);

    /// The frame.
    pub fn encode(&self) -> Frame {
        let mut word = Word::default();
        word.put(Self::VERSION, u32::from(self.version).min(Self::VERSION.ones()));
        word.put(Self::PROFILE, u32::from(self.profile == Profile::Fd));
        word.put(Self::PACE, u32::from(self.pace.code()));
        word.put(Self::PERIOD, u32::from(self.period_us.get()));
        word.put(Self::SLOW_DOWN, u32::from(self.slow_down.get()));
        word.put(Self::TIME, self.time_us);
        protection::protect(MessageId::Sync, word, None)
    }

    /// The sync in a frame. A foreign version is not an error here: compare it.
    ///
    /// # Errors
    /// Not the sync's id, a wrong length or CRC, a reserved profile or pace, a period or slow-down
    /// of zero.
    pub fn decode(id: u16, data: &[u8]) -> Result<Self, Error> {
        let Some(MessageId::Sync) = MessageId::from_raw(id) else {
            return Err(Error::UnknownId { id });
        };
        let word = protection::open(MessageId::Sync, data, None)?;
        let reserved = |field, code| Error::ReservedCode { id, field, code };
        Ok(Self {
            version: word.get(Self::VERSION) as u8,
            profile: match word.get(Self::PROFILE) {
                0 => Profile::Classical,
                1 => Profile::Fd,
                code => return Err(reserved("profile", code)),
            },
            pace: word.code(MessageId::Sync, Self::PACE)?,
            period_us: NonZeroU16::new(word.get(Self::PERIOD) as u16)
                .ok_or(reserved("period", 0))?,
            slow_down: NonZeroU8::new(word.get(Self::SLOW_DOWN) as u8)
                .ok_or(reserved("slow_down", 0))?,
            time_us: word.get(Self::TIME),
        })
    }
}

impl fmt::Display for Sync {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { version, profile, pace, period_us, slow_down, time_us } = self;
        write!(
            f,
            "sync v{version} {profile:?} {} period {period_us} us x{slow_down} time {time_us} us",
            pace.name()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BYTES: [u8; 8] = [0x32, 0x12, 0xF4, 0x01, 0x01, 0x40, 0x42, 0x0F];

    fn sync() -> Sync {
        Sync {
            version: PROTOCOL_VERSION,
            profile: Profile::Fd,
            pace: Pace::Clock,
            period_us: NonZeroU16::new(500).unwrap(),
            slow_down: NonZeroU8::MIN,
            time_us: 1_000_000,
        }
    }

    #[test]
    fn deconstruct() {
        let word = Word::from_bytes(&BYTES);
        let fields =
            [Sync::VERSION, Sync::PROFILE, Sync::PACE, Sync::PERIOD, Sync::SLOW_DOWN, Sync::TIME];
        assert_eq!(fields.map(|field| word.get(field)), [2, 1, 0, 500, 1, 1_000_000]);
    }

    #[test]
    fn construct() {
        let mut word = Word::default();
        word.put(Field::new(0, 8), 0x32);
        word.put(Sync::VERSION, 2);
        word.put(Sync::PROFILE, 1);
        word.put(Sync::PERIOD, 500);
        word.put(Sync::SLOW_DOWN, 1);
        word.put(Sync::TIME, 1_000_000);
        assert_eq!(word, Word::from_bytes(&BYTES));
    }

    #[test]
    fn parse() {
        assert_eq!(Sync::decode(0x080, &BYTES), Ok(sync()));
    }

    #[test]
    fn emit() {
        let frame = sync().encode();
        assert_eq!((frame.id(), frame.data(), frame.is_fd()), (0x080, &BYTES[..], false));
    }

    #[test]
    fn a_period_or_slow_down_of_zero_is_refused() {
        for field in [Sync::PERIOD, Sync::SLOW_DOWN] {
            let mut word = Word::default();
            for other in [Sync::PERIOD, Sync::SLOW_DOWN].into_iter().filter(|f| *f != field) {
                word.put(other, 1);
            }
            let frame = protection::protect(MessageId::Sync, word, None);
            let decoded = Sync::decode(0x080, frame.data());
            assert!(matches!(decoded, Err(Error::ReservedCode { code: 0, .. })), "{decoded:?}");
        }
    }
}
