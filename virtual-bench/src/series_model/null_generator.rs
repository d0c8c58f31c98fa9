//! The series model as a specimen.

use super::SeriesModel;
use super::outside::{Drive, Outside};
use crate::heat::temperatures_degc;
use crate::specimen::{Load, Response, Specimen};
use firmware_core::damper::HeatBalance;

/// A series damper apart from the core's, with disturbances that no effect describes.
#[derive(Debug, Clone, PartialEq)]
pub struct NullGenerator {
    /// Its five numbers.
    pub model: SeriesModel,
    /// What is added.
    pub outside: Vec<Outside>,
}

impl Specimen for NullGenerator {
    fn longest_step_s(&self) -> f64 {
        20e-6
    }

    fn respond(&self, load: &Load<'_>) -> Response {
        let drive = Drive {
            displacement_m: &|t| load.mean_m + load.excitation.displacement_m(t),
            frequency_hz: load.excitation.frequency_hz(),
            start_m: 0.5 * load.start * self.model.clearance_2a_m,
            seed: load.seed,
        };
        let force_n = self.model.simulate_with(&self.outside, &drive, load.grid).force_n;
        let temperature_degc = temperatures_degc(HeatBalance::YAW_DAMPER, load, &force_n);
        Response { force_n, temperature_degc, doubtful_steps: 0 }
    }
}
