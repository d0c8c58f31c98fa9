//! Which track it is: its grid, its length, its fingerprint.

use can_protocol::{TrackFingerprint, TrackItem, TrackSample};
use core::fmt;
use firmware_core::track::{Irregularity, IrregularitySample};

/// A track as a server offers it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Identity {
    /// Distance of the first sample (um).
    pub first_um: i32,
    /// Distance between samples (um).
    pub step_um: u32,
    /// Samples of the whole track; [`Identity::ENDLESS`] where it is run there and back and there
    /// again.
    pub samples: u32,
    /// [`TrackFingerprint`] of its samples, those of one way.
    pub fingerprint: u32,
}

impl Identity {
    /// Number of samples of a track without an end.
    pub const ENDLESS: u32 = u32::MAX;

    /// The identity of a whole track.
    ///
    /// # Errors
    /// A grid that is not in whole micrometres, or a sample beyond what travels.
    pub fn of(track: &Irregularity<'_>, is_endless: bool) -> Result<Self, Unservable> {
        let grid = Unservable::Grid { first_m: track.first_m, step_m: track.step_m };
        let first_um = whole_um(track.first_m).ok_or(grid)?;
        let first_um = i32::try_from(first_um).map_err(|_| grid)?;
        let step_um = whole_um(track.step_m).ok_or(grid)?;
        let step_um = u32::try_from(step_um).ok().filter(|step| *step > 0).ok_or(grid)?;
        let count = track.samples.len();
        let too_long = Unservable::Samples { found: count };
        let samples = match u32::try_from(count) {
            Ok(count) if (4..Self::ENDLESS).contains(&count) => count,
            _ => return Err(too_long),
        };
        let samples = if is_endless { Self::ENDLESS } else { samples };
        let mut fingerprint = TrackFingerprint::new(first_um, step_um, samples);
        for (number, sample) in track.samples.iter().enumerate() {
            as_sent(sample).ok_or(Unservable::Sample { number })?;
            fingerprint.add(channels(sample));
        }
        Ok(Self { first_um, step_um, samples, fingerprint: fingerprint.value() })
    }

    /// Its value of an item on the wire.
    pub(super) const fn value(&self, item: TrackItem) -> u32 {
        match item {
            TrackItem::First => self.first_um as u32,
            TrackItem::Step => self.step_um,
            TrackItem::Samples => self.samples,
            TrackItem::Fingerprint => self.fingerprint,
        }
    }

    /// Distance of the first sample and between samples (m).
    pub(super) fn grid_m(&self) -> (f64, f64) {
        (f64::from(self.first_um) / 1e6, f64::from(self.step_um) / 1e6)
    }
}

/// A length in whole micrometres; none where it is not one.
fn whole_um(length_m: f64) -> Option<i64> {
    let length_um = libm::rint(length_m * 1e6);
    let is_whole = length_um / 1e6 == length_m && length_um.abs() < 1e15;
    is_whole.then_some(length_um as i64)
}

/// A sample as it travels, in steps of 10 nm; none where a channel is beyond ±83.9 mm.
///
/// ```
/// use firmware_core::track::IrregularitySample;
/// let sample = IrregularitySample { gauge_m: 1.234_567_89e-3, ..Default::default() };
/// assert_eq!(nodes::track::as_sent(&sample).unwrap().gauge_m, 1.234_57e-3);
/// ```
pub fn as_sent(sample: &IrregularitySample) -> Option<IrregularitySample> {
    Some(IrregularitySample {
        vertical_m: TrackSample::rounded(sample.vertical_m)?,
        alignment_m: TrackSample::rounded(sample.alignment_m)?,
        cross_level_m: TrackSample::rounded(sample.cross_level_m)?,
        gauge_m: TrackSample::rounded(sample.gauge_m)?,
    })
}

/// The channels in the order in which they travel.
pub(super) const fn channels(sample: &IrregularitySample) -> [f64; 4] {
    let IrregularitySample { vertical_m, alignment_m, cross_level_m, gauge_m } = *sample;
    [vertical_m, alignment_m, cross_level_m, gauge_m]
}

/// Why a track cannot be served.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unservable {
    /// First sample or step is not in whole micrometres, or too far away.
    Grid {
        /// Distance of the first sample (m).
        first_m: f64,
        /// Distance between samples (m).
        step_m: f64,
    },
    /// Too few or too many samples.
    Samples {
        /// How many there are.
        found: usize,
    },
    /// A channel of a sample is beyond ±83.9 mm, or no number.
    Sample {
        /// Its number.
        number: usize,
    },
}

impl Unservable {
    /// What was expected.
    pub const fn expected(&self) -> &'static str {
        match self {
            Self::Grid { .. } => {
                "a grid in whole micrometres, with the first sample within 2147 m of the start"
            }
            Self::Samples { .. } => "4 to 4294967294 samples",
            Self::Sample { .. } => "at most 83.88607 mm in each channel",
        }
    }
}

/// What was found.
impl fmt::Display for Unservable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Grid { first_m, step_m } => {
                write!(f, "samples of the track every {step_m} m from {first_m} m")
            }
            Self::Samples { found } => write!(f, "{found} samples of the track"),
            Self::Sample { number } => write!(f, "more in sample {number} of the track"),
        }
    }
}

impl core::error::Error for Unservable {}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(samples: &[IrregularitySample], step_m: f64) -> Irregularity<'_> {
        Irregularity { samples, first_m: -20.0, step_m, ..Irregularity::default() }
    }

    #[test]
    fn a_track_is_told_from_any_other() {
        let plain = [IrregularitySample { gauge_m: 1e-3, ..Default::default() }; 5];
        let with = |cross_level_m| {
            let mut samples = plain;
            samples[3].cross_level_m = cross_level_m;
            samples
        };
        let of =
            |samples: &[_], step_m, is_endless| Identity::of(&track(samples, step_m), is_endless);
        let identity = of(&plain, 0.1, false).unwrap();
        let Identity { first_um, step_um, samples, .. } = identity;
        assert_eq!((first_um, step_um, samples), (-20_000_000, 100_000, 5));
        for other in [
            of(&with(10e-9), 0.1, false),
            of(&plain, 0.2, false),
            of(&plain, 0.1, true),
            of(&plain[..4], 0.1, false),
        ] {
            assert_ne!(other.unwrap().fingerprint, identity.fingerprint);
        }
        // Less than half a step of 10 nm is not seen, and does not travel.
        assert_eq!(of(&with(4e-9), 0.1, false), Ok(identity));
    }

    #[test]
    fn what_cannot_travel_is_refused() {
        let of = |samples: &[_], step_m| Identity::of(&track(samples, step_m), false);
        let samples = [IrregularitySample::default(); 5];
        for step_m in [1.0 / 3.0, 0.0, -0.1, f64::NAN, 1e9] {
            assert!(matches!(of(&samples, step_m), Err(Unservable::Grid { .. })), "{step_m}");
        }
        assert_eq!(of(&samples[..3], 0.1), Err(Unservable::Samples { found: 3 }));
        for vertical_m in [0.084, -0.084, f64::NAN, f64::INFINITY] {
            let mut samples = samples;
            samples[2].vertical_m = vertical_m;
            assert_eq!(of(&samples, 0.1), Err(Unservable::Sample { number: 2 }), "{vertical_m}");
        }
    }
}
