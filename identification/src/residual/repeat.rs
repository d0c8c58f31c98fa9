//! The part of a residual that repeats from cycle to cycle.
//!
//! The noise of different cycles is independent; a missing effect returns at the same phase. With
//! `r_i` the residual of cycle i over its phase,
//!
//! ```text
//! power that repeats = mean over pairs i, j of different cycles of <r_i, r_j>
//! ```
//!
//! for any shape that is slower than a few milliseconds (a faster one, a filter of the bench makes
//! of every kink of the force, with a perfect model too). Half the mean square of `r_(i+1) - r_i`
//! is the noise floor, free of everything that repeats and of slow drift, and without cycles that
//! are unlike all others ([`super::unlike`]). Neighbouring cycles closer than the memory of
//! ordinary noise make no pair.

use super::cycles::{runs, starts};
use super::unlike::{Unlike, unlike};
use crate::chance::one_sided;
use crate::test_set::TestSet;
use signal::statistics::moving_mean;

/// Points of phase that a cycle is averaged into.
const PHASES: usize = 256;
/// Width of the moving mean that removes faster shapes, s.
const SMOOTHED_S: f64 = 8e-3;
/// Cycles whose starts are closer than this make no pair, s.
const APART_S: f64 = 0.3;

/// The repeating part of a residual, and the noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeat {
    /// rms of the repeating part, N, without shapes faster than a few milliseconds.
    pub repeated_rms_n: f64,
    /// rms of the repeating part, N, however fast.
    pub repeated_in_all_rms_n: f64,
    /// Probability of that much by chance.
    pub p_value: f64,
    /// rms of the rest, N; none without cycles.
    pub noise_floor_n: Option<f64>,
    /// Tests with cycles.
    pub tests: usize,
    /// Cycles that are unlike all others.
    pub unlike: Vec<Unlike>,
}

/// Compares cycles of all tests that have at least two.
pub(crate) fn repeat(residual_n: &[Vec<f64>], tests: &TestSet) -> Repeat {
    let (mut products, mut power, mut power_in_all, mut weight) = (Vec::new(), 0.0, 0.0, 0.0);
    let (mut scatter, mut scattered, mut with_cycles) = (0.0, 0usize, 0);
    let unlike = unlike(residual_n, tests);
    for (index, (test, residual)) in tests.tests.iter().zip(residual_n).enumerate() {
        let longest = starts(test);
        let mut has_cycles = false;
        for marks in runs(test) {
            has_cycles = true;
            // Only the cycles of the longest run are compared with each other.
            let odd = |cycle: usize| {
                marks == longest && unlike.iter().any(|one| (one.test, one.cycle) == (index, cycle))
            };
            let run = Run::new(&marks, residual, test.record.step_s);
            let pairs = run.products();
            if !pairs.slow.is_empty() {
                let share = run.samples as f64 / pairs.slow.len() as f64;
                products.extend(pairs.slow.iter().map(|product| product * share));
                power += pairs.slow.iter().sum::<f64>() * share;
                power_in_all += pairs.all * share;
                weight += run.samples as f64;
            }
            for (first, pair) in run.cycles.windows(2).enumerate() {
                if odd(first) || odd(first + 1) {
                    continue;
                }
                let length = pair[0].len().min(pair[1].len());
                scatter += pair[0].iter().zip(pair[1]).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
                scattered += length;
            }
        }
        with_cycles += usize::from(has_cycles);
    }
    let rms = |power: f64| if weight > 0.0 { (power / weight).max(0.0).sqrt() } else { 0.0 };
    Repeat {
        repeated_rms_n: rms(power),
        repeated_in_all_rms_n: rms(power_in_all),
        p_value: one_sided(&products),
        noise_floor_n: (scattered > 0).then(|| (0.5 * scatter / scattered as f64).sqrt()),
        tests: with_cycles,
        unlike,
    }
}

/// A run of equal cycles.
struct Run<'a> {
    cycles: Vec<&'a [f64]>,
    /// The same without fast shapes, over phase.
    slow: Vec<Vec<f64>>,
    /// The same with them.
    all: Vec<Vec<f64>>,
    /// Cycles between the two of a pair.
    apart: usize,
    samples: usize,
}

/// Products of pairs of cycles.
struct Products {
    slow: Vec<f64>,
    all: f64,
}

impl<'a> Run<'a> {
    fn new(marks: &[usize], residual: &'a [f64], step_s: f64) -> Self {
        let cycles: Vec<&[f64]> =
            marks.windows(2).filter_map(|pair| residual.get(pair[0]..pair[1])).collect();
        let shortest = cycles.iter().map(|cycle| cycle.len()).min().unwrap_or(0);
        let phases = shortest.min(PHASES);
        let slow = moving_mean(residual, (0.5 * SMOOTHED_S / step_s).round() as usize);
        let slow = marks.windows(2).filter_map(|pair| slow.get(pair[0]..pair[1]));
        let apart = (APART_S / (shortest as f64 * step_s)).ceil().max(1.0) as usize;
        Self {
            slow: slow.map(|cycle| folded(cycle, phases)).collect(),
            all: cycles.iter().map(|cycle| folded(cycle, phases)).collect(),
            apart,
            samples: cycles.iter().map(|cycle| cycle.len()).sum(),
            cycles,
        }
    }

    fn products(&self) -> Products {
        let product = |a: &[f64], b: &[f64]| {
            a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / a.len().max(1) as f64
        };
        let mut products = Products { slow: Vec::new(), all: 0.0 };
        for i in 0..self.slow.len() {
            for j in i + self.apart..self.slow.len() {
                products.slow.push(product(&self.slow[i], &self.slow[j]));
                products.all += product(&self.all[i], &self.all[j]);
            }
        }
        products
    }
}

/// A cycle averaged into points of equal phase.
fn folded(cycle: &[f64], phases: usize) -> Vec<f64> {
    (0..phases)
        .map(|k| {
            let range = k * cycle.len() / phases..(k + 1) * cycle.len() / phases;
            let length = range.len().max(1) as f64;
            cycle[range].iter().sum::<f64>() / length
        })
        .collect()
}
