//! Cycles that are unlike all others.
//!
//! The noise of one bench is about as large in every cycle. A cycle whose residual differs from
//! those of its neighbours by many times the usual difference holds an event: a cable, a logger, an
//! impact. It is no noise, and no effect of the catalogue occurs once. Where such cycles hold less
//! than half of the squared residual, the model is wrong elsewhere too and may cause them itself;
//! then they are ignored.

use super::cycles::cycles;
use crate::test_set::TestSet;

/// A cycle is unlike the others from this multiple of their usual difference.
const UNLIKE: f64 = 8.0;
/// Differences below this share of the rms force are not reported.
const LEAST_SHARE_OF_FORCE: f64 = 0.01;
/// Share of the squared residual that they hold together.
const LEAST_SHARE_OF_ALL: f64 = 0.5;
/// Neighbours to either side that a cycle is compared with.
const NEIGHBOURS: usize = 2;

/// A cycle that is unlike the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unlike {
    /// Its test.
    pub test: usize,
    /// Its place among the cycles of that test.
    pub cycle: usize,
    /// rms difference from the most similar of its neighbours, as noise of each, N.
    pub rms_n: f64,
    /// The usual difference, N.
    pub usual_n: f64,
    /// Sum of its squared residual, N2.
    pub square_n2: f64,
}

/// Compares every cycle of tests that have at least three with its neighbours.
pub(crate) fn unlike(residual_n: &[Vec<f64>], tests: &TestSet) -> Vec<Unlike> {
    let mut all: Vec<Unlike> = Vec::new();
    for (index, (test, residual)) in tests.tests.iter().zip(residual_n).enumerate() {
        let cycles = cycles(test, residual);
        if cycles.len() < 3 {
            continue;
        }
        for (i, cycle) in cycles.iter().enumerate() {
            let first = i.saturating_sub(NEIGHBOURS);
            let neighbours = cycles.iter().enumerate().skip(first).take(i - first + NEIGHBOURS + 1);
            let apart = neighbours.filter(|(j, _)| *j != i).map(|(_, other)| apart(cycle, other));
            let least = apart.fold(f64::INFINITY, f64::min);
            let rms_n = (0.5 * least).sqrt();
            let square_n2 = cycle.iter().map(|r| r * r).sum();
            all.push(Unlike { test: index, cycle: i, rms_n, usual_n: 0.0, square_n2 });
        }
    }
    let mut sizes: Vec<f64> = all.iter().map(|cycle| cycle.rms_n).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let Some(usual_n) = sizes.get(sizes.len() / 2).copied() else { return Vec::new() };
    let least_n = (UNLIKE * usual_n).max(LEAST_SHARE_OF_FORCE * tests.rms_force_n());
    all.retain(|cycle| cycle.rms_n > least_n);
    let counted = tests.tests.iter().zip(residual_n).map(|(test, r)| &r[test.counted()]);
    let total: f64 = counted.flatten().map(|r| r * r).sum();
    if all.iter().map(|cycle| cycle.square_n2).sum::<f64>() < LEAST_SHARE_OF_ALL * total {
        return Vec::new();
    }
    for cycle in &mut all {
        cycle.usual_n = usual_n;
    }
    all
}

/// Mean square of a difference.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let length = a.len().min(b.len()).max(1) as f64;
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / length
}

#[cfg(test)]
mod tests {
    use super::*;
    use measurement::{Measurement, Series};

    #[test]
    fn a_cycle_with_an_event_is_reported_and_its_neighbours_are_not() {
        let w = std::f64::consts::TAU * 2.0;
        let x = |n: usize| 5e-3 * libm::sin(w * n as f64 * 1e-3);
        let f = |n: usize| 1e4 * libm::cos(w * n as f64 * 1e-3);
        let series =
            Series::sampled("a", 1e3, (0..5000).map(x).collect(), (0..5000).map(f).collect());
        let tests = TestSet::new(vec![Measurement::from_series(series).unwrap()]);
        let noise = |n: usize| ((n * 7919 + n * n * 104_729) % 997) as f64 / 10.0 - 50.0;
        let mut residual: Vec<f64> = (0..5000).map(noise).collect();
        assert_eq!(unlike(&[residual.clone()], &tests), []);
        let at = tests.tests[0].record.cycles.iter().filter(|at| **at >= 500).nth(4).unwrap();
        for value in &mut residual[at + 100..at + 140] {
            *value = 8e3;
        }
        let found = unlike(&[residual], &tests);
        assert_eq!(found.iter().map(|one| one.cycle).collect::<Vec<_>>(), [4]);
        assert!(found[0].rms_n > 1.5e3 && found[0].usual_n < 50.0, "{found:?}");
    }
}
