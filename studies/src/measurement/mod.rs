//! Measured records of a damper on a bench, ready for a model: one uniform clock, velocity and
//! acceleration beside the displacement, cycles marked.

mod motion;

use std::path::PathBuf;

/// One test: what the bench did to the damper, and the force it answered with.
///
/// All signals have one value per sample of a uniform clock. Displacement is positive in extension
/// where the direction is declared, force positive in tension; dissipated work is positive.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Name of the test: the file's stem, and the test within it where a file holds several.
    pub name: String,
    /// The file it comes from.
    pub file: PathBuf,
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Sampling period, s.
    pub step_s: f64,
    /// Displacement, m.
    pub displacement_m: Vec<f64>,
    /// Velocity, m/s, from the stated interpolant.
    pub velocity_m_per_s: Vec<f64>,
    /// Acceleration, m/s2, from the stated interpolant.
    pub acceleration_m_per_s2: Vec<f64>,
    /// Force, N.
    pub force_n: Vec<f64>,
    /// Temperature, degrees Celsius, where it was measured.
    pub temperature_degc: Option<Vec<f64>>,
    /// First sample of every whole cycle, and the end of the last; empty for a test without cycles.
    pub cycles: Vec<usize>,
    /// Samples at the beginning that no error counts.
    pub run_in: usize,
    /// It is known which side is extension.
    pub direction_declared: bool,
}
