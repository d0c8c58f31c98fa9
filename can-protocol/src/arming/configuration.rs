//! The configuration of a session, and the hash that must be equal on both sides.
use super::limits::Limits;
use crate::{PROTOCOL_VERSION, Pace, Profile};
use core::num::{NonZeroU8, NonZeroU16};
use crc::{CRC_32_ISO_HDLC, Crc};

const CRC32: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Hash of the frames of this version: the CRC-32 over all `BO_` and `SG_` lines of `yawbench.dbc`
/// in their order, each without white space at its ends and with one line feed behind it. The
/// messages `TRACK_*`, which no rig knows, are left out.
pub const DBC_HASH: u32 = 0xFEA1_1EEF;

/// What both sides must agree on to the bit.
///
/// ```
/// use can_protocol::arming::{Configuration, DBC_HASH, Limits};
/// use can_protocol::{Pace, Profile};
/// let configuration = Configuration {
///     profile: Profile::Classical,
///     pace: Pace::Clock,
///     period_us: 1000.try_into()?,
///     slow_down: 1.try_into()?,
///     watchdog_cycles: 5,
///     limits: Limits {
///         stroke_um: 20_000,
///         velocity_um_per_s: 300_000,
///         acceleration_mm_per_s2: 9000,
///         force_n: 30_000,
///     },
/// };
/// let dbc = DBC_HASH.to_le_bytes();
/// assert_eq!(configuration.to_bytes(), [
///     2, 0, 0, 1, // version, profile, pace, slow-down
///     0xE8, 0x03, 0x05, 0x00, // period in us, watchdog in cycles
///     0x20, 0x4E, 0x00, 0x00, // stroke in um
///     0xE0, 0x93, 0x04, 0x00, // velocity in um/s
///     0x28, 0x23, 0x00, 0x00, // acceleration in mm/s^2
///     0x30, 0x75, 0x00, 0x00, // force in N
///     dbc[0], dbc[1], dbc[2], dbc[3],
/// ]);
/// assert_eq!(configuration.hash(), 0xB720_3BED);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// In Python: `zlib.crc32(struct.pack("<4B2H5I", 2, 0, 0, 1, 1000, 5, 20000, 300000, 9000, 30000,
/// dbc))`, where `dbc` is `zlib.crc32` of the lines of the DBC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Configuration {
    /// Frame format of the cyclic pair: 0 classical, 1 FD.
    pub profile: Profile,
    /// Who waits for whom.
    pub pace: Pace,
    /// Length of a cycle in the model, µs.
    pub period_us: NonZeroU16,
    /// Real time over model time.
    pub slow_down: NonZeroU8,
    /// Cycles without a valid new frame after which either side goes safe.
    pub watchdog_cycles: u16,
    /// The limits, once they are agreed.
    pub limits: Limits,
}

impl Configuration {
    /// The bytes that are hashed, all numbers low byte first.
    pub fn to_bytes(&self) -> [u8; 28] {
        let Self { profile, pace, period_us, slow_down, watchdog_cycles, limits } = *self;
        let head =
            [PROTOCOL_VERSION, u8::from(profile == Profile::Fd), pace.code(), slow_down.get()];
        let mut bytes = [0; 28];
        let parts = head
            .into_iter()
            .chain(period_us.get().to_le_bytes())
            .chain(watchdog_cycles.to_le_bytes())
            .chain(limits.stroke_um.to_le_bytes())
            .chain(limits.velocity_um_per_s.to_le_bytes())
            .chain(limits.acceleration_mm_per_s2.to_le_bytes())
            .chain(limits.force_n.to_le_bytes())
            .chain(DBC_HASH.to_le_bytes());
        bytes.iter_mut().zip(parts).for_each(|(byte, part)| *byte = part);
        bytes
    }

    /// The CRC-32 (ISO-HDLC, that of zlib) over [`Configuration::to_bytes`].
    pub fn hash(&self) -> u32 {
        CRC32.checksum(&self.to_bytes())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn the_crc_meets_its_published_check_value() {
        assert_eq!(CRC32.checksum(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn every_field_counts() {
        let limits =
            Limits { stroke_um: 1, velocity_um_per_s: 2, acceleration_mm_per_s2: 3, force_n: 4 };
        let base = Configuration {
            profile: Profile::Classical,
            pace: Pace::Clock,
            period_us: NonZeroU16::MIN,
            slow_down: NonZeroU8::MIN,
            watchdog_cycles: 5,
            limits,
        };
        let with = |limits| Configuration { limits, ..base };
        let all = [
            base,
            Configuration { profile: Profile::Fd, ..base },
            Configuration { pace: Pace::LockStep, ..base },
            Configuration { period_us: NonZeroU16::MAX, ..base },
            Configuration { slow_down: NonZeroU8::MAX, ..base },
            Configuration { watchdog_cycles: 6, ..base },
            with(Limits { stroke_um: 2, ..limits }),
            with(Limits { velocity_um_per_s: 1, ..limits }),
            with(Limits { acceleration_mm_per_s2: 4, ..limits }),
            with(Limits { force_n: 3, ..limits }),
        ];
        let hashes: HashSet<u32> = all.iter().map(Configuration::hash).collect();
        assert_eq!(hashes.len(), all.len());
    }

    #[test]
    fn the_hash_of_the_dbc_is_that_of_the_committed_file() {
        let mut digest = CRC32.digest();
        let mut is_of_track = false;
        for line in include_str!("../../yawbench.dbc").lines().map(str::trim) {
            if line.starts_with("BO_ ") {
                is_of_track = line.contains(" TRACK_");
            }
            if !is_of_track && (line.starts_with("BO_ ") || line.starts_with("SG_ ")) {
                digest.update(line.as_bytes());
                digest.update(b"\n");
            }
        }
        let hash = digest.finalize();
        assert_eq!(hash, DBC_HASH, "the frames changed: set DBC_HASH to {hash:#010x}");
    }
}
