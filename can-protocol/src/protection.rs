//! End-to-end protection: a CRC over what is sent and over who should have sent it.
//!
//! In front of the payload go two bytes that never travel, the `DataID` (`0x5000 + id`, high byte
//! first); then come all payload bytes behind the CRC. A frame under a wrong id therefore fails.
//!
//! | frames | CRC | polynomial | start | final xor | check of `123456789` |
//! | --- | --- | --- | --- | --- | --- |
//! | 6 and 8 bytes | CRC-8 SAE J1850, byte 0 | 0x1D | 0xFF | 0xFF | 0x4B |
//! | 16 bytes | CRC-16/CCITT-FALSE, bytes 0 and 1, low byte first | 0x1021 | 0xFFFF | 0 | 0x29B1 |
//!
//! Neither is reflected. The heartbeat, one byte, has none.
//!
//! The method is that of AUTOSAR's end-to-end profiles 1 and 5 (counter, `DataID` in the CRC,
//! receiver status); the frames are not bit-compatible with them.
use crate::signal::{Field, Word};
use crate::{Error, Frame, MessageId};
use crc::{CRC_8_SAE_J1850, CRC_16_IBM_3740, Crc};

const CRC8: Crc<u8> = Crc::<u8>::new(&CRC_8_SAE_J1850);
/// The catalogue's name for CRC-16/CCITT-FALSE.
const CRC16: Crc<u16> = Crc::<u16>::new(&CRC_16_IBM_3740);

/// The CRC field of a message, `None` for the heartbeat.
pub const fn crc_field(message: MessageId) -> Option<Field> {
    match message.payload_len() {
        1 => None,
        16 => Some(Field::new(0, 16)),
        _ => Some(Field::new(0, 8)),
    }
}

/// The CRC of a payload, read from behind its CRC bytes; 0 for a message without one.
///
/// ```
/// use can_protocol::{MessageId, Node, Profile, protection::checksum};
/// let message = MessageId::Command(Profile::Classical, Node::new(1)?);
/// let payload = [0x18, 0x43, 0x28, 0x87, 0x00, 0x50, 0xE2, 0x22];
/// assert_eq!(checksum(message, &payload), 0x18);
/// # Ok::<(), can_protocol::Error>(())
/// ```
pub fn checksum(message: MessageId, payload: &[u8]) -> u16 {
    debug_assert!(payload.len() == message.payload_len(), "{message:?} in {} bytes", payload.len());
    let data_id = message.data_id().to_be_bytes();
    match (message.payload_len(), payload) {
        (1, _) | (_, []) => 0,
        (16, [_, _, protected @ ..]) => {
            let mut digest = CRC16.digest();
            digest.update(&data_id);
            digest.update(protected);
            digest.finalize()
        }
        (_, [_, protected @ ..]) => {
            let mut digest = CRC8.digest();
            digest.update(&data_id);
            digest.update(protected);
            u16::from(digest.finalize())
        }
    }
}

/// The frame of a message whose fields are set: with its CRC.
pub(crate) fn seal(message: MessageId, mut word: Word) -> Frame {
    if let Some(field) = crc_field(message) {
        let bytes = word.to_bytes();
        debug_assert!(message.payload_len() <= bytes.len(), "{message:?} is longer than 16 bytes");
        let payload = bytes.get(..message.payload_len()).unwrap_or(&bytes);
        word.put(field, u32::from(checksum(message, payload)));
    }
    Frame::new(message, word.to_bytes())
}

/// The fields of a payload whose length and CRC are right.
pub(crate) fn open(message: MessageId, payload: &[u8]) -> Result<Word, Error> {
    let (id, expected) = (message.raw(), message.payload_len());
    if payload.len() != expected {
        return Err(Error::Length { id, found: payload.len(), expected });
    }
    let word = Word::from_bytes(payload);
    if let Some(field) = crc_field(message) {
        let (found, expected) = (word.get(field) as u16, checksum(message, payload));
        if found != expected {
            return Err(Error::Checksum { id, found, expected });
        }
    }
    Ok(word)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Profile;

    #[test]
    fn both_crcs_meet_their_published_check_values() {
        assert_eq!(CRC8.checksum(b"123456789"), 0x4B);
        assert_eq!(CRC16.checksum(b"123456789"), 0x29B1);
    }

    #[test]
    fn no_payload_passes_under_another_id() {
        // Both CRCs are linear: if one payload distinguishes two ids, every payload does.
        for first in MessageId::all().filter(|id| crc_field(*id).is_some()) {
            let payload = [0; 16];
            let payload = &payload[..first.payload_len()];
            for second in MessageId::all().filter(|id| *id != first) {
                if second.payload_len() == first.payload_len() {
                    assert_ne!(
                        checksum(first, payload),
                        checksum(second, payload),
                        "{first} {second}"
                    );
                }
            }
        }
    }

    #[test]
    fn every_single_and_double_bit_error_is_found() {
        for profile in [Profile::Classical, Profile::Fd] {
            let message = MessageId::Measurement(profile, crate::Node::ALL[2]);
            let frame = seal(message, Word::default());
            assert!(open(message, frame.data()).is_ok());
            let bits = frame.data().len() * 8;
            for first in 0..bits {
                for second in first..bits {
                    let mut data: heapless::Vec<u8, 16> =
                        heapless::Vec::from_slice(frame.data()).unwrap();
                    data[first / 8] ^= 1 << (first % 8);
                    if second != first {
                        data[second / 8] ^= 1 << (second % 8);
                    }
                    let opened = open(message, &data);
                    assert!(matches!(opened, Err(Error::Checksum { .. })), "bits {first} {second}");
                }
            }
        }
    }
}
