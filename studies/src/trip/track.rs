//! Tracks of stability studies: some irregular track to set the vehicle off, and perfect track behind
//! it on which it either comes to rest or does not.

use firmware_core::track::Layout;
use scenario::irregularity::{Band, aar6};
use scenario::track::OwnedTrack;

/// Over this distance the irregularity fades out (m).
const FADE_OUT_M: f64 = 10.0;

/// American class 6 from the beginning up to a distance, perfect track behind it.
pub fn rough_start(band: &Band, length_m: f64) -> OwnedTrack {
    let samples = aar6(band, 0.0, length_m).weighted(|distance_m| {
        let share = ((length_m - distance_m) / FADE_OUT_M).clamp(0.0, 1.0);
        // Smooth in its slope at both ends.
        share * share * (3.0 - 2.0 * share)
    });
    OwnedTrack { layout: Layout::tangent(), samples }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_rough_at_first_and_ends_without_a_step() {
        let band = Band { seed: 3, shortest: 1.0, longest: 100.0, scale: 1.0 };
        let start = rough_start(&band, 300.0);
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
