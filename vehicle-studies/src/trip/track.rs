//! Tracks of studies.
//!
//! Stability studies run on some irregular track that sets the vehicle off, and perfect track
//! behind it on which it either comes to rest or does not. Studies of ride and curving run on the
//! irregularity of the scenario from end to end: random with seeds of their own, or the measured
//! one.

use firmware_core::track::Layout;
use scenario::irregularity::{Band, aar6};
use scenario::run::Run;
use scenario::track::OwnedTrack;
use serde::{Deserialize, Serialize};

/// Over this distance the irregularity fades out (m).
const FADE_OUT_M: f64 = 10.0;

/// American class 6 from the beginning up to a distance, perfect track behind it.
pub fn rough_start(band: &Band, length_m: f64) -> OwnedTrack {
    debug_assert!(length_m >= FADE_OUT_M, "{length_m} m of irregularity");
    let samples = aar6(band, 0.0, length_m).weighted(|distance_m| {
        let share = ((length_m - distance_m) / FADE_OUT_M).clamp(0.0, 1.0);
        // Smooth in its slope at both ends.
        share * share * (3.0 - 2.0 * share)
    });
    OwnedTrack { layout: Layout::tangent(), samples }
}

/// What a study's tracks are like.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Roughness {
    /// `class 6`, `measured` or `none`.
    pub irregularity: String,
    /// Seeds of random tracks; none of others, of which there is one.
    pub seeds: Vec<u64>,
    /// Shortest and longest wavelength of random irregularity (m).
    pub wavelengths_m: Option<[f64; 2]>,
    /// Factor on its amplitudes.
    pub scale: Option<f64>,
}

impl Roughness {
    /// That of a scenario, with other seeds where it is random.
    pub fn of(run: &Run, seeds: &[u64]) -> Self {
        match &run.band {
            Some(band) => Self::random(band, seeds),
            None => Self {
                irregularity: match run.track.samples.samples.as_slice() {
                    [] => "none",
                    [..] => "measured",
                }
                .to_owned(),
                seeds: Vec::new(),
                wavelengths_m: None,
                scale: None,
            },
        }
    }

    /// American class 6 with wavelengths and scale of a band.
    pub fn random(band: &Band, seeds: &[u64]) -> Self {
        Self {
            irregularity: "class 6".to_owned(),
            seeds: seeds.to_vec(),
            wavelengths_m: Some([band.shortest, band.longest]),
            scale: Some(band.scale),
        }
    }

    /// A track for every seed, or the one there is: in a layout, random irregularity up to a
    /// distance (m).
    pub fn tracks(&self, run: &Run, layout: &Layout, end_m: f64) -> Vec<OwnedTrack> {
        let (Some([shortest, longest]), Some(scale)) = (self.wavelengths_m, self.scale) else {
            return vec![OwnedTrack { layout: layout.clone(), samples: run.track.samples.clone() }];
        };
        let track = |seed: &u64| OwnedTrack {
            layout: layout.clone(),
            samples: aar6(&Band { seed: *seed, shortest, longest, scale }, 0.0, end_m),
        };
        self.seeds.iter().map(track).collect()
    }

    /// In words.
    pub fn in_words(&self) -> String {
        match (self.wavelengths_m, self.scale) {
            (Some([shortest, longest]), Some(scale)) => {
                let seeds = crate::over_seeds::seeds_in_words(&self.seeds);
                let scaled = if scale == 1.0 { String::new() } else { format!(" times {scale}") };
                format!(
                    "class-6 track{scaled}, wavelengths {shortest} to {longest} m, seeds {seeds}"
                )
            }
            _ if self.irregularity == "measured" => "the measured track of the scenario".to_owned(),
            _ => "perfect track".to_owned(),
        }
    }
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
