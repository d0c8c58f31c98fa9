//! A visit to a damper bench that exists only as a model: from a specimen and a list of tests to the
//! records that a laboratory would hand over.
//!
//! ```text
//! protocol -> excitation x(t) -> specimen F(t), fine steps -> sensors -> RawRecord -> CSV
//! ```
//!
//! A [`Specimen`] is a damper of the core with any effects ([`Modelled`]), a series damper by an
//! integration of its own with disturbances that no effect describes ([`NullGenerator`]), or the full
//! hydraulic damper. [`record`] makes one test in memory, without files. Every random number comes
//! from the seed.
//!
//! ```
//! use virtual_bench::bench_visit::{self, NullGenerator, protocol, sensors::Sensors};
//! use virtual_bench::series_model::SeriesModel;
//! let model = SeriesModel {
//!     ce_n_s_per_m: 1e6, ke_n_per_m: 12.5e6, clearance_2a_m: 1e-3,
//!     f_relief_n: 15e3, c2_n_s_per_m: 60e3,
//! };
//! let damper = NullGenerator { model, outside: Vec::new() };
//! let sensors = Sensors::of_range(50e3, 0.1);
//! let record = bench_visit::record(&damper, &protocol::short()[0], &sensors, 7);
//! let peak_n = record.force_n.iter().fold(0.0f64, |most, force| most.max(force.abs()));
//! assert!((peak_n - 18.45e3).abs() < 0.3e3);
//! ```

pub mod excitation;
pub mod protocol;
pub mod random;
pub mod scaled;
pub mod sensors;
pub mod specimen;
pub mod test_list;

pub use specimen::{HeatBalance, Modelled, NullGenerator, Specimen};

use crate::series_model::Grid;
use firmware_core::damper::effects::temperature_fade::AMBIENT_DEGC;
use measurement::{Measurement, MeasurementError, Series};
use protocol::Test;
use random::Random;
use sensors::Sensors;
use specimen::Load;
use std::io::{self, Write};

/// Temperature of the laboratory, degrees Celsius: that at which nominal numbers hold.
pub const LABORATORY_DEGC: f64 = AMBIENT_DEGC;

/// One test as it was recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct RawRecord {
    /// Name of the test.
    pub name: String,
    /// It is meant to judge a model, not to fit it.
    pub test_only: bool,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Displacement as measured, m, positive in extension.
    pub displacement_m: Vec<f64>,
    /// Force as measured, N, positive in tension.
    pub force_n: Vec<f64>,
    /// Oil temperature as measured, degrees Celsius, where it is measured.
    pub temperature_degc: Option<Vec<f64>>,
    /// Oil temperature at the end, degrees Celsius, for the test that follows.
    pub end_degc: f64,
    /// Steps that the simulation could not solve as it should; none is usual.
    pub doubtful_steps: u32,
}

/// Records one test with the oil at the temperature of the laboratory.
pub fn record(specimen: &dyn Specimen, test: &Test, sensors: &Sensors, seed: u64) -> RawRecord {
    record_from(specimen, test, sensors, seed, LABORATORY_DEGC)
}

/// Records one test with the oil at a temperature.
pub fn record_from(
    specimen: &dyn Specimen,
    test: &Test,
    sensors: &Sensors,
    seed: u64,
    start_degc: f64,
) -> RawRecord {
    let substeps = libm::ceil(1.0 / (sensors.rate_hz * specimen.longest_step_s()) - 1e-9).max(1.0);
    // The filter needs room below half the rate of the fine steps.
    let substeps = (substeps as usize).max(if sensors.anti_alias_hz.is_some() { 4 } else { 1 });
    let samples = libm::floor(test.duration_s * sensors.rate_hz + 1e-9) as usize;
    let grid =
        Grid { step_s: 1.0 / (sensors.rate_hz * substeps as f64), steps: samples * substeps };
    let load = Load {
        excitation: &test.excitation,
        mean_m: test.mean_m,
        grid,
        // A joint rests anywhere in its clearance.
        start: Random::new(seed, 0).between(-1.0, 1.0),
        start_degc,
        ambient_degc: LABORATORY_DEGC,
        thermometer: sensors.temperature_noise_k.is_some(),
        seed,
    };
    let response = specimen.respond(&load);
    let fine_m: Vec<f64> = (0..=grid.steps).map(|step| load.at(step).0).collect();
    let mut displacement_m = sensors.sample(&fine_m, substeps);
    sensors.read_displacement(&mut displacement_m, seed);
    let mut force_n = sensors.sample(&response.force_n, substeps);
    sensors.read_force(&mut force_n, seed);
    let temperature_degc = sensors.temperature_noise_k.map(|noise_k| {
        let mut degc: Vec<f64> =
            response.temperature_degc.iter().step_by(substeps).copied().collect();
        Sensors::read_temperature(noise_k, &mut degc, seed);
        degc
    });
    RawRecord {
        name: test.name.clone(),
        test_only: test.test_only,
        rate_hz: sensors.rate_hz,
        time_s: (0..=samples).map(|sample| sample as f64 / sensors.rate_hz).collect(),
        displacement_m,
        force_n,
        temperature_degc,
        end_degc: response.temperature_degc.last().copied().unwrap_or(start_degc),
        doubtful_steps: response.doubtful_steps,
    }
}

/// Records a whole list, the oil of each test as warm as the one before has left it. (A damper of the
/// core without a thermometer reckons its own warmth and starts every test cold.)
pub fn visit(
    specimen: &dyn Specimen,
    tests: &[Test],
    sensors: &Sensors,
    seed: u64,
) -> Vec<RawRecord> {
    let mut degc = LABORATORY_DEGC;
    let mut records = Vec::with_capacity(tests.len());
    for (index, test) in tests.iter().enumerate() {
        let own_seed = Random::seed_of(seed, index as u64);
        let record = record_from(specimen, test, sensors, own_seed, degc);
        degc = record.end_degc;
        records.push(record);
    }
    records
}

/// The records of a visit as measurements, as if they had been written and read again together.
///
/// # Errors
/// What makes a record unfit, such as too few samples.
pub fn measurements(visit: &[RawRecord]) -> Result<Vec<Measurement>, MeasurementError> {
    Measurement::from_visit(visit.iter().map(RawRecord::series))
}

impl RawRecord {
    /// The record alone as a measurement, ready for a model: as if it had been written and read again.
    ///
    /// # Errors
    /// What makes a record unfit, such as too few samples.
    pub fn measurement(&self) -> Result<Measurement, MeasurementError> {
        Measurement::from_series(self.series())
    }

    /// Its force stays at its extreme while the damper moves ([`measurement::is_flat_but_for_rounding`]).
    pub fn is_flat_but_for_rounding(&self) -> bool {
        measurement::is_flat_but_for_rounding(&self.series())
    }

    fn series(&self) -> Series {
        let (x, force) = (self.displacement_m.clone(), self.force_n.clone());
        let mut series = Series::sampled(&self.name, self.rate_hz, x, force);
        series.temperature_degc.clone_from(&self.temperature_degc);
        series
    }

    /// Writes the record as the project's CSV.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write_csv(&self, to: &mut dyn Write) -> io::Result<()> {
        writeln!(to, "# extension: positive")?;
        write!(to, "time_s,displacement_m,force_n")?;
        writeln!(to, "{}", if self.temperature_degc.is_some() { ",temperature_degc" } else { "" })?;
        let motion = self.time_s.iter().zip(&self.displacement_m);
        for (row, ((time_s, displacement_m), force_n)) in motion.zip(&self.force_n).enumerate() {
            write!(to, "{time_s},{displacement_m:.9},{force_n:.3}")?;
            if let Some(degc) = self.temperature_degc.as_ref().and_then(|degc| degc.get(row)) {
                write!(to, ",{degc:.2}")?;
            }
            writeln!(to)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
