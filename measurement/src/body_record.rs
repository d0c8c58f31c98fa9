//! Records of a body on a damper: the force on it is the input, its motion the output.
//!
//! The samples are taken as they are: no repair of the force, no smoothing of the displacement, no
//! check of signs, because a body may be driven by any force and move any way. Only the clock is
//! checked.
//!
//! ```toml
//! sample_rate_hz = 750.0
//! [on_mass]
//! inter_sample = "band-limited"  # the force between samples: band-limited | hold
//! start = "periodic"             # before the first sample: rest | moving | periodic
//! period_samples = 8192
//! [acceleration]                 # instead of a displacement
//! column = "a_g"
//! unit = "g"
//! ```

pub use crate::drive::{BodyStart, InterSample, OnMass};

use crate::clock;
use crate::columns;
use crate::error::MeasurementError;
use crate::layout::OptionalReading;
use crate::read::MappingChoice;
use crate::table::Table;
use crate::text::Text;
use std::path::{Path, PathBuf};

/// Fewest samples of a record.
const FEWEST: usize = 64;

/// What is measured of the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// Displacement, m.
    Displacement,
    /// Acceleration, m/s2.
    Acceleration,
}

impl Output {
    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Displacement => "m",
            Self::Acceleration => "m/s2",
        }
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Acceleration => "acceleration",
        }
    }
}

/// One record of a body, as it was sampled.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyRecord {
    /// Name of the test.
    pub name: String,
    /// The file it comes from.
    pub file: PathBuf,
    /// Time from sample to sample, s.
    pub step_s: f64,
    /// Force on the body, N.
    pub force_n: Vec<f64>,
    /// What is measured of its motion.
    pub output: Output,
    /// The motion, in the unit of the output.
    pub motion: Vec<f64>,
    /// How it was driven.
    pub drive: OnMass,
    /// What was repaired of its clock, each a line.
    pub repairs: Vec<String>,
}

/// Reads all records of files, in the order given, with names that no two of them share.
///
/// # Errors
/// The first thing that does not fit, in one line.
pub fn read_body_records(
    paths: &[PathBuf],
    mapping: Option<&Path>,
) -> Result<Vec<BodyRecord>, MeasurementError> {
    let choice = MappingChoice::load(mapping)?;
    let mut records: Vec<BodyRecord> = Vec::new();
    for path in paths {
        let text = Text::read(path)?;
        let (mut layout, _) = choice.layout(path, &text, true)?;
        let mut output = Output::Displacement;
        if let Some(acceleration) = layout.acceleration.take() {
            output = Output::Acceleration;
            // Its channel of the series has no other use here.
            layout.displacement = OptionalReading { reading: acceleration, required: true };
        }
        let mut tests = Vec::new();
        for table in Table::parse(path, &text, &layout)? {
            tests.extend(columns::tests_of(&table, &layout)?);
        }
        for mut series in tests {
            let samples = series.time_s.len();
            if samples < FEWEST {
                let expected = format!("{FEWEST} or more");
                return Err(series.error(format!("{samples} samples"), expected));
            }
            let step_s = clock::make_uniform(&mut series)?;
            series.turn_to_extension();
            if series.force_n.iter().all(|force| *force == 0.0) {
                let expected = "the force on the body: without it no mass can be found, only \
                    ratios (in a drop tower it is the weight)";
                return Err(series.error("a force of zero".to_owned(), expected.to_owned()));
            }
            let taken = |name: &str| records.iter().any(|known| known.name == name);
            let mut name = series.name.clone();
            let mut number = 1;
            while taken(&name) {
                number += 1;
                name = format!("{}-{number}", series.name);
            }
            let drive = layout.on_mass;
            if let Some(length) = drive.period_samples.filter(|length| *length > samples) {
                let found = format!("{samples} samples");
                return Err(series.error(found, format!("period_samples = {length} or more")));
            }
            records.push(BodyRecord {
                name,
                file: series.file,
                step_s,
                force_n: series.force_n,
                output,
                motion: series.displacement_m,
                drive,
                repairs: series.repairs,
            });
        }
    }
    Ok(records)
}
