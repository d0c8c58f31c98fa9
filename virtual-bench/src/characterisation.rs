//! A visit with its figures: what `yawbench characterise` records and writes.
//!
//! ```text
//! damper, list of tests -> sensors whose ranges fit -> records -> laboratory figures
//! ```
//!
//! The ranges come from one recording of every test without noise, as a laboratory tries a damper
//! before it chooses its sensors.

use crate::bench_visit::protocol::{self, Test};
use crate::bench_visit::sensors::Sensors;
use crate::bench_visit::test_list::TestList;
use crate::bench_visit::{RawRecord, measurements, visit_until};
use crate::error::VisitError;
use crate::hydraulic::HydraulicDamper;
use crate::laboratory::{Laboratory, Limit};
use crate::modelled::Modelled;
use crate::specimen::Specimen;
use measurement::Measurement;
use scenario::damper::DamperFile;
use scenario::source::Source;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// A damper, its tests and the seed of everything random: what a visit needs.
pub struct Visit {
    /// The damper's file.
    file: PathBuf,
    origin: Origin,
    specimen: Box<dyn Specimen>,
    list: TestList,
    seed: u64,
}

/// Where records come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Origin {
    /// The damper model of the core.
    Model,
    /// The hydraulic damper.
    Physical,
    /// Files of a laboratory.
    Measured,
}

/// The records of a visit and their figures.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The tests that were recorded to their end.
    pub records: Vec<RawRecord>,
    /// What the damper is called in the records.
    pub specimen: String,
    /// The figures.
    pub file: LaboratoryFile,
}

/// `laboratory.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LaboratoryFile {
    format: u32,
    source: Origin,
    files: Vec<String>,
    seed: Option<u64>,
    /// The visit ended before its last test.
    interrupted: bool,
    sensors: Option<SensorFigures>,
    #[serde(flatten)]
    laboratory: Laboratory,
}

/// The sensors of a virtual visit, for the record.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct SensorFigures {
    rate_hz: f64,
    force_range_n: f64,
    force_noise_n: f64,
    force_bits: u32,
    displacement_range_m: f64,
    displacement_noise_m: f64,
    displacement_bits: u32,
    coloured_noise_n: f64,
    coloured_rho_per_ms: Option<f64>,
    anti_alias_hz: Option<f64>,
    temperature_noise_k: Option<f64>,
}

impl Visit {
    /// A visit of a damper model of the core.
    ///
    /// # Errors
    /// A model that does not fit.
    pub fn of_model(path: &Path, list: TestList, seed: u64) -> Result<Self, VisitError> {
        let damper = DamperFile::load_model(path)?.build(&Source::read(path)?)?;
        let specimen = Box::new(Modelled { damper });
        Ok(Self { file: path.to_owned(), origin: Origin::Model, specimen, list, seed })
    }

    /// A visit of a hydraulic damper.
    ///
    /// # Errors
    /// A damper that does not fit, or a test beyond its stroke.
    pub fn of_hydraulic(path: &Path, list: TestList, seed: u64) -> Result<Self, VisitError> {
        let damper = HydraulicDamper::load(path)?;
        for test in &list.tests {
            let reach_m = test.mean_m.abs() + test.excitation.reach().1;
            if reach_m > damper.half_stroke_m {
                return Err(VisitError::Reach {
                    file: path.to_owned(),
                    test: test.name.clone(),
                    reach_m,
                    half_stroke_m: damper.half_stroke_m,
                });
            }
        }
        let (specimen, file) = (Box::new(damper), path.to_owned());
        Ok(Self { file, origin: Origin::Physical, specimen, list, seed })
    }

    /// The tests.
    pub fn tests(&self) -> &[Test] {
        &self.list.tests
    }

    /// Records every test and computes the figures against the rows of a datasheet. When `stop` is
    /// set, the tests that are complete by then are what there is; `begins` is called with the
    /// number of every test as it begins.
    ///
    /// # Errors
    /// A record that is no test, such as one with too few samples.
    pub fn run(
        &self,
        datasheet: &[Limit],
        stop: &AtomicBool,
        begins: &mut dyn FnMut(usize),
    ) -> Result<Outcome, VisitError> {
        let sensors = self.sensors(stop, begins);
        let (specimen, tests) = (self.specimen.as_ref(), &self.list.tests);
        let records = visit_until(stop, specimen, tests, &sensors, self.seed, begins);
        debug_assert!(records.iter().zip(tests).all(|(record, test)| record.name == test.name));
        let file = LaboratoryFile {
            format: FORMAT,
            source: self.origin,
            files: vec![self.file.display().to_string()],
            seed: Some(self.seed),
            interrupted: records.len() < tests.len(),
            sensors: Some(SensorFigures::of(&sensors)),
            laboratory: Laboratory::of(&measurements(&records)?, datasheet),
        };
        let stem = self.file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        Ok(Outcome { records, specimen: stem.unwrap_or_default(), file })
    }

    /// Sensors whose ranges fit.
    fn sensors(&self, stop: &AtomicBool, begins: &mut dyn FnMut(usize)) -> Sensors {
        let exact = Sensors { temperature_noise_k: Some(0.0), ..Sensors::exact(1000.0) };
        let (specimen, tests) = (self.specimen.as_ref(), &self.list.tests);
        let trial = visit_until(stop, specimen, tests, &exact, 0, begins);
        let forces = trial.iter().flat_map(|record| &record.force_n);
        let peak_force_n = forces.fold(0.0, |most: f64, force| most.max(force.abs()));
        self.list.sensors.sensors(peak_force_n, protocol::reach(tests).1)
    }
}

/// Version of `laboratory.json`.
const FORMAT: u32 = 1;

impl LaboratoryFile {
    /// The figures of measured records.
    pub fn of_records(files: &[PathBuf], tests: &[Measurement], datasheet: &[Limit]) -> Self {
        Self {
            format: FORMAT,
            source: Origin::Measured,
            files: files.iter().map(|path| path.display().to_string()).collect(),
            seed: None,
            interrupted: false,
            sensors: None,
            laboratory: Laboratory::of(tests, datasheet),
        }
    }

    /// The visit ended before its last test.
    pub const fn is_interrupted(&self) -> bool {
        self.interrupted
    }
}

impl fmt::Display for LaboratoryFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.laboratory)?;
        if let (Some(sensors), Some(seed)) = (&self.sensors, self.seed) {
            let SensorFigures { rate_hz, force_range_n, force_noise_n, .. } = sensors;
            let (range_m, noise_um) =
                (sensors.displacement_range_m, sensors.displacement_noise_m * 1e6);
            writeln!(
                f,
                "\nvirtual visit, seed {seed}: {rate_hz} Hz, force +-{force_range_n} N with \
                 {force_noise_n} N rms of noise, displacement +-{range_m} m with {noise_um} um"
            )?;
        }
        if self.interrupted {
            writeln!(f, "interrupted: later tests were not recorded")?;
        }
        Ok(())
    }
}

impl SensorFigures {
    fn of(sensors: &Sensors) -> Self {
        Self {
            rate_hz: sensors.rate_hz,
            force_range_n: sensors.force.range,
            force_noise_n: sensors.force.noise,
            force_bits: sensors.force.bits,
            displacement_range_m: sensors.displacement.range,
            displacement_noise_m: sensors.displacement.noise,
            displacement_bits: sensors.displacement.bits,
            coloured_noise_n: sensors.coloured.map_or(0.0, |noise| noise.level_n),
            coloured_rho_per_ms: sensors.coloured.map(|noise| noise.rho_per_ms),
            anti_alias_hz: sensors.anti_alias_hz,
            temperature_noise_k: sensors.temperature_noise_k,
        }
    }
}
