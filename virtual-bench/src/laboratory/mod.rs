//! What a damper laboratory prints about its tests.
//!
//! - Force over velocity, one point per test and direction: median force and velocity while the
//!   eyes pass the middle fifth of the stroke, where the velocity is highest; compared with the
//!   tolerance of a datasheet where there is one.
//! - Dynamic stiffness by the first harmonic of force over that of the *measured* displacement, `K*
//!   = F_1/X = K' + j K''`: magnitude, phase (force before displacement), equivalent damping `C =
//!   K''/w`; and all harmonics of the force from 0 to 7, which a table of first harmonics alone
//!   would omit. For a damper with relief or clearance these are describing functions at that
//!   amplitude, not Ce and Ke.
//! - Work per cycle, the closed integral of F dx.
//! - Forces at rest, by position.
//!
//! Figures of a periodic test are taken over its steady cycles: the first two are omitted where
//! at least three remain. A short test between rests, or with a soft start and end, has the figures
//! of its cycles of equal size. A record with several runs of cycles has a row for each. A test
//! without cycles has its extremes only.

pub mod harmonic;
mod limits;
mod table;

pub use limits::Limit;

use harmonic::{Harmonics, ORDERS};
use measurement::Measurement;
use serde::Serialize;
use signal::statistics::{mean, min_max, percentile};
use std::f64::consts::TAU;

/// Cycles omitted at the beginning, if enough remain.
const LEFT_OUT: usize = 2;
/// Cycles that have to remain.
const REMAIN: usize = 3;
/// Half width of the middle of the stroke, as a share of the amplitude.
const MIDDLE: f64 = 0.2;
/// Share of higher harmonics below which a displacement is a sine.
const SINE: f64 = 0.02;

/// All figures of a visit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Laboratory {
    /// Positive is known to be extension; else directions are side A (positive) and side B.
    pub direction_declared: bool,
    /// One entry per test.
    pub tests: Vec<TestFigures>,
    /// Force over velocity, slow to fast.
    pub force_velocity: Vec<ForcePoint>,
}

/// Figures of one test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TestFigures {
    /// Its name.
    pub name: String,
    /// Length, s.
    pub duration_s: f64,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Middle of the displacement, m.
    pub mean_m: f64,
    /// Half the range of the displacement, m.
    pub amplitude_m: f64,
    /// Frequency, Hz, of a periodic test.
    pub frequency_hz: Option<f64>,
    /// Cycles that figures are taken from.
    pub cycles_used: usize,
    /// Greatest force, N.
    pub force_max_n: f64,
    /// Least force, N.
    pub force_min_n: f64,
    /// Mean force over whole cycles, the centre of the loop, N.
    pub force_mean_n: f64,
    /// Work per cycle, J.
    pub work_per_cycle_j: Option<f64>,
    /// Dynamic figures of a sine.
    pub dynamic: Option<Dynamic>,
    /// Forces at rest.
    pub holds: Vec<Hold>,
    /// Oil temperature at the start and the end, degrees Celsius.
    pub temperature_degc: Option<[f64; 2]>,
    /// What was repaired in the record.
    pub repairs: Vec<String>,
}

/// Dynamic stiffness and damping.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Dynamic {
    /// K', N/m.
    pub stiffness_real_n_per_m: f64,
    /// K'', N/m.
    pub stiffness_imaginary_n_per_m: f64,
    /// Magnitude of K*, N/m.
    pub stiffness_n_per_m: f64,
    /// Force before displacement, degrees.
    pub phase_deg: f64,
    /// K'' over the angular frequency, N s/m.
    pub damping_n_s_per_m: f64,
    /// Amplitude of the displacement's first harmonic, m.
    pub amplitude_m: f64,
    /// Harmonics of the force, 0 to 7.
    pub harmonics: Vec<ForceHarmonic>,
}

/// One harmonic of the force.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForceHarmonic {
    /// Its order; 0 is the mean.
    pub order: usize,
    /// Amplitude, N.
    pub force_n: f64,
    /// Phase against a sine that rises with the displacement, degrees.
    pub phase_deg: f64,
}

/// One point of the force-velocity table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForcePoint {
    /// The test.
    pub test: String,
    /// Mean of the velocities of both directions, m/s.
    pub velocity_m_per_s: f64,
    /// Force in extension, N (side A where the direction is not declared).
    pub extension_n: f64,
    /// Force in compression, N, as a positive number (side B).
    pub compression_n: f64,
    /// What the datasheet allows at this velocity, if it covers it.
    pub limit: Option<Limit>,
    /// Both forces are within it; without a declared direction, one way round or the other.
    pub within_limit: Option<bool>,
}

/// A rest of at least half a second.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Hold {
    /// When it begins, s from the start.
    pub start_s: f64,
    /// How long it lasts, s.
    pub duration_s: f64,
    /// Where, m.
    pub displacement_m: f64,
    /// Mean force over its second half, N.
    pub force_n: f64,
}

impl Laboratory {
    /// The figures of a list of tests, compared with the rows of a datasheet, if there are any.
    pub fn of(tests: &[Measurement], datasheet: &[Limit]) -> Self {
        let parts: Vec<Part<'_>> = tests.iter().flat_map(Part::all).collect();
        let mut force_velocity: Vec<ForcePoint> =
            parts.iter().filter_map(|part| force_point(part, datasheet)).collect();
        force_velocity.sort_by(|a, b| a.velocity_m_per_s.total_cmp(&b.velocity_m_per_s));
        Self {
            direction_declared: tests.iter().all(|test| test.direction_declared),
            tests: parts.iter().map(TestFigures::of).collect(),
            force_velocity,
        }
    }
}

/// A test, or one of its runs of cycles where it has several.
struct Part<'a> {
    test: &'a Measurement,
    name: String,
    cycles: &'a [usize],
    /// Which run, from zero, of a test with several.
    run: Option<usize>,
}

impl<'a> Part<'a> {
    fn all(test: &'a Measurement) -> Vec<Self> {
        if test.runs.len() < 2 {
            let name = test.name.clone();
            return vec![Self { test, name, cycles: &test.cycles, run: None }];
        }
        let part = |(run, cycles): (usize, &'a Vec<usize>)| {
            let name = format!("{} run {}", test.name, run + 1);
            Self { test, name, cycles, run: Some(run) }
        };
        test.runs.iter().enumerate().map(part).collect()
    }

    /// The samples of the steady cycles and how many cycles they are; everything and zero for a
    /// test without cycles.
    fn steady(&self) -> (std::ops::Range<usize>, usize) {
        let Some(whole) = self.cycles.len().checked_sub(1).filter(|whole| *whole > 0) else {
            return (0..self.test.len(), 0);
        };
        let left_out = LEFT_OUT.min(whole.saturating_sub(REMAIN));
        (self.cycles[left_out]..self.cycles[whole], whole - left_out)
    }

    /// Samples of the run, or of the test.
    fn len(&self) -> usize {
        match (self.run, self.cycles) {
            (Some(_), [first, .., last]) => last - first,
            _ => self.test.len(),
        }
    }
}

impl TestFigures {
    fn of(part: &Part<'_>) -> Self {
        let test = part.test;
        let (range, cycles_used) = part.steady();
        let (x, force) = (&test.displacement_m[range.clone()], &test.force_n[range.clone()]);
        let (x_min, x_max) = min_max(x).unwrap_or_default();
        let (force_min_n, force_max_n) = min_max(force).unwrap_or_default();
        let frequency_hz = (cycles_used > 0).then(|| {
            let guess = cycles_used as f64 / x.len() as f64;
            harmonic::frequency(x, guess) * test.rate_hz()
        });
        let ends = |degc: &Vec<f64>| Some([*degc.first()?, *degc.last()?]);
        let is_first = part.run.is_none_or(|run| run == 0);
        Self {
            name: part.name.clone(),
            duration_s: part.len() as f64 * test.step_s,
            rate_hz: test.rate_hz(),
            mean_m: 0.5 * (x_min + x_max),
            amplitude_m: 0.5 * (x_max - x_min),
            frequency_hz,
            cycles_used,
            force_max_n,
            force_min_n,
            force_mean_n: mean(force),
            work_per_cycle_j: (cycles_used > 0).then(|| work_j(test, range) / cycles_used as f64),
            dynamic: frequency_hz.and_then(|hz| Dynamic::of(x, force, hz, test.step_s)),
            // Those of the whole record stand with its first run.
            holds: if is_first { holds(test) } else { Vec::new() },
            temperature_degc: test.temperature_degc.as_ref().and_then(ends),
            repairs: if is_first { test.repairs.clone() } else { Vec::new() },
        }
    }
}

/// Work over a range of samples, J.
fn work_j(test: &Measurement, range: std::ops::Range<usize>) -> f64 {
    let last = test.len() - 1;
    range
        .map(|n| {
            let next = (n + 1).min(last);
            let way = test.displacement_m[next] - test.displacement_m[n];
            0.5 * (test.force_n[n] + test.force_n[next]) * way
        })
        .sum()
}

impl Dynamic {
    /// `None` where the displacement is no sine.
    fn of(x: &[f64], force: &[f64], frequency_hz: f64, step_s: f64) -> Option<Self> {
        let per_sample = frequency_hz * step_s;
        let (x, force) = (Harmonics::of(x, per_sample)?, Harmonics::of(force, per_sample)?);
        let amplitude_m = x.amplitude(1);
        let higher: f64 = (2..=ORDERS).map(|order| x.amplitude(order)).fold(0.0, f64::max);
        if amplitude_m <= 0.0 || higher > SINE * amplitude_m {
            return None;
        }
        let phase = wrapped(force.phase(1) - x.phase(1));
        let size = force.amplitude(1) / amplitude_m;
        let imaginary = size * libm::sin(phase);
        let mut harmonics = vec![ForceHarmonic { order: 0, force_n: force.mean, phase_deg: 0.0 }];
        harmonics.extend((1..=ORDERS).map(|order| {
            let turned = wrapped(force.phase(order) - order as f64 * x.phase(1));
            ForceHarmonic { order, force_n: force.amplitude(order), phase_deg: turned.to_degrees() }
        }));
        Some(Self {
            stiffness_real_n_per_m: size * libm::cos(phase),
            stiffness_imaginary_n_per_m: imaginary,
            stiffness_n_per_m: size,
            phase_deg: phase.to_degrees(),
            damping_n_s_per_m: imaginary / (TAU * frequency_hz),
            amplitude_m,
            harmonics,
        })
    }
}

/// An angle between -pi and pi.
fn wrapped(angle: f64) -> f64 {
    angle - TAU * libm::rint(angle / TAU)
}

/// The force at the peak velocity of a periodic test.
fn force_point(part: &Part<'_>, datasheet: &[Limit]) -> Option<ForcePoint> {
    let test = part.test;
    let (range, cycles) = part.steady();
    if cycles == 0 {
        return None;
    }
    let (low, high) = min_max(&test.displacement_m[range.clone()])?;
    let (middle, amplitude) = (0.5 * (low + high), 0.5 * (high - low));
    let passing = |sign: f64| {
        let inside = range.clone().filter(|n| {
            (test.displacement_m[*n] - middle).abs() <= MIDDLE * amplitude
                && test.velocity_m_per_s[*n] * sign > 0.0
        });
        let (mut force, mut speed) = (Vec::new(), Vec::new());
        for n in inside {
            force.push(sign * test.force_n[n]);
            speed.push(sign * test.velocity_m_per_s[n]);
        }
        percentile(&force, 0.5).zip(percentile(&speed, 0.5))
    };
    let ((extension_n, out), (compression_n, back)) = (passing(1.0)?, passing(-1.0)?);
    let velocity_m_per_s = 0.5 * (out + back);
    let limit = Limit::at(datasheet, velocity_m_per_s);
    Some(ForcePoint {
        test: part.name.clone(),
        velocity_m_per_s,
        extension_n,
        compression_n,
        limit,
        within_limit: limit.map(|limit| {
            limit.holds(extension_n, compression_n)
                || !test.direction_declared && limit.holds(compression_n, extension_n)
        }),
    })
}

/// Rests of at least half a second, in blocks of a tenth.
fn holds(test: &Measurement) -> Vec<Hold> {
    let block = (libm::round(0.1 * test.rate_hz()) as usize).max(1);
    // A ten-thousandth of the range in a block is rest; within it, noise may be larger.
    let range = |values: &[f64]| min_max(values).map_or(0.0, |(low, high)| high - low);
    let whole = range(&test.displacement_m);
    let blocks: Vec<&[f64]> = test.displacement_m.chunks_exact(block).collect();
    let at_rest = |pair: &[&[f64]]| {
        (mean(pair[1]) - mean(pair[0])).abs() <= 1e-4 * whole
            && range(pair[0]).max(range(pair[1])) <= 0.02 * whole
    };
    let still: Vec<bool> = blocks.windows(2).map(at_rest).collect();
    let mut found = Vec::new();
    let mut from = 0;
    for index in 1..=blocks.len() {
        if still.get(index - 1) == Some(&true) {
            continue;
        }
        // The block in which a motion ends or begins is not at rest.
        if index - from >= 7 {
            let (start, end) = ((from + 1) * block, (index - 1) * block);
            let later = start + (end - start) / 2;
            found.push(Hold {
                start_s: start as f64 * test.step_s,
                duration_s: (end - start) as f64 * test.step_s,
                displacement_m: mean(&test.displacement_m[start..end]),
                force_n: mean(&test.force_n[later..end]),
            });
        }
        from = index;
    }
    found
}

#[cfg(test)]
mod tests;
