//! What a laboratory hands over: one recorded test.

use measurement::mapping::{Companion, Extension};
use measurement::{Measurement, MeasurementError, Series};
use std::io::{self, Write};

/// One test as it was recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct RawRecord {
    /// Name of the test.
    pub name: String,
    /// It is meant to test a model, not to fit it.
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
    /// Oil temperature at the end, degrees Celsius: that at which the next test starts.
    pub end_degc: f64,
    /// Steps that the simulation could not solve as it should; none is usual.
    pub doubtful_steps: u32,
}

impl RawRecord {
    /// The record alone as a measurement, ready for a model: as if it had been written and read
    /// again.
    ///
    /// # Errors
    /// What makes a record unfit, such as too few samples.
    pub fn measurement(&self) -> Result<Measurement, MeasurementError> {
        Measurement::from_series(self.series())
    }

    /// Its force stays at its extreme while the damper moves
    /// ([`measurement::is_flat_but_for_rounding`]).
    pub fn is_flat_but_for_rounding(&self) -> bool {
        measurement::is_flat_but_for_rounding(&self.series())
    }

    pub(super) fn series(&self) -> Series {
        let (x, force) = (self.displacement_m.clone(), self.force_n.clone());
        let mut series = Series::sampled(&self.name, self.rate_hz, x, force);
        series.temperature_degc.clone_from(&self.temperature_degc);
        series
    }

    /// Name of the record's CSV file.
    pub fn csv_name(&self) -> String {
        format!("{}.csv", self.name)
    }

    /// Writes the record as this project's CSV: names in line 1, then a line per sample. What the
    /// file cannot say about itself is in its [`companion`](Self::companion).
    ///
    /// # Errors
    /// The error of the writer.
    pub fn write_csv(&self, to: &mut dyn Write) -> io::Result<()> {
        debug_assert!(self.is_complete(), "{}: channels of different length", self.name);
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

    /// The mapping that goes next to the CSV file.
    pub fn companion(&self, specimen: &str) -> Companion {
        Companion {
            specimen: Some(specimen.to_owned()),
            notes: Vec::new(),
            extension: Extension::Positive,
            temperature: self.temperature_degc.is_some(),
        }
    }

    /// Every channel has a value for every time stamp.
    fn is_complete(&self) -> bool {
        let count = self.time_s.len();
        let channels = [Some(&self.displacement_m), Some(&self.force_n)];
        let mut channels = channels.into_iter().chain([self.temperature_degc.as_ref()]).flatten();
        channels.all(|channel| channel.len() == count)
    }
}
