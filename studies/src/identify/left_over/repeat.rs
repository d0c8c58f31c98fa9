//! What repeats from cycle to cycle.
//!
//! Noise of different cycles is independent; what the model lacks comes again at the same phase. With
//! `r_i` the residual of cycle i over its phase,
//!
//! ```text
//! power that repeats = mean over pairs i, j of different cycles of <r_i, r_j>
//! ```
//!
//! whatever shape it has, and half the mean square of `r_(i+1) - r_i` is the floor of noise, free of
//! anything that repeats and of slow drift. Neighbouring cycles closer than the memory of ordinary
//! noise make no pair.

use crate::identify::chance::one_sided;
use crate::identify::tests_at_hand::TestsAtHand;

/// Points of phase that a cycle is averaged into.
const PHASES: usize = 256;
/// Cycles whose starts are closer than this make no pair, s.
const APART_S: f64 = 0.3;

/// What a residual repeats, and what it does not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeat {
    /// rms of what repeats, N.
    pub repeated_rms_n: f64,
    /// Probability of that much by chance.
    pub p_value: f64,
    /// rms of what does not, N; nothing without cycles.
    pub noise_floor_n: Option<f64>,
    /// Tests with cycles.
    pub tests: usize,
}

/// Compares cycles of all tests that have at least three.
pub fn repeat(residual_n: &[Vec<f64>], tests: &TestsAtHand) -> Repeat {
    let (mut products, mut power, mut weight) = (Vec::new(), 0.0, 0.0);
    let (mut scatter, mut scattered, mut with_cycles) = (0.0, 0usize, 0);
    for (test, residual) in tests.tests.iter().zip(residual_n) {
        let record = &test.record;
        let starts: Vec<usize> =
            record.cycles.iter().copied().filter(|at| *at >= record.run_in).collect();
        let cycles: Vec<&[f64]> =
            starts.windows(2).filter_map(|pair| residual.get(pair[0]..pair[1])).collect();
        if cycles.len() < 3 {
            continue;
        }
        with_cycles += 1;
        let shortest = cycles.iter().map(|cycle| cycle.len()).min().unwrap_or(0);
        let phases = shortest.min(PHASES);
        let folded: Vec<Vec<f64>> = cycles.iter().map(|cycle| folded(cycle, phases)).collect();
        let apart = (APART_S / (shortest as f64 * record.step_s)).ceil().max(1.0) as usize;
        let samples: usize = cycles.iter().map(|cycle| cycle.len()).sum();
        let (mut sum, mut pairs) = (0.0, 0);
        let mut of_test = Vec::new();
        for i in 0..folded.len() {
            for j in i + apart..folded.len() {
                let product = folded[i].iter().zip(&folded[j]).map(|(a, b)| a * b).sum::<f64>();
                of_test.push(product / phases as f64);
                sum += product / phases as f64;
                pairs += 1;
            }
        }
        if pairs > 0 {
            let share = samples as f64 / f64::from(pairs);
            products.extend(of_test.iter().map(|product| product * share));
            power += sum * share;
            weight += samples as f64;
        }
        for pair in cycles.windows(2) {
            let length = pair[0].len().min(pair[1].len());
            scatter += pair[0].iter().zip(pair[1]).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
            scattered += length;
        }
    }
    let repeated = if weight > 0.0 { (power / weight).max(0.0).sqrt() } else { 0.0 };
    Repeat {
        repeated_rms_n: repeated,
        p_value: one_sided(&products),
        noise_floor_n: (scattered > 0).then(|| (0.5 * scatter / scattered as f64).sqrt()),
        tests: with_cycles,
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
