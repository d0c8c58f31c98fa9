//! A sample of the track, in two halves of two channels each.
use super::part::TrackPart;
use super::seal::TrackSeal;
use crate::command::write_value;
use crate::signal::{Field, FixedPoint, Quantity, Saturated, Word};
use crate::{Error, Frame, MessageId, protection};
use core::fmt;

/// Half a sample of the track's irregularity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackSample {
    /// Which half.
    pub part: TrackPart,
    /// Number of the sample in the whole track, modulo 256.
    pub number: u8,
    /// Its two channels in the order of [`TrackPart`], m, to 10 nm.
    pub channels_m: [Option<f64>; 2],
}

impl TrackSample {
    /// Number of the sample, modulo 256.
    pub const NUMBER: Field = Field::new(8, 8);
    /// The two channels.
    pub const CHANNELS: [FixedPoint; 2] = [
        FixedPoint::new(16, 24, 100_000_000, Quantity::Displacement),
        FixedPoint::new(40, 24, 100_000_000, Quantity::Displacement),
    ];

    /// The plain frame, and what had to be saturated to fit it.
    pub fn encode(&self) -> (Frame, Saturated) {
        self.frame(0)
    }

    /// The frame sealed as that of a sample of the whole track, and what had to be saturated to fit
    /// it.
    pub fn encode_sealed(&self, seal: TrackSeal, sample: u32) -> (Frame, Saturated) {
        self.frame(seal.mask(sample))
    }

    fn frame(&self, mask: u16) -> (Frame, Saturated) {
        let mut word = Word::default();
        word.put(Self::NUMBER, u32::from(self.number));
        let mut is_saturated = false;
        for (signal, value_m) in Self::CHANNELS.into_iter().zip(self.channels_m) {
            is_saturated |= word.put_fixed(signal, value_m);
        }
        let mut saturated = Saturated::empty();
        saturated.set(Saturated::TRACK, is_saturated);
        (protection::protect_masked(MessageId::TrackSample(self.part), word, mask), saturated)
    }

    /// The half sample in a plain frame.
    ///
    /// # Errors
    /// Not a sample's id, a wrong length or CRC.
    pub fn decode(id: u16, data: &[u8]) -> Result<Self, Error> {
        Self::read(id, data, 0)
    }

    /// The half sample in a sealed frame.
    ///
    /// # Errors
    /// Not a sample's id, a wrong length, or a CRC that is not that of the seal.
    pub fn decode_sealed(
        id: u16,
        data: &[u8],
        seal: TrackSeal,
        sample: u32,
    ) -> Result<Self, Error> {
        Self::read(id, data, seal.mask(sample))
    }

    fn read(id: u16, data: &[u8], mask: u16) -> Result<Self, Error> {
        let Some(message @ MessageId::TrackSample(part)) = MessageId::from_raw(id) else {
            return Err(Error::UnknownId { id });
        };
        let word = protection::open_masked(message, data, mask)?;
        Ok(Self {
            part,
            number: word.get(Self::NUMBER) as u8,
            channels_m: Self::CHANNELS.map(|signal| word.get_fixed(signal)),
        })
    }

    /// A channel as it travels (m): the nearest multiple of 10 nm within ±83.9 mm. None where it
    /// does not fit.
    ///
    /// ```
    /// use can_protocol::TrackSample;
    /// assert_eq!(TrackSample::rounded(1.234_567_89e-3), Some(1.234_57e-3));
    /// assert_eq!(TrackSample::rounded(0.1), None);
    /// ```
    pub fn rounded(value_m: f64) -> Option<f64> {
        let [signal, _] = Self::CHANNELS;
        match signal.code(Some(value_m)) {
            (code, false) => signal.value(code),
            (_, true) => None,
        }
    }
}

impl fmt::Display for TrackSample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = match self.part {
            TrackPart::CentreLine => [" vertical", " alignment"],
            TrackPart::Rails => [" cross level", " gauge"],
        };
        write!(f, "track sample {}", self.number)?;
        for (name, value_m) in names.into_iter().zip(self.channels_m) {
            write_value(f, name, value_m, 1e3, "mm", 5)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLE: TrackSample = TrackSample {
        part: TrackPart::Rails,
        number: 232,
        channels_m: [Some(-1.5e-3), Some(2.000_01e-3)],
    };

    #[test]
    fn deconstruct() {
        let (frame, saturated) = SAMPLE.encode();
        assert!(saturated.is_empty());
        let word = Word::from_bytes(frame.data());
        let [first, second] = TrackSample::CHANNELS.map(FixedPoint::field);
        assert_eq!(word.get(TrackSample::NUMBER), 232);
        assert_eq!(word.get(first), (1 << 24) - 150_000);
        assert_eq!(word.get(second), 200_001);
    }

    #[test]
    fn a_sample_opens_in_its_place_and_no_other() {
        let seal = TrackSeal::new(7, 0xF00D);
        let (frame, _) = SAMPLE.encode_sealed(seal, 1000);
        let read =
            |seal, sample| TrackSample::decode_sealed(frame.id(), frame.data(), seal, sample);
        assert_eq!(read(seal, 1000), Ok(SAMPLE));
        // A whole window behind: the number is the same, the mask is not.
        assert!(read(seal, 1000 - 256).is_err());
        assert!(read(TrackSeal::new(8, 0xF00D), 1000).is_err(), "another session");
        assert!(read(TrackSeal::new(7, 0xF00E), 1000).is_err(), "another track");
        assert!(TrackSample::decode(frame.id(), frame.data()).is_err(), "not plain");
    }

    #[test]
    fn what_does_not_fit_is_reported() {
        let wide = TrackSample { channels_m: [Some(0.1), None], ..SAMPLE };
        assert_eq!(wide.encode().1, Saturated::TRACK);
        let none = TrackSample { channels_m: [None, None], ..SAMPLE };
        let (frame, saturated) = none.encode();
        assert!(saturated.is_empty());
        assert_eq!(TrackSample::decode(frame.id(), frame.data()), Ok(none));
    }
}
