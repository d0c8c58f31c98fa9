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
//! Neither is reflected. That is the **plain** CRC, which all messages have. Commands and
//! measurements of an armed session are **sealed**: the register is xored with the frame's mask
//! ([`Seal::mask`]) after the `DataID` and before the payload. With the mask 0 the CRC is plain.
//! In Python:
//!
//! ```python
//! def crc8(data, register=0xFF):
//!     for byte in data:
//!         register ^= byte
//!         for _ in range(8):
//!             register = (register << 1 ^ 0x1D if register & 0x80 else register << 1) & 0xFF
//!     return register
//!
//! def crc_of(frame_id, payload, mask=0):        # 6- and 8-byte frames
//!     return crc8(payload[1:], crc8((0x5000 + frame_id).to_bytes(2, "big")) ^ mask) ^ 0xFF
//!
//! def mask(code, cycle):                        # classical; code = low byte of the session code
//!     return (code + cycle // 15 * (2 * code + 1)) & 0xFF
//! ```
//!
//! What the seal refuses, and how often it errs, stands at [`SessionCode`](crate::SessionCode).
//!
//! The method is that of AUTOSAR's end-to-end profiles 1 and 5 (counter, `DataID` in the CRC,
//! receiver status); the frames are not bit-compatible with them.
use crate::signal::{Field, Word};
use crate::{Error, Frame, MessageId, Profile, Seal};
use crc::{CRC_8_SAE_J1850, CRC_16_IBM_3740, Crc};

const CRC8: Crc<u8> = Crc::<u8>::new(&CRC_8_SAE_J1850);
/// The catalogue's name for CRC-16/CCITT-FALSE.
const CRC16: Crc<u16> = Crc::<u16>::new(&CRC_16_IBM_3740);

/// The CRC field of a message.
pub const fn crc_field(message: MessageId) -> Field {
    match message.profile() {
        Profile::Fd => Field::new(0, 16),
        Profile::Classical => Field::new(0, 8),
    }
}

/// The plain CRC of a payload, read from behind its CRC bytes.
///
/// ```
/// use can_protocol::{MessageId, Node, Profile, protection::checksum};
/// let message = MessageId::Command(Profile::Classical, Node::new(1)?);
/// let payload = [0x18, 0x43, 0x28, 0x87, 0x00, 0x50, 0xE2, 0x22];
/// assert_eq!(checksum(message, &payload), 0x18);
/// # Ok::<(), can_protocol::Error>(())
/// ```
pub fn checksum(message: MessageId, payload: &[u8]) -> u16 {
    masked_checksum(message, payload, 0)
}

/// The sealed CRC of a payload, read from behind its CRC bytes.
///
/// ```
/// use can_protocol::{MessageId, Node, Profile, Seal, SessionCode};
/// use can_protocol::protection::sealed_checksum;
/// let message = MessageId::Command(Profile::Classical, Node::new(1)?);
/// let payload = [0x00, 0x4A, 0x28, 0x87, 0x00, 0x50, 0xE2, 0x22];
/// let code = SessionCode::of(0x1234_5678, 0xDEAD_BEEF);
/// let seal = Seal { code, cycle: 1000 }; // counter 10, mask 0x9B
/// assert_eq!(sealed_checksum(message, &payload, seal), 0xBA);
/// # Ok::<(), can_protocol::Error>(())
/// ```
pub fn sealed_checksum(message: MessageId, payload: &[u8], seal: Seal) -> u16 {
    masked_checksum(message, payload, seal.mask(message.profile()))
}

fn masked_checksum(message: MessageId, payload: &[u8], mask: u16) -> u16 {
    debug_assert!(payload.len() == message.payload_len(), "{message:?} in {} bytes", payload.len());
    let data_id = message.data_id().to_be_bytes();
    match (message.profile(), payload) {
        (Profile::Fd, [_, _, protected @ ..]) => {
            let register = CRC16.checksum(&data_id) ^ mask;
            let mut digest = CRC16.digest_with_initial(register);
            digest.update(protected);
            digest.finalize()
        }
        (Profile::Classical, [_, protected @ ..]) => {
            // The checksum comes with the final xor, the register is without.
            let register = CRC8.checksum(&data_id) ^ CRC_8_SAE_J1850.xorout ^ mask as u8;
            let mut digest = CRC8.digest_with_initial(register);
            digest.update(protected);
            u16::from(digest.finalize())
        }
        _ => 0,
    }
}

/// The frame of a message whose fields are set: with its CRC.
pub(crate) fn protect(message: MessageId, word: Word, seal: Option<Seal>) -> Frame {
    protect_masked(message, word, mask(message, seal))
}

/// The same with any mask.
pub(crate) fn protect_masked(message: MessageId, mut word: Word, mask: u16) -> Frame {
    let bytes = word.to_bytes();
    debug_assert!(message.payload_len() <= bytes.len(), "{message:?} is longer than 16 bytes");
    let payload = bytes.get(..message.payload_len()).unwrap_or(&bytes);
    word.put(crc_field(message), u32::from(masked_checksum(message, payload, mask)));
    Frame::new(message, word.to_bytes())
}

/// The fields of a payload whose length and CRC are right.
pub(crate) fn open(message: MessageId, payload: &[u8], seal: Option<Seal>) -> Result<Word, Error> {
    open_masked(message, payload, mask(message, seal))
}

/// The same with any mask.
pub(crate) fn open_masked(message: MessageId, payload: &[u8], mask: u16) -> Result<Word, Error> {
    let (id, length) = (message.raw(), message.payload_len());
    if payload.len() != length {
        return Err(Error::Length { id, found: payload.len(), expected: length });
    }
    let word = Word::from_bytes(payload);
    let found = word.get(crc_field(message)) as u16;
    let expected = masked_checksum(message, payload, mask);
    if found == expected { Ok(word) } else { Err(Error::Checksum { id, found, expected }) }
}

/// The mask of a seal; 0 without one.
fn mask(message: MessageId, seal: Option<Seal>) -> u16 {
    seal.map_or(0, |seal| seal.mask(message.profile()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SessionCode;

    #[test]
    fn both_crcs_meet_their_published_check_values() {
        assert_eq!(CRC8.checksum(b"123456789"), 0x4B);
        assert_eq!(CRC16.checksum(b"123456789"), 0x29B1);
    }

    #[test]
    #[cfg_attr(miri, ignore = "minutes to hours in an interpreter")]
    fn no_payload_passes_under_another_id() {
        // Both CRCs are linear: if one payload distinguishes two ids, every payload does.
        for first in MessageId::all() {
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
    #[cfg_attr(miri, ignore = "minutes to hours in an interpreter")]
    fn every_single_and_double_bit_error_is_found() {
        for profile in [Profile::Classical, Profile::Fd] {
            let message = MessageId::Measurement(profile, crate::Node::ALL[2]);
            let frame = protect(message, Word::default(), None);
            assert!(open(message, frame.data(), None).is_ok());
            let bits = frame.data().len() * 8;
            for first in 0..bits {
                for second in first..bits {
                    let mut data: heapless::Vec<u8, 16> =
                        heapless::Vec::from_slice(frame.data()).unwrap();
                    data[first / 8] ^= 1 << (first % 8);
                    if second != first {
                        data[second / 8] ^= 1 << (second % 8);
                    }
                    let opened = open(message, &data, None);
                    assert!(matches!(opened, Err(Error::Checksum { .. })), "bits {first} {second}");
                }
            }
        }
    }
    #[test]
    #[cfg_attr(miri, ignore = "minutes to hours in an interpreter")]
    fn a_frame_opens_under_its_own_mask_and_no_other() {
        let code = SessionCode::of(3, 4);
        for (profile, cycles) in [(Profile::Classical, 1_u32 << 16), (Profile::Fd, 1 << 18)] {
            let message = MessageId::Command(profile, crate::Node::ALL[0]);
            let mut word = Word::default();
            word.put(Field::new(32, 32), 0x2A48_D30F);
            let seal = |cycle| Seal { code, cycle };
            let frame = protect(message, word, Some(seal(77)));
            let opens =
                |seal| open(message, frame.data(), seal) == Ok(Word::from_bytes(frame.data()));
            assert!(opens(Some(seal(77))));
            assert!(!opens(None), "a plain receiver refuses it");
            for cycle in (0..cycles).step_by(7) {
                let same = seal(cycle).mask(profile) == seal(77).mask(profile);
                assert_eq!(opens(Some(seal(cycle))), same, "{cycle}");
            }
        }
    }
}
