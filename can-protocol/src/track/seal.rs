//! The seal of a sample: of which session, of which track, at which place.
use crate::SessionCode;

/// What seals a sample of the track.
///
/// ```text
/// code = CRC-16/CCITT-FALSE over session and fingerprint, both as four bytes, low byte first
/// k    = number of the sample / 15
/// mask = upper byte of (code + k * (2 * code + 1)) mod 65536
/// ```
///
/// The mask is xored over the CRC register as that of a [`Seal`](crate::Seal) is. The code counts
/// with all its bits, in different ways from one `k` to the next. So:
///
/// | sample | passes |
/// | --- | --- |
/// | of another session, of another track, or plain | 1 in 256 |
/// | all that a log has of another session or track | where both have one code: 1 in 65,536 |
/// | of the same session, some times 256 samples ago (any other has another number) | 1 in 256 in the mean over the distances, 1 in 9 at the worst of 200, always at 3,840 times |
///
/// ```
/// use can_protocol::TrackSeal;
/// let seal = TrackSeal::new(0x1234, 0xDEAD_BEEF);
/// assert_eq!((seal.code(), seal.mask(0), seal.mask(1000)), (0xDB7C, 0xDB, 0x07));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrackSeal(u16);

impl TrackSeal {
    /// That of a session on the track with a fingerprint.
    pub fn new(session: u16, fingerprint: u32) -> Self {
        Self(SessionCode::of(u32::from(session), fingerprint).bits())
    }

    /// The code.
    pub const fn code(self) -> u16 {
        self.0
    }

    /// The mask of a sample.
    pub const fn mask(self, sample: u32) -> u16 {
        let stride = self.0.wrapping_mul(2).wrapping_add(1);
        self.0.wrapping_add(((sample / 15) as u16).wrapping_mul(stride)) >> 8
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    /// Samples of 6 km that one seal lets through for another.
    fn passed(of: TrackSeal, by: TrackSeal, further: u32) -> usize {
        let samples = 0..60_000_u32;
        samples.filter(|sample| of.mask(*sample) == by.mask(sample + further)).count()
    }

    #[test]
    fn a_log_of_another_session_or_track_passes_by_chance_alone() {
        let seal = TrackSeal::new(0x5EED, 0xF00D);
        let (mut same, mut most) = (0, 0);
        for other in 0..2000_u16 {
            for by in [TrackSeal::new(other, 0xF00D), TrackSeal::new(0x5EED, u32::from(other))] {
                let is_same = by == seal;
                same += usize::from(is_same);
                most = most.max(if is_same { 0 } else { passed(seal, by, 0) });
            }
        }
        assert!(same <= 1 && most < 60_000 / 40, "{same} equal codes, at most {most} samples");
    }

    #[test]
    fn samples_of_a_window_or_more_ago_pass_by_chance_alone() {
        let seal = TrackSeal::new(0x5EED, 0xF00D);
        let passed: Vec<usize> =
            (1..=200).map(|windows| passed(seal, seal, 256 * windows)).collect();
        let (most, all) = (passed.iter().max(), passed.iter().sum::<usize>());
        assert!(most < Some(&(60_000 / 8)) && all < 200 * 60_000 / 200, "{most:?} of {all}");
        assert_eq!(super::tests::passed(seal, seal, 256 * 3840), 60_000);
    }
}
