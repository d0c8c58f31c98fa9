//! Gain and offset of a load cell from forces that are known.
//!
//! ```text
//! F = g (R - o)          F: known force, R: what the load cell shows
//! ```
//! A straight line by least squares. Its error is the larger one of two: that of the readings, each
//! of which has a standard error of its own, and from three readings on that of the points about
//! the line. One reading gives the gain alone, with an offset of zero. Limit: a dead weight hangs
//! at rest, so that nothing dynamic of the load cell shows.

use crate::run::MeasuredTest;
use serde::{Deserialize, Serialize};

/// Samples of a block: a tenth of a second.
const BLOCK: usize = 100;

/// A reading of the load cell under a known force, as a calibration keeps it.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Reading {
    /// The known force (N).
    pub reference_n: f64,
    /// What the load cell shows (N).
    pub reading_n: f64,
    /// Standard error of the reading (N).
    pub error_n: f64,
}

/// Gain and offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GainFit {
    /// Force over reading.
    pub gain: f64,
    /// Its standard error.
    pub gain_error: f64,
    /// Reading without force (N).
    pub offset_n: f64,
    /// Its standard error (N); none of a single reading, which leaves the offset open.
    pub offset_error_n: Option<f64>,
}

impl Reading {
    /// The mean reading of a test at rest under a known force; none of fewer than two blocks of a
    /// tenth of a second, whose scatter is its error.
    pub fn of(test: &MeasuredTest, reference_n: f64) -> Option<Self> {
        Self::of_samples(&test.force_n, reference_n)
    }

    fn of_samples(force_n: &[f64], reference_n: f64) -> Option<Self> {
        let means: Vec<f64> = force_n
            .chunks_exact(BLOCK)
            .map(|block| block.iter().sum::<f64>() / BLOCK as f64)
            .collect();
        if means.len() < 2 {
            return None;
        }
        let count = means.len() as f64;
        let reading_n = means.iter().sum::<f64>() / count;
        let squares: f64 = means.iter().map(|mean| (mean - reading_n).powi(2)).sum();
        Some(Self { reference_n, reading_n, error_n: (squares / (count - 1.0) / count).sqrt() })
    }
}

impl GainFit {
    /// The line through these readings; none where they do not determine it.
    pub fn of(readings: &[Reading]) -> Option<Self> {
        if let [only] = readings {
            let gain = only.reference_n / only.reading_n;
            let gain_error = (gain * only.error_n / only.reading_n).abs();
            let fit = Self { gain, gain_error, offset_n: 0.0, offset_error_n: None };
            return (gain.is_finite() && gain > 0.0).then_some(fit);
        }
        let count = readings.len() as f64;
        let mean = |of: fn(&Reading) -> f64| readings.iter().map(of).sum::<f64>() / count;
        let (mean_reading_n, mean_force_n) =
            (mean(|reading| reading.reading_n), mean(|reading| reading.reference_n));
        let spread: f64 =
            readings.iter().map(|reading| (reading.reading_n - mean_reading_n).powi(2)).sum();
        let along = |reading: &Reading| {
            (reading.reading_n - mean_reading_n) * (reading.reference_n - mean_force_n)
        };
        let gain = readings.iter().map(along).sum::<f64>() / spread;
        if !(gain.is_finite() && gain > 0.0) {
            return None;
        }
        let off = |reading: &Reading| {
            reading.reference_n - mean_force_n - gain * (reading.reading_n - mean_reading_n)
        };
        let of_readings = mean(|reading| reading.error_n * reading.error_n) * gain * gain;
        let of_line =
            readings.iter().map(|reading| off(reading).powi(2)).sum::<f64>() / (count - 2.0);
        let variance = if count > 2.0 { of_readings.max(of_line) } else { of_readings };
        let offset_n = mean_reading_n - mean_force_n / gain;
        // The line at no force, in readings.
        let away_n = mean_reading_n - offset_n;
        let offset_variance = variance * (1.0 / count + away_n * away_n / spread);
        Some(Self {
            gain,
            gain_error: (variance / spread).sqrt(),
            offset_n,
            offset_error_n: Some(offset_variance.sqrt() / gain),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(reference_n: f64, reading_n: f64) -> Reading {
        Reading { reference_n, reading_n, error_n: 1.0 }
    }

    #[test]
    fn readings_on_a_line_give_its_gain_and_offset() {
        // R = 0.98 F + 40 N.
        let readings = [0.0, 1000.0, 5000.0].map(|force_n| reading(force_n, 0.98 * force_n + 40.0));
        let fit = GainFit::of(&readings).unwrap();
        assert!((fit.gain - 1.0 / 0.98).abs() < 1e-12, "{fit:?}");
        assert!((fit.offset_n - 40.0).abs() < 1e-9, "{fit:?}");
        // Readings of 1 N about a line: the spread of three readings is 3.7 kN.
        let spread: f64 = [-2000.0_f64, -1000.0, 3000.0].map(|n| (0.98 * n).powi(2)).iter().sum();
        assert!((fit.gain_error - fit.gain / spread.sqrt()).abs() < 1e-12, "{fit:?}");
        // The same two without the third, and one alone, which has no offset.
        let two = GainFit::of(&readings[1..]).unwrap();
        assert!((two.offset_n - 40.0).abs() < 1e-9 && two.offset_error_n.is_some(), "{two:?}");
        let one = GainFit::of(&readings[2..]).unwrap();
        assert_eq!((one.gain, one.offset_error_n), (5000.0 / 4940.0, None));
        // The same force twice, and a load cell with the wrong sign.
        assert_eq!(GainFit::of(&[readings[1], readings[1]]), None);
        assert_eq!(GainFit::of(&[reading(1000.0, -1000.0)]), None);
    }

    #[test]
    fn a_point_off_the_line_counts_in_the_errors() {
        let readings = [(0.0, 0.0), (1000.0, 1030.0), (2000.0, 2000.0)];
        let fit = GainFit::of(&readings.map(|(force, read)| reading(force, read))).unwrap();
        // Residual of 20 N rms with one degree of freedom over a spread of 1.4 kN.
        assert!((1e-2..3e-2).contains(&fit.gain_error), "{fit:?}");
    }

    #[test]
    fn the_error_of_a_reading_is_that_of_its_blocks() {
        let samples: Vec<f64> =
            (0..400).map(|n| if (n / BLOCK).is_multiple_of(2) { 9.0 } else { 11.0 }).collect();
        let found = Reading::of_samples(&samples, 10.0).unwrap();
        assert_eq!(found.reading_n, 10.0);
        assert!((found.error_n - (4.0_f64 / 3.0).sqrt() / 2.0).abs() < 1e-12, "{found:?}");
        assert_eq!(Reading::of_samples(&samples[..150], 10.0), None);
    }
}
