//! Measured records of a damper on a bench, ready for a model: one uniform clock, velocity and
//! acceleration beside the displacement, cycles marked.
//!
//! [`read_tests`] reads CSV files, with a [`mapping`] where their columns are another
//! laboratory's. Each test passes the [`checks`], comes to a uniform [`clock`], loses the noise of its displacement
//! ([`smoothing`]), gets velocity and acceleration from the [`interpolant`] and its [`cycles`]; all of a visit agree
//! on their sign (`sign`); [`noise`] says what no model can explain.
//! What is wrong is one line with file, row, column, found and expected ([`error`]); what was mended is a
//! line in [`Measurement::repairs`]. Nothing is silently dropped.

pub mod checks;
pub mod clock;
pub mod cycles;
pub mod error;
pub mod interpolant;
pub mod mapping;
mod motion;
pub mod noise;
pub mod series;
mod sign;
pub mod smoothing;
pub mod table;
#[cfg(test)]
mod tests;
pub mod unit;

pub use error::MeasurementError;
pub use series::Series;

use mapping::{Extension, Layout, Mapping};
use sign::Agreement;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

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
    /// First sample of every whole cycle, and the end of the last; empty for a test without cycles.
    pub cycles: Vec<usize>,
    /// Samples at the beginning that no error counts.
    pub run_in: usize,
    /// It is known which side is extension.
    pub direction_declared: bool,
    /// The force disagreed with the displacement in sign and was turned: which of the two was right is not known.
    pub force_turned: bool,
    /// What was mended, or looks odd, each a line.
    pub repairs: Vec<String>,
    /// Effects that the laboratory's processing has destroyed, by catalogue name, and how.
    pub destroyed: BTreeMap<&'static str, String>,
    /// Whether displacement and force, as recorded, agree in sign.
    agreement: Agreement,
}

impl Measurement {
    /// A measurement from readings: checked, on a uniform clock, signs as agreed.
    ///
    /// # Errors
    /// The first thing that does not fit.
    ///
    /// ```
    /// use measurement::{Measurement, Series};
    /// // A dashpot of 10 kN s/m at 2 Hz and 5 mm.
    /// let w = std::f64::consts::TAU * 2.0;
    /// let x = |n: usize| 5e-3 * libm::sin(w * n as f64 * 1e-3);
    /// let f = |n: usize| 10e3 * 5e-3 * w * libm::cos(w * n as f64 * 1e-3);
    /// let series = Series::sampled("a", 1e3, (0..3000).map(x).collect(), (0..3000).map(f).collect());
    /// let test = Measurement::from_series(series)?;
    /// assert!((test.frequency_hz().unwrap() - 2.0).abs() < 1e-3);
    /// assert!((test.amplitude_m() - 5e-3).abs() < 1e-6);
    /// assert_eq!(test.run_in, 500);
    /// # Ok::<(), crate::MeasurementError>(())
    /// ```
    pub fn from_series(series: Series) -> Result<Self, MeasurementError> {
        let mut alone = Self::as_recorded(series)?;
        settle_sign(&mut [&mut alone]);
        Ok(alone)
    }

    /// The tests of one visit, wired alike: all of them together decide about their signs.
    ///
    /// # Errors
    /// The first thing that does not fit.
    pub fn from_visit(
        visit: impl IntoIterator<Item = Series>,
    ) -> Result<Vec<Self>, MeasurementError> {
        let mut tests = visit
            .into_iter()
            .map(Self::as_recorded)
            .collect::<Result<Vec<_>, MeasurementError>>()?;
        settle_sign(&mut tests.iter_mut().collect::<Vec<_>>());
        Ok(tests)
    }

    /// The same, the force not yet turned.
    fn as_recorded(mut series: Series) -> Result<Self, MeasurementError> {
        checks::size(&series)?;
        if series.extension == Extension::Negative {
            let turned = [Some(&mut series.displacement_m), Some(&mut series.force_n)];
            for channel in turned.into_iter().chain([series.velocity_m_per_s.as_mut()]).flatten() {
                for value in channel {
                    *value = -*value;
                }
            }
        }
        checks::refuse_clipped(&mut series)?;
        checks::refuse_frozen(&series)?;
        checks::mend_spikes(&mut series);
        let start_s = series.time_s.first().copied().unwrap_or(0.0);
        let step_s = clock::make_uniform(&mut series)?;
        checks::length(&series, step_s)?;
        let cycles = cycles::find(&series.displacement_m);
        let agreement = Agreement::of(&series, &cycles, step_s)?;
        let drive_m = smoothing::smoothed(&series.displacement_m);
        let (velocity_m_per_s, acceleration_m_per_s2) = interpolant::derivatives(&drive_m, step_s);
        checks::tell_velocity(&mut series, &velocity_m_per_s);
        let run_in = cycles::run_in(&cycles, series.force_n.len(), step_s);
        Ok(Self {
            name: series.name,
            file: series.file,
            start_s,
            step_s,
            displacement_m: series.displacement_m,
            drive_m,
            velocity_m_per_s,
            acceleration_m_per_s2,
            force_n: series.force_n,
            temperature_degc: series.temperature_degc,
            cycles,
            run_in,
            direction_declared: series.extension != Extension::Unknown,
            force_turned: false,
            repairs: series.repairs,
            destroyed: BTreeMap::new(),
            agreement,
        })
    }

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

    fn acceleration(&self, sample: usize) -> f64 {
        self.acceleration_m_per_s2.get(sample).copied().unwrap_or(0.0)
    }
}

/// Reads all tests of files, in the order given, with names that no two of them share.
///
/// Without a mapping the columns are `time_s,displacement_m,force_n` and optionally
/// `velocity_m_per_s,temperature_degc`; lines that begin with `#` are comments, and one of them may
/// say `# extension: positive`, `negative` or `unknown`.
///
/// # Errors
/// The first thing that does not fit, in one line.
pub fn read_tests(
    paths: &[PathBuf],
    mapping: Option<&Path>,
) -> Result<Vec<Measurement>, MeasurementError> {
    let mapping = mapping.map(Mapping::load).transpose()?;
    let mut tests: Vec<Measurement> = Vec::new();
    // What was read alike from a column of the same name was wired alike.
    let mut wirings: Vec<(Layout, String)> = Vec::new();
    let mut visits: Vec<usize> = Vec::new();
    for path in paths {
        let layout = match &mapping {
            Some((mapping, source)) => mapping.layout(source, path)?,
            None => Mapping::own()?,
        };
        for series in series::read(path, &layout)? {
            let destroyed = layout.destroyed.clone();
            let wiring = (layout.clone(), series.columns[2].clone());
            let known = wirings.iter().position(|other| *other == wiring);
            visits.push(known.unwrap_or(wirings.len()));
            if known.is_none() {
                wirings.push(wiring);
            }
            tests.push(Measurement { destroyed, ..Measurement::as_recorded(series)? });
        }
    }
    for visit in 0..wirings.len() {
        let of_visit = tests.iter_mut().zip(&visits).filter(|(_, own)| **own == visit);
        settle_sign(&mut of_visit.map(|(test, _)| test).collect::<Vec<_>>());
    }
    name_apart(&mut tests);
    let warm = tests.iter().filter(|test| test.temperature_degc.is_some()).count();
    if warm > 0 && warm < tests.len() {
        for test in tests.iter_mut().filter(|test| test.temperature_degc.is_none()) {
            test.repairs
                .push("left as it is: no temperature here, though other tests have it".to_owned());
        }
    }
    Ok(tests)
}

/// Turns the force where it disagrees with the displacement.
fn settle_sign(visit: &mut [&mut Measurement]) {
    let disagree = sign::disagree(visit.iter().map(|test| &test.agreement));
    for test in visit {
        test.force_turned = test.agreement.turned(disagree);
        if test.force_turned {
            test.force_n.iter_mut().for_each(|force| *force = -*force);
        }
        test.repairs.extend(test.agreement.told(disagree));
    }
}

/// Adds a number to names that came before.
fn name_apart(tests: &mut [Measurement]) {
    let mut taken = std::collections::BTreeSet::new();
    for test in tests {
        let (plain, mut number) = (test.name.clone(), 1);
        while !taken.insert(test.name.clone()) {
            number += 1;
            test.name = format!("{plain}-{number}");
        }
    }
}
