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
    /// Samples of the track, one way.
    pub samples: u32,
    /// Whether it ends with them.
    pub ways: Ways,
    /// [`TrackFingerprint`] of all that.
    pub fingerprint: u32,
}

/// How a track goes on behind its last sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ways {
    /// It ends there.
    One = 1,
    /// It is run there and back and there again, without an end.
    ThereAndBack = 2,
}

impl Ways {
    /// Of its number on the wire.
    pub(super) const fn of(ways: u32) -> Option<Self> {
        match ways {
            1 => Some(Self::One),
            2 => Some(Self::ThereAndBack),
            _ => None,
        }
    }
}

impl Identity {
    /// The identity of a track by its first stretch.
    ///
    /// # Errors
    /// A grid that is not in whole micrometres, or a sample of the stretch beyond what travels.
    pub fn of(track: &Irregularity<'_>, ways: Ways) -> Result<Self, Unservable> {
        debug_assert!(track.before == 0, "a track without its first {} samples", track.before);
        if track.samples.is_empty() {
            return Err(Unservable::None);
        }
        let grid = Unservable::Grid { first_m: track.first_m, step_m: track.step_m };
        let first_um = whole_um(track.first_m).ok_or(grid)?;
        let first_um = i32::try_from(first_um).map_err(|_| grid)?;
        let step_um = whole_um(track.step_m).ok_or(grid)?;
        let step_um = u32::try_from(step_um).ok().filter(|step| *step > 0).ok_or(grid)?;
        let found = track.samples.len().saturating_add(track.behind);
        let samples = u32::try_from(found).ok().filter(|count| *count >= 4);
        let samples = samples.ok_or(Unservable::Samples { found })?;
        if ways == Ways::ThereAndBack && track.behind > 0 {
            return Err(Unservable::TooLongForTheWayBack { found: samples });
        }
        let mut fingerprint = TrackFingerprint::new(first_um, step_um, ways as u32);
        for (number, sample) in track.samples.iter().enumerate() {
            as_sent(sample).ok_or(Unservable::Sample { number })?;
            if number < TrackFingerprint::SAMPLES {
                fingerprint.add(channels(sample));
            }
        }
        Ok(Self { first_um, step_um, samples, ways, fingerprint: fingerprint.value() })
    }

    /// Its value of an item on the wire.
    pub(super) const fn value(&self, item: TrackItem) -> u32 {
        match item {
            TrackItem::First => self.first_um as u32,
            TrackItem::Step => self.step_um,
            TrackItem::Samples => self.samples,
            TrackItem::Ways => self.ways as u32,
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
    /// The rails are perfect.
    None,
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
    /// A track that is not in memory as a whole cannot be run back.
    TooLongForTheWayBack {
        /// How many samples there are.
        found: u32,
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
            Self::None => "irregularity: perfect track needs no server",
            Self::Grid { .. } => {
                "a grid in whole micrometres, with the first sample within 2147 m of the start"
            }
            Self::Samples { .. } => "4 to 4294967295 samples",
            Self::TooLongForTheWayBack { .. } => "at most 262144 for a track there and back",
            Self::Sample { .. } => "at most 83.88607 mm in each channel",
        }
    }
}

/// What was found.
impl fmt::Display for Unservable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("a track without irregularity"),
            Self::Grid { first_m, step_m } => {
                write!(f, "samples of the track every {step_m} m from {first_m} m")
            }
            Self::Samples { found } => write!(f, "{found} samples of the track"),
            Self::TooLongForTheWayBack { found } => write!(f, "{found} samples of the track"),
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
        let of = |samples: &[_], step_m, ways| Identity::of(&track(samples, step_m), ways);
        let identity = of(&plain, 0.1, Ways::One).unwrap();
        let Identity { first_um, step_um, samples, .. } = identity;
        assert_eq!((first_um, step_um, samples), (-20_000_000, 100_000, 5));
        for other in [
            of(&with(10e-9), 0.1, Ways::One),
            of(&plain, 0.2, Ways::One),
            of(&plain, 0.1, Ways::ThereAndBack),
            of(&plain[..4], 0.1, Ways::One),
        ] {
            assert_ne!(other.unwrap().fingerprint, identity.fingerprint);
        }
        // Less than half a step of 10 nm is not seen, and does not travel.
        assert_eq!(of(&with(4e-9), 0.1, Ways::One), Ok(identity));
    }

    #[test]
    fn what_cannot_travel_is_refused() {
        let of = |samples: &[_], step_m| Identity::of(&track(samples, step_m), Ways::One);
        let samples = [IrregularitySample::default(); 5];
        for step_m in [1.0 / 3.0, 0.0, -0.1, f64::NAN, 1e9] {
            assert!(matches!(of(&samples, step_m), Err(Unservable::Grid { .. })), "{step_m}");
        }
        assert_eq!(of(&[], 0.1), Err(Unservable::None));
        assert_eq!(of(&samples[..3], 0.1), Err(Unservable::Samples { found: 3 }));
        let long = Irregularity { behind: 300_000, ..track(&samples, 0.1) };
        assert_eq!(Identity::of(&long, Ways::One).map(|track| track.samples), Ok(300_005));
        let found = Unservable::TooLongForTheWayBack { found: 300_005 };
        assert_eq!(Identity::of(&long, Ways::ThereAndBack), Err(found));
        for vertical_m in [0.084, -0.084, f64::NAN, f64::INFINITY] {
            let mut samples = samples;
            samples[2].vertical_m = vertical_m;
            assert_eq!(of(&samples, 0.1), Err(Unservable::Sample { number: 2 }), "{vertical_m}");
        }
    }
}
