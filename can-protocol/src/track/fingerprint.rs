//! The fingerprint of a track: what a locomotive compares before it runs on a stranger's samples.
use super::TrackSample;
use crc::{CRC_32_ISO_HDLC, Crc, Digest, Table};

static CRC32: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// The CRC-32 of zlib over a track: distance of the first sample (µm), step (µm) and ways, four
/// bytes each, then the codes of the samples in their order, vertical, alignment, cross level and
/// gauge, three bytes each; low byte first throughout. Of a long track the first
/// [`TrackFingerprint::SAMPLES`] count, 26 km on a grid of 0.1 m.
///
/// ```
/// use can_protocol::TrackFingerprint;
/// let mut fingerprint = TrackFingerprint::new(-20_000_000, 100_000, 1);
/// fingerprint.add([1e-3, -2e-3, 0.0, 10e-9]);
/// // In Python: zlib.crc32(bytes.fromhex(
/// //     "00d3cefe a0860100 01000000 a08601 c0f2fc 000000 010000"))
/// assert_eq!(fingerprint.value(), 0xC5A7_4554);
/// ```
#[derive(Clone)]
pub struct TrackFingerprint(Digest<'static, u32, Table<1>>);

impl TrackFingerprint {
    /// Samples that count at most.
    pub const SAMPLES: usize = 1 << 18;

    /// Of a track of which no sample has been added yet.
    pub fn new(first_um: i32, step_um: u32, ways: u32) -> Self {
        let mut digest = CRC32.digest();
        for value in [first_um as u32, step_um, ways] {
            digest.update(&value.to_le_bytes());
        }
        Self(digest)
    }

    /// Adds the next sample by its four channels (m).
    pub fn add(&mut self, channels_m: [f64; 4]) {
        let [signal, _] = TrackSample::CHANNELS;
        for value_m in channels_m {
            let [low, middle, high, _] = signal.code(Some(value_m)).0.to_le_bytes();
            self.0.update(&[low, middle, high]);
        }
    }

    /// The fingerprint of what was added.
    pub fn value(&self) -> u32 {
        self.0.clone().finalize()
    }
}
