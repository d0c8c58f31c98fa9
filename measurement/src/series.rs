//! One test as it was sampled: SI values and the lines that they come from.

use crate::error::MeasurementError;
use crate::layout::Extension;
use std::path::PathBuf;

/// Readings of one test in SI units. Whatever can fill one, a file or the log of a bus, can become
/// a [`Measurement`](crate::Measurement).
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name of the test.
    pub name: String,
    /// The file it comes from.
    pub file: PathBuf,
    /// Line of every sample in it.
    pub lines: Vec<usize>,
    /// Time stamps, s.
    pub time_s: Vec<f64>,
    /// Size of the last digit of every time stamp, s; empty where rounding does not matter.
    pub time_resolution_s: Vec<f64>,
    /// Displacement, m; where only the velocity was recorded, a first integral of it.
    pub displacement_m: Vec<f64>,
    /// Force, N.
    pub force_n: Vec<f64>,
    /// Velocity, m/s, where a column holds it.
    pub velocity_m_per_s: Option<Vec<f64>>,
    /// Temperature, degrees Celsius, where a column holds it.
    pub temperature_degc: Option<Vec<f64>>,
    /// Only the velocity was recorded: the displacement is its integral.
    pub is_integrated: bool,
    /// Which sign means extension.
    pub extension: Extension,
    /// What was repaired so far, each a line.
    pub repairs: Vec<String>,
    /// Names of the columns of time, displacement and force in the file, quoted.
    pub columns: [String; 3],
}

impl Series {
    /// A series without a file: samples at a constant rate, by this project's names and signs.
    pub fn sampled(name: &str, rate_hz: f64, displacement_m: Vec<f64>, force_n: Vec<f64>) -> Self {
        debug_assert_eq!(displacement_m.len(), force_n.len(), "one force per displacement");
        let count = displacement_m.len();
        Self {
            name: name.to_owned(),
            file: PathBuf::from(name),
            lines: (1..=count).collect(),
            time_s: (0..count).map(|n| n as f64 / rate_hz).collect(),
            time_resolution_s: Vec::new(),
            displacement_m,
            force_n,
            velocity_m_per_s: None,
            temperature_degc: None,
            is_integrated: false,
            extension: Extension::Positive,
            repairs: Vec::new(),
            columns: ["time_s", "displacement_m", "force_n"].map(str::to_owned),
        }
    }

    /// Turns the signs where negative means extension.
    pub(crate) fn turn_to_extension(&mut self) {
        if self.extension != Extension::Negative {
            return;
        }
        let turned = [Some(&mut self.displacement_m), Some(&mut self.force_n)];
        for channel in turned.into_iter().chain([self.velocity_m_per_s.as_mut()]).flatten() {
            for value in channel {
                *value = -*value;
            }
        }
    }

    /// All values that change with time.
    pub(crate) fn channels_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        [&mut self.displacement_m, &mut self.force_n]
            .into_iter()
            .chain(self.velocity_m_per_s.as_mut())
            .chain(self.temperature_degc.as_mut())
    }

    /// Every channel has a value for every time stamp.
    pub(crate) fn is_complete(&self) -> bool {
        let count = self.time_s.len();
        let optional = [&self.velocity_m_per_s, &self.temperature_degc];
        let channels = [&self.displacement_m, &self.force_n].into_iter();
        channels.chain(optional.into_iter().flatten()).all(|channel| channel.len() == count)
            && self.lines.len() == count
    }

    /// Line of a sample.
    pub(crate) fn line(&self, sample: usize) -> usize {
        debug_assert!(sample < self.lines.len(), "no sample {sample}");
        self.lines.get(sample).copied().unwrap_or(0)
    }

    /// Lines of the first few of many samples, for a message.
    pub(crate) fn lines_of(&self, samples: impl IntoIterator<Item = usize>) -> String {
        let lines: Vec<usize> = samples.into_iter().map(|sample| self.line(sample)).collect();
        let mut text: Vec<String> = lines.iter().take(5).map(usize::to_string).collect();
        if lines.len() > 5 {
            text.push(format!("... {}", lines.last().copied().unwrap_or(0)));
        }
        text.join(", ")
    }

    /// An error of this test as a whole.
    pub(crate) fn error(&self, found: String, expected: String) -> MeasurementError {
        let stem = self.file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        if stem.as_deref() == Some(self.name.as_str()) {
            return MeasurementError::File { file: self.file.clone(), found, expected };
        }
        MeasurementError::Test { file: self.file.clone(), test: self.name.clone(), found, expected }
    }

    /// An error of the time stamp of a sample.
    pub(crate) fn error_of_time(
        &self,
        sample: usize,
        found: String,
        expected: String,
    ) -> MeasurementError {
        self.error_of(sample, &self.columns[0], found, expected)
    }

    /// An error of one reading.
    pub(crate) fn error_of(
        &self,
        sample: usize,
        column: &str,
        found: String,
        expected: String,
    ) -> MeasurementError {
        MeasurementError::Cell {
            file: self.file.clone(),
            row: self.line(sample),
            column: column.to_owned(),
            found,
            expected,
        }
    }
}
