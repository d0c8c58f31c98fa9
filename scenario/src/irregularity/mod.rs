//! Track irregularity: random samples by the spectra of the SS9 study, or a measured file.
//!
//! The study's equations (1) and (2) (American class 6) are one-sided densities over spatial
//! frequency in rad/m:
//! ```text
//! Sv = Sa = 5.7613e-3 / (W^2 (W^2 + 0.6798))                  cm2/(rad/m)   vertical, alignment
//! Sc = Sg = 2.3045e-2 / ((W^2 + 0.6798) (W^2 + 0.1918))       cm2/(rad/m)   cross level, gauge
//! ```
//! Each channel is a sum of 600 cosines with random phase, one per band of equal ratio between the
//! longest and the shortest wavelength; a band's variance is the closed integral of the density, so
//! the variance is exact whatever the number of bands (`evidence/src/validation/irregularity.rs`).
//! The four channels are independent, from one seed. Either kind grows out of perfect track, on
//! which the vehicle starts in equilibrium.
//!
//! A long random track is made in [`Stretches`]; a measured one is held as a whole.

mod measured;
mod random;
mod samples;
mod stretches;

pub use random::{Band, SAMPLE_STEP_M, aar6, aar6_until, cross_variance_m2, vertical_variance_m2};
pub use samples::{FADE_IN_M, PERFECT_M, Samples};
pub use stretches::Stretches;

use crate::error::ScenarioError;
use crate::inputs::Inputs;
use crate::quantity::Quantity;
use crate::source::Source;
use measured::{covers, read_csv};
use serde::{Deserialize, Serialize};

/// Irregularity in a scenario file.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum IrregularityFile {
    /// Random, American class 6 by the study's spectra.
    Aar6 {
        /// Seed of the phases.
        seed: u64,
        /// Shortest wavelength.
        shortest_m: Quantity,
        /// Longest wavelength.
        longest_m: Quantity,
        /// Factor on all amplitudes.
        scale: Option<Quantity>,
    },
    /// Measured: a CSV with `distance_m` and any of `vertical_m`, `alignment_m`, `cross_level_m`,
    /// `gauge_m`.
    Csv {
        /// The file, relative to the scenario.
        path: String,
    },
}

impl IrregularityFile {
    /// Reads measured samples, which have to reach over a run between two distances; none where
    /// the irregularity is random.
    ///
    /// # Errors
    /// A file that does not fit.
    pub(crate) fn measured(
        &self,
        source: &Source,
        (from_m, to_m): (f64, f64),
        inputs: &mut Inputs,
    ) -> Result<Option<Samples>, ScenarioError> {
        let Self::Csv { path } = self else { return Ok(None) };
        let path = source.sibling(path);
        let samples = read_csv(&path, inputs)?;
        covers(&path, &samples, from_m + PERFECT_M, to_m)?;
        Ok(Some(samples))
    }

    /// What random irregularity is made from; none for a measured one.
    ///
    /// # Errors
    /// A band that is empty.
    pub fn band(&self, source: &Source) -> Result<Option<Band>, ScenarioError> {
        let Self::Aar6 { seed, shortest_m, longest_m, scale } = self else { return Ok(None) };
        let shortest = shortest_m.within(source, "shortest_m", 0.5, 500.0, "0.5 to 500 m")?;
        let longest = longest_m.within(
            source,
            "longest_m",
            1.001 * shortest,
            1000.0,
            "more than shortest_m and at most 1000 m",
        )?;
        let scale = match scale {
            Some(scale) => scale.not_negative(source, "scale")?,
            None => 1.0,
        };
        Ok(Some(Band { seed: *seed, shortest, longest, scale }))
    }
}
