//! Tracks of stability studies: some irregular track to set the vehicle off, and perfect track behind
//! it on which it either comes to rest or does not.

use firmware_core::track::{Irregularity, Layout, Track};
use scenario::irregularity::{Band, Samples, aar6};

/// Over this distance the irregularity fades out (m).
const FADE_OUT_M: f64 = 10.0;

/// Irregular track that ends.
#[derive(Debug, Clone, PartialEq)]
pub struct RoughStart {
    samples: Samples,
}

impl RoughStart {
    /// American class 6 from the beginning up to a distance, perfect track behind it.
    pub fn new(band: &Band, length_m: f64) -> Self {
        let mut samples = aar6(band, 0.0, length_m);
        let (first_m, step_m) = (samples.first_m, samples.step_m);
        for (index, sample) in samples.samples.iter_mut().enumerate() {
            let left_m = length_m - first_m - index as f64 * step_m;
            let share = (left_m / FADE_OUT_M).clamp(0.0, 1.0);
            // Smooth in its slope at both ends.
            let weight = share * share * (3.0 - 2.0 * share);
            sample.vertical_m *= weight;
            sample.alignment_m *= weight;
            sample.cross_level_m *= weight;
            sample.gauge_m *= weight;
        }
        Self { samples }
    }

    /// The track as a step sees it.
    pub fn view(&self) -> Track<'_> {
        let Samples { samples, first_m, step_m } = &self.samples;
        Track {
            layout: Layout::tangent(),
            irregularity: Irregularity { samples, first_m: *first_m, step_m: *step_m },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_rough_at_first_and_ends_without_a_step() {
        let band = Band { seed: 3, shortest: 1.0, longest: 100.0, scale: 1.0 };
        let start = RoughStart::new(&band, 300.0);
        let track = start.view();
        let alignment = |m: f64| track.irregularity.at(m).alignment_m;
        let whole = aar6(&band, 0.0, 300.0);
        // Up to the fade it is the usual track.
        assert_eq!(alignment(200.0), whole.samples[2000].alignment_m);
        let steps = (2000..3200).map(|n| f64::from(n) * 0.1);
        let steepest = steps.map(|m| (alignment(m + 0.1) - alignment(m)).abs()).fold(0.0, f64::max);
        assert!(steepest < 0.5e-3, "{steepest}");
        assert_eq!(alignment(300.2), 0.0);
        assert_eq!(alignment(1000.0), 0.0);
    }
}
