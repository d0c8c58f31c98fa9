//! A test on a uniform clock: its signals, and parts of it.

use crate::sign::Agreement;
use crate::{interpolant, smoothing};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// One test: what the bench did to the damper, and the force with which it answered.
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
    /// Displacement as measured, m.
    pub displacement_m: Vec<f64>,
    /// Displacement without its noise, m: what drives a model.
    pub drive_m: Vec<f64>,
    /// Velocity, m/s, from the stated interpolant.
    pub velocity_m_per_s: Vec<f64>,
    /// Acceleration, m/s2, from the stated interpolant.
    pub acceleration_m_per_s2: Vec<f64>,
    /// Force, N.
    pub force_n: Vec<f64>,
    /// Temperature, degrees Celsius, where it was measured.
    pub temperature_degc: Option<Vec<f64>>,
    /// First sample of every whole cycle of equal size, and the end of the last; empty for a test
    /// without cycles. They are those of one run without a rest in it, the longest: two marks that
    /// follow each other enclose one cycle, three enclose two cycles of equal motion.
    pub cycles: Vec<usize>,
    /// The marks of every run of equal cycles, in the order of the record: a file that holds a run
    /// for each speed, with rests between them, has several. [`cycles`](Self::cycles) is one of
    /// them.
    pub runs: Vec<Vec<usize>>,
    /// Samples at the beginning that no error counts.
    pub run_in: usize,
    /// It is known which side is extension.
    pub direction_declared: bool,
    /// The force disagreed with the displacement in sign and was turned: which of the two was right
    /// is not known.
    pub force_turned: bool,
    /// What was repaired, or looks odd, each a line.
    pub repairs: Vec<String>,
    /// Effects that the laboratory's processing has destroyed, by catalogue name, and how.
    pub destroyed: BTreeMap<&'static str, String>,
    /// What was tested, if the mapping states it.
    pub specimen: Option<String>,
    /// Whether displacement and force, as recorded, agree in sign.
    pub(crate) agreement: Agreement,
}

impl Measurement {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.force_n.len()
    }

    /// True for a measurement without samples.
    pub fn is_empty(&self) -> bool {
        self.force_n.is_empty()
    }

    /// Sampling rate, Hz.
    pub fn rate_hz(&self) -> f64 {
        1.0 / self.step_s
    }

    /// Time of a sample, s.
    pub fn time_s(&self, sample: usize) -> f64 {
        self.start_s + sample as f64 * self.step_s
    }

    /// Frequency of a periodic test, Hz.
    pub fn frequency_hz(&self) -> Option<f64> {
        let span = self.cycles.last()? - self.cycles.first()?;
        let whole = self.cycles.len().checked_sub(1).filter(|whole| *whole > 0)?;
        Some(whole as f64 / (span as f64 * self.step_s))
    }

    /// Half the range of the displacement, over the whole cycles where there are any, m.
    pub fn amplitude_m(&self) -> f64 {
        let whole = match (self.cycles.first(), self.cycles.last()) {
            (Some(first), Some(last)) => self.displacement_m.get(*first..*last),
            _ => None,
        };
        let values = whole.unwrap_or(&self.displacement_m);
        signal::statistics::min_max(values).map_or(0.0, |(low, high)| 0.5 * (high - low))
    }

    /// Acceleration at a sample, m/s2.
    pub(crate) fn acceleration(&self, sample: usize) -> f64 {
        debug_assert!(sample < self.len(), "no sample {sample}");
        self.acceleration_m_per_s2.get(sample).copied().unwrap_or(0.0)
    }

    /// Displacement, m, and velocity, m/s, a share of the way from a sample to the next one: the
    /// cubic through both displacements with both velocities.
    #[inline]
    pub fn motion_between(&self, sample: usize, share: f64) -> (f64, f64) {
        debug_assert!(sample + 1 < self.len() && (0.0..=1.0).contains(&share), "{sample}, {share}");
        let end = |at: usize| (self.drive_m[at], self.velocity_m_per_s[at]);
        interpolant::between(end(sample), end(sample + 1), self.step_s, share)
    }

    /// The runs of a part of the record: where each mark is in it, if it is.
    fn runs_of(&self, place: impl Fn(usize) -> Option<usize>) -> Vec<Vec<usize>> {
        let kept = |marks: &Vec<usize>| marks.iter().filter_map(|at| place(*at)).collect();
        self.runs.iter().map(kept).filter(|marks: &Vec<usize>| marks.len() > 1).collect()
    }

    /// The record from a sample on; its own run-in is its first cycle, or a tenth.
    #[must_use]
    pub fn since(&self, start: usize) -> Self {
        let start = start.min(self.force_n.len());
        let cut = |values: &[f64]| values[start..].to_vec();
        let cycles: Vec<usize> =
            self.cycles.iter().filter(|at| **at >= start).map(|at| at - start).collect();
        let left = self.force_n.len() - start;
        let run_in = cycles.iter().copied().find(|at| *at > 0).unwrap_or(left / 10);
        Self {
            start_s: self.start_s + start as f64 * self.step_s,
            displacement_m: cut(&self.displacement_m),
            drive_m: cut(&self.drive_m),
            velocity_m_per_s: cut(&self.velocity_m_per_s),
            acceleration_m_per_s2: cut(&self.acceleration_m_per_s2),
            force_n: cut(&self.force_n),
            temperature_degc: self.temperature_degc.as_deref().map(cut),
            cycles,
            runs: self.runs_of(|at| at.checked_sub(start)),
            run_in,
            ..self.clone()
        }
    }

    /// The record up to, not with, a sample.
    #[must_use]
    pub fn until(&self, end: usize) -> Self {
        let end = end.min(self.force_n.len());
        let cut = |values: &[f64]| values[..end].to_vec();
        Self {
            displacement_m: cut(&self.displacement_m),
            drive_m: cut(&self.drive_m),
            velocity_m_per_s: cut(&self.velocity_m_per_s),
            acceleration_m_per_s2: cut(&self.acceleration_m_per_s2),
            force_n: cut(&self.force_n),
            temperature_degc: self.temperature_degc.as_deref().map(cut),
            cycles: self.cycles.iter().copied().filter(|at| *at <= end).collect(),
            runs: self.runs_of(|at| (at <= end).then_some(at)),
            ..self.clone()
        }
    }

    /// The same test with another displacement: smoothed and differentiated as a recorded one.
    ///
    /// # Panics
    /// In debug builds, where the displacement has another number of samples.
    #[must_use]
    pub fn with_displacement(&self, displacement_m: Vec<f64>) -> Self {
        debug_assert_eq!(displacement_m.len(), self.len(), "one displacement per sample");
        let drive_m = smoothing::smoothed(&displacement_m);
        let (velocity_m_per_s, acceleration_m_per_s2) =
            interpolant::derivatives(&drive_m, self.step_s);
        Self { displacement_m, drive_m, velocity_m_per_s, acceleration_m_per_s2, ..self.clone() }
    }

    /// The record with every `factor`-th sample.
    #[must_use]
    pub fn thinned(&self, factor: usize) -> Self {
        let factor = factor.max(1);
        let pick = |values: &[f64]| values.iter().step_by(factor).copied().collect();
        Self {
            step_s: self.step_s * factor as f64,
            displacement_m: pick(&self.displacement_m),
            drive_m: pick(&self.drive_m),
            velocity_m_per_s: pick(&self.velocity_m_per_s),
            acceleration_m_per_s2: pick(&self.acceleration_m_per_s2),
            force_n: pick(&self.force_n),
            temperature_degc: self.temperature_degc.as_deref().map(pick),
            cycles: self.cycles.iter().map(|at| at / factor).collect(),
            runs: self.runs_of(|at| Some(at / factor)),
            run_in: self.run_in.div_ceil(factor),
            ..self.clone()
        }
    }
}
