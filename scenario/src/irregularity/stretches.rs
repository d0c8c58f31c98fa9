//! A random track in stretches, so that a run of a day needs no day of memory.
//!
//! ```text
//! |------- stretch 0 -------|
//!                      |------- stretch 1 -------|
//!                         ^ change               |------- stretch 2 ...
//! ```
//! Stretches overlap by more than the vehicle's length and the way of a cycle. The vehicle changes
//! in the middle of the overlap, where either stretch holds all of it. Every sample has the bits
//! that it has in the track as a whole.

use super::random::{BLOCK, Band, SAMPLE_STEP_M, count, make};
use super::samples::Samples;
use std::ops::Range;

/// Samples of a stretch: 26 km, 8.4 MB. At the highest speed of a run that is two and a half
/// minutes.
const STRETCH_SAMPLES: usize = 1 << 18;

/// Track that is held ahead of the foremost wheel and behind the rearmost one when the stretch
/// changes (m). No vehicle goes further in a cycle.
const MARGIN_M: f64 = 10.0;

/// The stretches of a random track.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretches {
    band: Band,
    first_m: f64,
    /// Samples of the whole track.
    total: usize,
    /// Samples of a stretch, the last one excepted.
    length: usize,
    /// Samples that a stretch shares with the next.
    overlap: usize,
}

impl Stretches {
    /// The track between two distances (m), for a vehicle whose bodies reach so far from its
    /// reference point (m).
    pub(crate) fn new(band: Band, (from_m, to_m): (f64, f64), reach_m: f64) -> Self {
        debug_assert!(reach_m >= 0.0 && reach_m.is_finite(), "a vehicle that reaches {reach_m} m");
        let overlap_m = 2.0 * (reach_m + MARGIN_M);
        let overlap = ((overlap_m / SAMPLE_STEP_M) as usize).next_multiple_of(2 * BLOCK);
        let total = count(from_m, to_m);
        Self { band, first_m: from_m, total, length: 0, overlap }.of_samples(STRETCH_SAMPLES)
    }

    /// The same track in stretches of at least so many samples.
    #[must_use]
    pub fn of_samples(self, length: usize) -> Self {
        let length = length.max(self.overlap + BLOCK).next_multiple_of(BLOCK);
        Self { length, ..self }
    }

    /// What it is made from.
    pub const fn band(&self) -> &Band {
        &self.band
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        1 + self.total.saturating_sub(self.length).div_ceil(self.length - self.overlap)
    }

    /// The stretch that has a sample, by its place in the whole track; the last one behind its end.
    pub fn number_at(&self, place: usize) -> usize {
        (place / (self.length - self.overlap)).min(self.count() - 1)
    }

    /// The samples of a stretch.
    fn range(&self, number: usize) -> Range<usize> {
        debug_assert!(number < self.count(), "stretch {number} of {}", self.count());
        let start = number * (self.length - self.overlap);
        start..self.total.min(start + self.length)
    }

    /// Where the vehicle changes from a stretch to the next: distance of its reference point (m).
    /// The last one is never left.
    pub fn change_m(&self, number: usize) -> f64 {
        if number + 1 >= self.count() {
            return f64::INFINITY;
        }
        let middle = self.range(number + 1).start + self.overlap / 2;
        self.first_m + middle as f64 * SAMPLE_STEP_M
    }

    /// Makes a stretch in the place of what `into` holds; false, and samples that are worth
    /// nothing, where `goes_on` became false.
    pub fn make(&self, number: usize, into: &mut Samples, goes_on: &dyn Fn() -> bool) -> bool {
        let track = (self.first_m, self.total);
        make(&self.band, track, self.range(number), into, goes_on)
    }
}

#[cfg(test)]
mod tests {
    use super::super::random::aar6;
    use super::*;

    const BAND: Band = Band { seed: 7, shortest: 1.0, longest: 100.0, scale: 1.0 };

    fn made(stretches: &Stretches, number: usize) -> Samples {
        let mut samples = Samples::default();
        assert!(stretches.make(number, &mut samples, &|| true));
        samples
    }

    #[test]
    fn every_sample_of_a_stretch_has_the_bits_of_the_track_as_a_whole() {
        let whole = aar6(&BAND, 0.0, 1000.0);
        let stretches = Stretches::new(BAND, (0.0, 1000.0), 9.0).of_samples(1024);
        assert_eq!((stretches.overlap, stretches.length, stretches.count()), (512, 1024, 19));
        // One buffer for all of them, as a run has it.
        let mut samples = Samples::default();
        for number in 0..stretches.count() {
            assert!(stretches.make(number, &mut samples, &|| true));
            let range = stretches.range(number);
            assert_eq!(samples.before, range.start);
            assert_eq!(samples.before + samples.samples.len() + samples.behind, 10_004);
            for (made, whole) in samples.samples.iter().zip(&whole.samples[range]) {
                let bits = |s: &firmware_core::track::IrregularitySample| {
                    [s.vertical_m, s.alignment_m, s.cross_level_m, s.gauge_m].map(f64::to_bits)
                };
                assert_eq!(bits(made), bits(whole));
            }
        }
        assert_eq!(samples.behind, 0);
        for place in (0..10_004).chain([20_000]) {
            let range = stretches.range(stretches.number_at(place));
            assert!(range.contains(&place.min(10_003)), "{place}");
        }
        assert_eq!(made(&Stretches::new(BAND, (0.0, 1000.0), 9.0), 0), whole);
    }

    #[test]
    fn where_the_stretch_changes_both_give_the_same_bits_all_along_the_vehicle() {
        let stretches = Stretches::new(BAND, (0.0, 500.0), 9.0).of_samples(1024);
        for number in 0..stretches.count() - 1 {
            let (now, next) = (made(&stretches, number), made(&stretches, number + 1));
            let at_m = stretches.change_m(number);
            // From the rearmost wheel to the foremost, which goes on to the end of the cycle.
            for n in -95..=95 {
                let distance_m = at_m + f64::from(n) * 0.1003;
                let irregularity = now.view().at(distance_m);
                assert_eq!(irregularity, next.view().at(distance_m), "{distance_m}");
                assert_ne!(irregularity.alignment_m, 0.0);
            }
        }
        assert_eq!(stretches.change_m(stretches.count() - 1), f64::INFINITY);
    }

    #[test]
    fn a_vehicle_of_any_length_fits_into_the_overlap() {
        for reach_m in [0.0, 9.0, 40.0, 1000.0] {
            let stretches = Stretches::new(BAND, (0.0, 4e6), reach_m);
            let half_m = 0.5 * stretches.overlap as f64 * SAMPLE_STEP_M;
            assert!(half_m >= reach_m + MARGIN_M - SAMPLE_STEP_M, "{reach_m}");
            assert!(stretches.overlap < stretches.length / 10);
        }
    }
}
