//! The locomotive asks: which track this is, or for its next samples.
use crate::signal::{Field, Word};
use crate::{Error, Frame, MessageId, protection};
use core::fmt;

/// What a locomotive asks its track server for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrackRequest {
    /// Number that the locomotive has drawn for this session.
    pub session: u16,
    /// Number of the first sample that it lacks.
    pub first: u32,
    /// How many from there on it has room for; with 0 it asks which track this is.
    pub count: u8,
}

impl TrackRequest {
    /// Samples wanted.
    pub const COUNT: Field = Field::new(8, 8);
    /// Number of the session.
    pub const SESSION: Field = Field::new(16, 16);
    /// First sample wanted.
    pub const FIRST: Field = Field::new(32, 32);

    /// The frame.
    pub fn encode(&self) -> Frame {
        let mut word = Word::default();
        word.put(Self::COUNT, u32::from(self.count));
        word.put(Self::SESSION, u32::from(self.session));
        word.put(Self::FIRST, self.first);
        protection::protect(MessageId::TrackRequest, word, None)
    }

    /// The request in a frame.
    ///
    /// # Errors
    /// Not a request's id, a wrong length or CRC.
    pub fn decode(id: u16, data: &[u8]) -> Result<Self, Error> {
        let Some(message @ MessageId::TrackRequest) = MessageId::from_raw(id) else {
            return Err(Error::UnknownId { id });
        };
        let word = protection::open(message, data, None)?;
        Ok(Self {
            count: word.get(Self::COUNT) as u8,
            session: word.get(Self::SESSION) as u16,
            first: word.get(Self::FIRST),
        })
    }
}

impl fmt::Display for TrackRequest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { session, first, count } = self;
        match count {
            0 => write!(f, "track request {session:04x}: which track"),
            _ => write!(f, "track request {session:04x}: {count} samples from {first}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_comes_back() {
        let request = TrackRequest { session: 0xBEEF, first: 38_000_000, count: 255 };
        let frame = request.encode();
        assert_eq!(TrackRequest::decode(frame.id(), frame.data()), Ok(request));
    }
}
