//! The part of a residual that repeats from cycle to cycle.
//!
//! The noise of different cycles is independent; a missing effect returns at the same phase. With
//! `r_i` the residual of cycle i over its phase,
//!
//! ```text
//! power that repeats = mean over pairs i, j of different cycles of <r_i, r_j>
//! ```
//!
//! each without the line through it, which a slow drift makes,
//!
//! for any shape that is slower than a few milliseconds (a faster one, a filter of the bench makes
//! of every kink of the force, with a perfect model too). Half the mean square of `r_(i+1) - r_i`
//! is the noise floor, free of everything that repeats, over the pairs whose motion is most alike,
//! and without cycles that are unlike all others ([`super::unlike`]). Between neighbours a slow
//! drift hardly changes, so the variance of the cycles' means beyond that of neighbours is added. A
//! few samples that differ by more than six times the rest, such as those of a start from rest, are
//! left out. A difference that grows with the force is no noise ([`super::between_cycles`]).
//! Neighbouring cycles closer than the memory of ordinary noise make no pair of the first kind.

use super::between_cycles::{Difference, Differences};
use super::cycles::{runs, starts};
use super::unlike::{Unlike, unlike};
use crate::chance::one_sided;
use crate::test_set::{Test, TestSet};
use measurement::noise::cycles::rest_of_shift_s;
use signal::statistics::{mean, moving_mean};

/// Points of phase that a cycle is averaged into.
const PHASES: usize = 256;
/// Width of the moving mean that removes faster shapes, s.
const SMOOTHED_S: f64 = 8e-3;
/// Pairs of cycles differ in their motion by at most this multiple of the pair of a test that
/// differs least, or by at most this share.
const AS_ALIKE: f64 = 3.0;
const SAME: f64 = 2e-3;
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
    /// rms of what changes from cycle to cycle with the force, N; none where nothing does.
    pub growing_n: Option<f64>,
    /// Tests with cycles.
    pub tests: usize,
    /// Cycles that are unlike all others.
    pub unlike: Vec<Unlike>,
}

/// Compares cycles of all tests that have at least two.
pub(crate) fn repeat(residual_n: &[Vec<f64>], tests: &TestSet) -> Repeat {
    let (mut products, mut power, mut power_in_all, mut weight) = (Vec::new(), 0.0, 0.0, 0.0);
    let (mut scatter, mut differences) = (Vec::new(), Differences::default());
    let (mut with_cycles, mut drift_n2, mut with_means) = (0, 0.0, 0);
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
            drift_n2 += run.samples as f64 * drift_n2_of(&run.means);
            with_means += run.samples;
            let pairs = run.products();
            if !pairs.slow.is_empty() {
                let share = run.samples as f64 / pairs.slow.len() as f64;
                products.extend(pairs.slow.iter().map(|product| product * share));
                power += pairs.slow.iter().sum::<f64>() * share;
                power_in_all += pairs.all * share;
                weight += run.samples as f64;
            }
            for (first, three) in marks.windows(3).enumerate() {
                if odd(first) || odd(first + 1) {
                    continue;
                }
                if let Some(pair) = SuccessiveCycles::new(test, residual, three) {
                    scatter.push(pair);
                }
            }
        }
        with_cycles += usize::from(has_cycles);
        let best = scatter.iter().map(|pair| pair.unlike).fold(f64::INFINITY, f64::min);
        let alike = scatter.drain(..).filter(|pair| pair.unlike <= (AS_ALIKE * best).max(SAME));
        differences.add(alike.map(|pair| pair.samples));
    }
    let rms = |power: f64| if weight > 0.0 { (power / weight).max(0.0).sqrt() } else { 0.0 };
    Repeat {
        repeated_rms_n: rms(power),
        repeated_in_all_rms_n: rms(power_in_all),
        p_value: one_sided(&products),
        noise_floor_n: differences.mean_square_n2().map(|square_n2| {
            let drift_n2 = drift_n2 / with_means.max(1) as f64;
            (0.5 * square_n2 + drift_n2).sqrt()
        }),
        growing_n: differences.growing_n(),
        tests: with_cycles,
        unlike,
    }
}

/// The difference of the residual between two successive cycles.
struct SuccessiveCycles {
    samples: Vec<Difference>,
    /// Difference of the displacement, rms over rms.
    unlike: f64,
}

impl SuccessiveCycles {
    /// Of three marks. A period is no whole number of samples: the rest of the shift follows from
    /// the displacement, and a residual with steep flanks is shifted by it along its slope.
    fn new(test: &Test, residual: &[f64], marks: &[usize]) -> Option<Self> {
        let (start, shift) = (*marks.first()?, marks.get(1)? - marks.first()?);
        let end = (*marks.get(1)?).min((*marks.get(2)?).saturating_sub(shift + 1));
        let (x, v) = (&test.record.drive_m, &test.record.velocity_m_per_s);
        if start == 0 || start >= end || end + shift >= residual.len() {
            return None;
        }
        let late_s = rest_of_shift_s((x, v), start..end, shift);
        let middle = mean(&x[start..end]);
        let slope = |n: usize| (residual[n + 1] - residual[n - 1]) / (2.0 * test.record.step_s);
        let force_n = &test.record.force_n;
        let mut samples = Vec::with_capacity(end - start);
        let (mut unlike2, mut size2) = (0.0_f64, 0.0_f64);
        for n in start..end {
            let moved = late_s * 0.5 * (slope(n) + slope(n + shift));
            samples.push(Difference {
                n: residual[n + shift] - residual[n] - moved,
                force_n: 0.5 * (force_n[n] + force_n[n + shift]),
            });
            let apart = x[n + shift] - x[n] - late_s * 0.5 * (v[n] + v[n + shift]);
            unlike2 += apart * apart;
            size2 += (x[n] - middle) * (x[n] - middle);
        }
        let unlike = if size2 > 0.0 { (unlike2 / size2).sqrt() } else { 0.0 };
        Some(Self { samples, unlike })
    }
}

/// A run of equal cycles.
struct Run {
    /// The same without fast shapes, over phase.
    slow: Vec<Vec<f64>>,
    /// The same with them.
    all: Vec<Vec<f64>>,
    /// Means of the cycles, N.
    means: Vec<f64>,
    /// Cycles between the two of a pair.
    apart: usize,
    samples: usize,
}

/// Products of pairs of cycles.
struct Products {
    slow: Vec<f64>,
    all: f64,
}

impl Run {
    fn new(marks: &[usize], residual: &[f64], step_s: f64) -> Self {
        let cycles: Vec<&[f64]> =
            marks.windows(2).filter_map(|pair| residual.get(pair[0]..pair[1])).collect();
        let shortest = cycles.iter().map(|cycle| cycle.len()).min().unwrap_or(0);
        let phases = shortest.min(PHASES);
        let slow = moving_mean(residual, (0.5 * SMOOTHED_S / step_s).round() as usize);
        let slow = marks.windows(2).filter_map(|pair| slow.get(pair[0]..pair[1]));
        let apart = (APART_S / (shortest as f64 * step_s)).ceil().max(1.0) as usize;
        Self {
            means: cycles.iter().map(|cycle| mean(cycle)).collect(),
            slow: slow.map(|cycle| without_line(folded(cycle, phases))).collect(),
            all: cycles.iter().map(|cycle| folded(cycle, phases)).collect(),
            apart,
            samples: cycles.iter().map(|cycle| cycle.len()).sum(),
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

/// Variance of the means of cycles beyond that of neighbours, N2: their slow drift.
fn drift_n2_of(means_n: &[f64]) -> f64 {
    let pairs = means_n.len().saturating_sub(1);
    if pairs < 2 {
        return 0.0;
    }
    let middle = mean(means_n);
    let square = |value: f64| value * value;
    let all: f64 = means_n.iter().map(|value| square(value - middle)).sum();
    let neighbours: f64 = means_n.windows(2).map(|two| square(two[1] - two[0])).sum();
    ((all - 0.5 * neighbours) / pairs as f64).max(0.0)
}

/// Values less the line through them: a slow drift is nearly a line within a cycle, and its lines
/// in neighbouring cycles are alike.
fn without_line(mut values: Vec<f64>) -> Vec<f64> {
    let count = values.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let mean = values.iter().sum::<f64>() / count.max(1.0);
    let tilt: f64 = values.iter().enumerate().map(|(k, value)| (k as f64 - middle) * value).sum();
    let spread = count * (count * count - 1.0) / 12.0;
    let slope = if spread > 0.0 { tilt / spread } else { 0.0 };
    for (k, value) in values.iter_mut().enumerate() {
        *value -= mean + slope * (k as f64 - middle);
    }
    values
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drift_is_what_the_means_of_cycles_scatter_beyond_their_neighbours() {
        // A ramp of ten: variance 9.17 of neighbours that differ by 1.
        let ramp: Vec<f64> = (0..10).map(f64::from).collect();
        assert!((drift_n2_of(&ramp) - (82.5 - 4.5) / 9.0).abs() < 1e-12);
        // Alternating means are no drift.
        assert_eq!(drift_n2_of(&[1.0, -1.0, 1.0, -1.0]), 0.0);
        assert_eq!(drift_n2_of(&[1.0, 5.0]), 0.0);
    }

    #[test]
    fn a_line_is_taken_off_and_nothing_else() {
        let line: Vec<f64> = (0..8).map(|k| 3.0 - 0.5 * f64::from(k)).collect();
        assert!(without_line(line).iter().all(|rest| rest.abs() < 1e-12));
        let wave: Vec<f64> = [1.0, -1.0, -1.0, 1.0].into();
        assert_eq!(without_line(wave.clone()), wave);
    }
}
