//! The track server says which track it has, property by property.
use super::TrackRequest;
use crate::signal::{Field, Word};
use crate::wire_enum::wire_enum;
use crate::{Error, Frame, MessageId, protection};
use core::fmt;

wire_enum! {
    /// One property of a track, as the 8-bit code on the wire. Codes 5 to 255 are reserved.
    TrackItem in "item" {
        /// Distance of the first sample, µm, two's complement.
        First = 0, "FIRST_UM";
        /// Distance between samples, µm.
        Step = 1, "STEP_UM";
        /// Samples of the track, one way.
        Samples = 2, "SAMPLES";
        /// 1: from one end to the other. 2: there and back and there again, without an end.
        Ways = 3, "WAYS";
        /// CRC-32 over beginning, step, ways and samples, [as defined](crate::TrackFingerprint).
        Fingerprint = 4, "FINGERPRINT";
    }
}

/// One property of the track that a server has, in answer to a request of 0 samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrackOffer {
    /// The session of the request.
    pub session: u16,
    /// Which property.
    pub item: TrackItem,
    /// Its value.
    pub value: u32,
}

impl TrackOffer {
    /// Which property.
    pub const ITEM: Field = TrackRequest::COUNT;
    /// Number of the session.
    pub const SESSION: Field = TrackRequest::SESSION;
    /// Value of the property.
    pub const VALUE: Field = TrackRequest::FIRST;

    /// The frame.
    pub fn encode(&self) -> Frame {
        let mut word = Word::default();
        word.put(Self::ITEM, u32::from(self.item.code()));
        word.put(Self::SESSION, u32::from(self.session));
        word.put(Self::VALUE, self.value);
        protection::protect(MessageId::TrackOffer, word, None)
    }

    /// The offer in a frame.
    ///
    /// # Errors
    /// Not an offer's id, a wrong length or CRC, a reserved item.
    pub fn decode(id: u16, data: &[u8]) -> Result<Self, Error> {
        let Some(message @ MessageId::TrackOffer) = MessageId::from_raw(id) else {
            return Err(Error::UnknownId { id });
        };
        let word = protection::open(message, data, None)?;
        Ok(Self {
            item: word.code(message, Self::ITEM)?,
            session: word.get(Self::SESSION) as u16,
            value: word.get(Self::VALUE),
        })
    }
}

impl fmt::Display for TrackOffer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { session, item, value } = self;
        write!(f, "track offer {session:04x}: {item} {value:#x}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offer_comes_back() {
        let offer = TrackOffer { session: 0xBEEF, item: TrackItem::Step, value: 100_000 };
        let frame = offer.encode();
        assert_eq!(TrackOffer::decode(frame.id(), frame.data()), Ok(offer));
    }
}
