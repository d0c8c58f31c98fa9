//! The session code: what distinguishes the frames of this session from those of any other.
use crate::Profile;
use crc::{CRC_16_IBM_3740, Crc};

const CRC16: Crc<u16> = Crc::<u16>::new(&CRC_16_IBM_3740);

/// The constant of one session, from the numbers of both peers.
///
/// Host and rig draw a 32-bit number each and exchange them before the rig arms (see
/// [`crate::arming`]). Both numbers give one [`SessionCode`], the same in both directions. From
/// then on commands and measurements are **sealed**: a mask that is never sent is xored over the
/// CRC register between the `DataID` and the payload ([`crate::protection`]).
///
/// ```text
/// code      = CRC-16/CCITT-FALSE over number of the host, then number of the rig,
///             both as four bytes, low byte first
/// roll-over = cycle / modulus          (15 classical, 255 FD; the counter is cycle mod modulus)
/// mask      = (code + roll-over * (2 * code + 1)) mod 2^w     w = 8 classical, 16 FD
/// ```
///
/// The cycle is the sender's 32-bit number of the frame: 0 for the first one after arming, then
/// one more for each. A CRC-8 counts the low 8 bits of code and roll-over, a CRC-16 counts 16; the
/// bits above have no effect. A session ends before its cycle number does: after 49 days at 1 kHz,
/// 12 days at 4 kHz.
///
/// # What a seal refuses
///
/// The mask of a frame and that of its receiver must be equal, since two different masks never
/// give one CRC. So, with `n` = 256 for CRC-8 and 65,536 for CRC-16:
///
/// | frame | passes |
/// | --- | --- |
/// | of this session, `k` roll-overs old (15 `k` cycles, FD 255 `k`) | only when `k` is a multiple of `n`: it fails in 255 of 256 cases (FD 65,535 of 65,536), and always up to 3,825 cycles (FD 16.7 million) |
/// | plain, as any tool sends it that knows only the DBC | in 1 of `n` roll-overs, never in the first |
/// | of a session with another code, in the same cycle | never |
/// | of a session with another code, in an unrelated cycle | 1 in `n` |
/// | random bytes under this id | 1 in `n` |
///
/// What passes by chance meets the counter, the echo and the limit on the step of a command. This
/// is no authentication: who listens to the arming exchange can compute the code.
///
/// Plain frames have the mask 0. A code whose low byte is 0 is therefore never used, nor one whose
/// low byte was that of this peer's last 16 sessions ([`SessionHistory`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SessionCode(u16);

impl SessionCode {
    /// The code of two numbers.
    ///
    /// ```
    /// use can_protocol::SessionCode;
    /// // The CRC runs over 78 56 34 12 EF BE AD DE.
    /// assert_eq!(SessionCode::of(0x1234_5678, 0xDEAD_BEEF).bits(), 0x49C5);
    /// ```
    pub fn of(host_number: u32, rig_number: u32) -> Self {
        let mut digest = CRC16.digest();
        digest.update(&host_number.to_le_bytes());
        digest.update(&rig_number.to_le_bytes());
        Self(digest.finalize())
    }

    /// All 16 bits.
    pub const fn bits(self) -> u16 {
        self.0
    }

    /// The bits that must distinguish sessions under either CRC.
    const fn low_byte(self) -> u8 {
        (self.0 & 0xFF) as u8
    }
}

/// What seals one frame: the session's code and the frame's place in the session.
///
/// ```
/// use can_protocol::{Profile, Seal, SessionCode};
/// let code = SessionCode::of(0x1234_5678, 0xDEAD_BEEF); // 0x49C5
/// let seal = Seal { code, cycle: 1000 };
/// assert_eq!(seal.counter(Profile::Classical), 10); // 1000 = 66 * 15 + 10
/// assert_eq!(seal.mask(Profile::Classical), 0x9B); // 0xC5 + 66 * 0x18B, low 8 bits
/// assert_eq!(seal.counter(Profile::Fd), 235); // 1000 = 3 * 255 + 235
/// assert_eq!(seal.mask(Profile::Fd), 0x0466); // 0x49C5 + 3 * 0x938B, low 16 bits
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seal {
    /// The session's code.
    pub code: SessionCode,
    /// The sender's number of the frame, 0 for its first one after arming.
    pub cycle: u32,
}

impl Seal {
    /// The frame's counter.
    pub const fn counter(self, profile: Profile) -> u8 {
        (self.cycle % profile.counter_modulus() as u32) as u8
    }

    /// What is xored over the CRC register between `DataID` and payload.
    pub const fn mask(self, profile: Profile) -> u16 {
        let roll_over = (self.cycle / profile.counter_modulus() as u32) as u16;
        let stride = self.code.0.wrapping_mul(2).wrapping_add(1);
        let mask = self.code.0.wrapping_add(roll_over.wrapping_mul(stride));
        match profile {
            Profile::Classical => mask & 0xFF,
            Profile::Fd => mask,
        }
    }
}

/// The codes that a peer must not use: that of the plain DBC and those of its last 16 sessions.
///
/// ```
/// use can_protocol::{SessionCode, SessionHistory};
/// let mut history = SessionHistory::default();
/// let code = SessionCode::of(1, 2);
/// assert!(history.allows(code));
/// history.remember(code);
/// assert!(!history.allows(code));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SessionHistory {
    /// Low bytes, newest first. 0, the mask of plain frames, also marks an unused place.
    last: [u8; Self::SESSIONS],
}

impl SessionHistory {
    /// How many sessions count.
    pub const SESSIONS: usize = 16;

    /// Whether a session may have this code.
    pub fn allows(&self, code: SessionCode) -> bool {
        let low_byte = code.low_byte();
        low_byte != 0 && self.last.iter().all(|used| *used != low_byte)
    }

    /// Takes up the code of a session that begins; the oldest of 16 is forgotten.
    pub fn remember(&mut self, code: SessionCode) {
        self.last.rotate_right(1);
        if let Some(newest) = self.last.first_mut() {
            *newest = code.low_byte();
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec;

    const PROFILES: [Profile; 2] = [Profile::Classical, Profile::Fd];

    fn masks(profile: Profile) -> u32 {
        match profile {
            Profile::Classical => 256,
            Profile::Fd => 65_536,
        }
    }

    fn mask(code: u16, roll_over: u32, profile: Profile) -> u16 {
        let cycle = roll_over * u32::from(profile.counter_modulus());
        Seal { code: SessionCode(code), cycle }.mask(profile)
    }

    #[test]
    #[cfg_attr(miri, ignore = "minutes to hours in an interpreter")]
    fn the_masks_of_a_session_repeat_only_after_all_of_them() {
        // All codes for CRC-8, every 257th for CRC-16.
        for (profile, codes) in [(Profile::Classical, 1), (Profile::Fd, 257)] {
            for code in (0..masks(profile)).step_by(codes) {
                let mut seen = vec![false; masks(profile) as usize];
                for roll_over in 0..masks(profile) {
                    let mask = mask(code as u16, roll_over, profile);
                    assert!(!seen[usize::from(mask)], "{profile:?} {code:#x} {roll_over}");
                    seen[usize::from(mask)] = true;
                }
            }
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "minutes to hours in an interpreter")]
    fn two_codes_never_have_one_mask_in_one_cycle() {
        for (profile, roll_overs) in [(Profile::Classical, 1), (Profile::Fd, 8191)] {
            for roll_over in (0..masks(profile)).step_by(roll_overs) {
                let mut seen = vec![false; masks(profile) as usize];
                for code in 0..masks(profile) {
                    let mask = usize::from(mask(code as u16, roll_over, profile));
                    assert!(!seen[mask], "{profile:?} {code:#x} {roll_over}");
                    seen[mask] = true;
                }
            }
        }
    }

    #[test]
    fn a_plain_frame_passes_in_one_roll_over_of_256_and_never_in_the_first() {
        for code in 1..=255_u16 {
            let plain = |roll_over| mask(code, roll_over, Profile::Classical) == 0;
            assert!(!plain(0));
            assert_eq!((0..256).filter(|roll_over| plain(*roll_over)).count(), 1);
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "minutes to hours in an interpreter")]
    fn only_the_stated_bits_count() {
        for cycle in (0..u32::MAX - 15 * 256).step_by(99_991) {
            let at = |code, cycle| Seal { code: SessionCode(code), cycle }.mask(Profile::Classical);
            assert_eq!(at(0x00D5, cycle), at(0xF0D5, cycle));
            assert_eq!(at(0x00D5, cycle), at(0x00D5, cycle + 15 * 256));
        }
    }

    #[test]
    fn the_code_depends_on_every_bit_of_both_numbers() {
        let code = SessionCode::of(0x1234_5678, 0xDEAD_BEEF);
        for bit in 0..32 {
            assert_ne!(SessionCode::of(0x1234_5678 ^ 1 << bit, 0xDEAD_BEEF), code);
            assert_ne!(SessionCode::of(0x1234_5678, 0xDEAD_BEEF ^ 1 << bit), code);
        }
        assert_ne!(SessionCode::of(0xDEAD_BEEF, 0x1234_5678), code, "the peers are distinct");
    }

    #[test]
    #[cfg_attr(miri, ignore = "minutes to hours in an interpreter")]
    fn codes_are_spread_evenly_over_random_numbers() {
        // Counting numbers are the worst source: each low byte must still be as frequent as others.
        let mut frequency = [0_u32; 256];
        for number in 0..65_536 {
            frequency[usize::from(SessionCode::of(7, number).low_byte())] += 1;
        }
        assert!(frequency.iter().all(|count| *count == 256), "{frequency:?}");
    }

    #[test]
    fn a_peer_never_repeats_one_of_its_last_16_codes() {
        let mut history = SessionHistory::default();
        for low_byte in 0..=255_u16 {
            assert!(!history.allows(SessionCode(low_byte << 8)), "the plain mask");
            assert_eq!(history.allows(SessionCode(low_byte)), low_byte != 0);
        }
        for session in 1..=40_u16 {
            history.remember(SessionCode(session));
            for earlier in 1..=40 {
                let recent = earlier <= session && earlier + 16 > session;
                assert_eq!(history.allows(SessionCode(earlier)), !recent, "{earlier} {session}");
                assert_eq!(history.allows(SessionCode(earlier | 0xAB00)), !recent);
            }
        }
    }

    #[test]
    fn the_counter_is_the_cycle_modulo_its_range() {
        for profile in PROFILES {
            let mut counter = 0;
            for cycle in 0..1000 {
                assert_eq!(Seal { code: SessionCode(1), cycle }.counter(profile), counter);
                counter = profile.next_counter(counter);
            }
        }
    }
}
