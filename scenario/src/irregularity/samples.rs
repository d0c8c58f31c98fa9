//! Samples of irregularity along a track, or along a stretch of it.

use firmware_core::track::{Irregularity, IrregularitySample};

/// Up to here the track is perfect (m): there the vehicle starts, in equilibrium, on all its
/// wheels.
pub const PERFECT_M: f64 = 30.0;

/// Over this distance behind it, or behind the first sample, the irregularity fades in (m).
pub const FADE_IN_M: f64 = 30.0;

/// Samples along the track.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Samples {
    /// The samples.
    pub samples: Vec<IrregularitySample>,
    /// Samples of the whole track before the first of these.
    pub before: usize,
    /// Samples of the whole track behind the last of these.
    pub behind: usize,
    /// Distance of the whole track's first sample (m).
    pub first_m: f64,
    /// Distance between samples (m).
    pub step_m: f64,
}

impl Samples {
    /// The samples as a step sees them.
    pub fn view(&self) -> Irregularity<'_> {
        Irregularity {
            samples: &self.samples,
            before: self.before,
            behind: self.behind,
            first_m: self.first_m,
            step_m: self.step_m,
        }
    }

    /// Lets the irregularity grow smoothly out of perfect track: a wheel that started on a rail
    /// some millimetres off would be thrown by its contact.
    pub(super) fn fade_in(&mut self) {
        let from_m = self.first_m.max(PERFECT_M);
        self.weight(|distance_m| {
            let t = ((distance_m - from_m) / FADE_IN_M).clamp(0.0, 1.0);
            t * t * t * (10.0 + t * (6.0 * t - 15.0))
        });
    }

    /// All channels times a weight that depends on distance (m).
    #[must_use]
    pub fn weighted(mut self, weight: impl Fn(f64) -> f64) -> Self {
        self.weight(weight);
        self
    }

    fn weight(&mut self, weight: impl Fn(f64) -> f64) {
        for (index, sample) in (self.before..).zip(&mut self.samples) {
            let weight = weight(self.first_m + index as f64 * self.step_m);
            sample.vertical_m *= weight;
            sample.alignment_m *= weight;
            sample.cross_level_m *= weight;
            sample.gauge_m *= weight;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_measured_record_that_begins_far_out_fades_in_from_its_first_sample_on() {
        let mut far = Samples {
            samples: vec![IrregularitySample { gauge_m: 1e-3, ..Default::default() }; 101],
            first_m: 500.0,
            step_m: 0.5,
            ..Samples::default()
        };
        far.fade_in();
        assert_eq!(far.samples[0].gauge_m, 0.0);
        assert!((far.samples[30].gauge_m - 0.5e-3).abs() < 1e-15);
        assert_eq!(far.samples[60].gauge_m, 1e-3);
    }
}
