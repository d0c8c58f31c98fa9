//! From a specimen and a test to a record, and from a list of tests to a visit.

use super::protocol::Test;
use super::raw_record::RawRecord;
use super::sensors::Sensors;
use crate::grid::Grid;
use crate::specimen::{Load, Specimen};
use firmware_core::damper::effects::temperature_fade::AMBIENT_DEGC;
use measurement::{Measurement, MeasurementError};
use signal::random::Random;
use std::sync::atomic::AtomicBool;

/// Temperature of the laboratory, degrees Celsius: that at which nominal numbers hold.
pub const LABORATORY_DEGC: f64 = AMBIENT_DEGC;

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
    let never = AtomicBool::new(false);
    recorded(specimen, test, sensors, Conditions { seed, start_degc, stop: &never })
}

/// Records a list of tests; the oil of each test starts at the temperature at which the one before
/// ended. (A damper of the core without a thermometer computes its own temperature and starts every
/// test cold.)
pub fn visit(
    specimen: &dyn Specimen,
    tests: &[Test],
    sensors: &Sensors,
    seed: u64,
) -> Vec<RawRecord> {
    visit_until(&AtomicBool::new(false), specimen, tests, sensors, seed, &mut |_| {})
}

/// The same, until `stop` is set: the tests that were recorded to their end. `begins` is called
/// with the number of every test as it begins.
pub fn visit_until(
    stop: &AtomicBool,
    specimen: &dyn Specimen,
    tests: &[Test],
    sensors: &Sensors,
    seed: u64,
    begins: &mut dyn FnMut(usize),
) -> Vec<RawRecord> {
    let mut start_degc = LABORATORY_DEGC;
    let mut records = Vec::with_capacity(tests.len());
    for (index, test) in tests.iter().enumerate() {
        begins(index);
        let seed = Random::seed_of(seed, index as u64);
        let record = recorded(specimen, test, sensors, Conditions { seed, start_degc, stop });
        // The flag may have cut this test short.
        if stop.load(std::sync::atomic::Ordering::Relaxed) {
            break;
        }
        start_degc = record.end_degc;
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

/// What one test depends on besides specimen, motion and sensors.
#[derive(Clone, Copy)]
struct Conditions<'a> {
    seed: u64,
    start_degc: f64,
    stop: &'a AtomicBool,
}

fn recorded(
    specimen: &dyn Specimen,
    test: &Test,
    sensors: &Sensors,
    Conditions { seed, start_degc, stop }: Conditions<'_>,
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
        stop,
    };
    let response = specimen.respond(&load);
    debug_assert!(
        load.is_stopped() || response.is_complete(grid.steps),
        "a specimen answers every step"
    );
    let fine_m: Vec<f64> = (0..response.force_n.len()).map(|step| load.at(step).0).collect();
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

#[cfg(test)]
#[path = "recording_tests.rs"]
mod tests;
