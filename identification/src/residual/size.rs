//! Does the size of the residual follow the force?
//!
//! Noise of the load cell knows nothing of the force. A valve that switches, an oil that warms or a
//! current that was not recorded makes a residual that grows with the force, whatever the motion.
//! So the rms of the residual in short blocks is compared with that of the force of the model, by
//! rank, and the correlation with that after circular shifts of the blocks, which keep the order of
//! both.
//!
//! A bench makes such a correlation too. Four errors are passed through the model and taken off
//! before the comparison, each up to a limit:
//!
//! ```text
//! c_k^2 = a + b X_k^2 + d T_k^2 + g F_k^2 + m A_k^2         rank correlation of r_k / c_k with F_k
//!   X_k   change of the force by noise of the displacement of the size that the record shows
//!   T_k   the same by jitter of the clock of a tenth of a sample
//!   F_k   rms force: an error of the gain of at most one per cent
//!   A_k   change of the force by a moving mean of 4 ms: a recorder that filters rounds its corners
//! ```
//!
//! with a for each test and b, d, g, m for all, fitted to the blocks by maximum likelihood of their
//! variances.
//!
//! Limits: under one amplitude the force is the same in every block, and nothing can be compared.

use super::question::Answer;
use super::ranks::{correlation, ranks};
use crate::fit::Fit;
use crate::simulation::simulate;
use crate::test_set::{Test, TestSet};
use firmware_core::damper::Damper;
use measurement::noise::white;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;
use signal::statistics::{moving_mean, percentile, rms};

/// Blocks of a test.
const BLOCKS: usize = 120;
/// Fewest blocks of a test that count.
const FEWEST_BLOCKS: usize = 20;
/// Fewest samples of a block.
const FEWEST_SAMPLES: usize = 6;
/// Circular shifts that chance is judged with.
const SHIFTS: u32 = 499;
/// Large over small force of the blocks of a test from which their sizes can be compared.
const LEAST_RANGE: f64 = 1.5;
/// Standard deviation of the jitter of a clock, in samples, that is the bench's own.
const JITTER: f64 = 0.1;
/// Error of the gain that is the bench's own.
const GAIN: f64 = 0.01;
/// Length of the moving mean of a recorder that filters, s.
const AVERAGED_S: f64 = 4e-3;
/// Multiple of the noise of the displacement that its samples show.
const MORE_NOISE: f64 = 2.0;
/// Iterations of the fit of the bench's share.
const ITERATIONS: usize = 200;
/// Seed of the noises and of the shifts.
const SEED: u64 = 0x5129_0001;

/// How the size of the residual follows the force.
#[derive(Debug, Clone, PartialEq)]
pub struct Size {
    /// Yes where the correlation is not chance; see [`Size::is_below`].
    pub answer: Answer,
    /// Rank correlation, over all tests, of the residual beyond the bench's share with the force.
    pub correlation: f64,
    /// Probability of that much by chance.
    pub p_value: f64,
    /// Share of the squared residual that jitter, gain and filter may make: errors that a bench may
    /// have and that nothing in the records shows.
    pub by_the_bench: f64,
}

/// A rank correlation from which most of the residual follows the force.
const STRONG: f64 = 0.3;
/// A weaker correlation may be the bench's own: a filter, a mounting.
const LEAST_CORRELATION: f64 = 0.15;
/// Largest probability of a correlation by chance.
const LARGEST_P: f64 = 0.01;

impl Size {
    fn not_tested(why: &str) -> Self {
        Self {
            answer: Answer::NotTested(why.to_owned()),
            correlation: 0.0,
            p_value: 1.0,
            by_the_bench: 0.0,
        }
    }

    /// True where most of the residual follows the force.
    pub(crate) fn is_strong(&self) -> bool {
        self.answer == Answer::Yes && self.correlation.abs() > STRONG
    }

    /// True where the correlation is tested, not weak, and less probable than `p` by chance.
    pub fn is_below(&self, p: f64) -> bool {
        self.answer.is_tested() && self.p_value < p && self.correlation.abs() >= LEAST_CORRELATION
    }
}

/// The blocks of a test.
struct Blocks {
    /// Mean square of the residual, N2.
    residual: Vec<f64>,
    /// Mean square of what each error of the bench makes, N2.
    bench: [Vec<f64>; 4],
    /// rms of the model's force, N.
    force_n: Vec<f64>,
}

/// Asks whether the size of a residual follows the force.
pub(crate) fn size(fit: &Fit, residual_n: &[Vec<f64>], tests: &TestSet) -> Option<Size> {
    let damper = fit.model.damper(&fit.values)?;
    let blocks: Vec<Blocks> = tests
        .tests
        .par_iter()
        .enumerate()
        .filter_map(|(index, test)| {
            Blocks::of(
                &damper,
                test,
                (&fit.force_n[index], fit.starts_m[index]),
                &residual_n[index],
                index,
            )
        })
        .collect();
    if blocks.is_empty() {
        return Some(Size::not_tested("the force is of one size throughout every test"));
    }
    let (excess, by_the_bench) = beyond_the_bench(&blocks);
    let ranked: Vec<(Vec<f64>, Vec<f64>)> = blocks
        .iter()
        .zip(&excess)
        .map(|(blocks, excess)| (ranks(excess), ranks(&blocks.force_n)))
        .collect();
    let correlation = |shift: &mut dyn FnMut(usize) -> usize| {
        let (mut sum, mut count) = (0.0, 0.0);
        for (residual, force) in &ranked {
            let by = shift(residual.len());
            sum += residual.len() as f64 * correlation(residual, force, by);
            count += residual.len() as f64;
        }
        sum / count
    };
    let found = correlation(&mut |_| 0);
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut shift = |blocks: usize| 1 + random.next_u32() as usize % (blocks - 1);
    let larger = (0..SHIFTS).filter(|_| correlation(&mut shift).abs() >= found.abs()).count();
    let p_value = (larger + 1) as f64 / f64::from(SHIFTS + 1);
    let strong_enough = found.abs() >= LEAST_CORRELATION;
    let answer = if strong_enough && p_value < LARGEST_P { Answer::Yes } else { Answer::No };
    Some(Size { answer, correlation: found, p_value, by_the_bench })
}

impl Blocks {
    /// None where the force of the blocks hardly differs.
    fn of(
        damper: &Damper,
        test: &Test,
        (force_n, start_m): (&[f64], f64),
        residual_n: &[f64],
        index: usize,
    ) -> Option<Self> {
        let counted = test.counted();
        let length = (counted.len() / BLOCKS).max(FEWEST_SAMPLES);
        let of = |values: &[f64]| -> Vec<f64> {
            let square = |block: &[f64]| rms(block) * rms(block);
            values[counted.clone()].chunks_exact(length).map(square).collect()
        };
        let force: Vec<f64> = of(force_n).into_iter().map(f64::sqrt).collect();
        let ends = [0.1, 0.9].map(|share| percentile(&force, share));
        let [Some(small), Some(large)] = ends else { return None };
        if force.len() < FEWEST_BLOCKS || large < LEAST_RANGE * small {
            return None;
        }
        let noise = noises(test, index);
        let through = |displacement_m: Vec<f64>| -> Vec<f64> {
            let other = test.with_displacement(displacement_m);
            let moved_n = simulate(damper, &other, start_m);
            moved_n.iter().zip(force_n).map(|(moved, force)| moved - force).collect()
        };
        let record = &test.record;
        let size_m =
            MORE_NOISE * white::third_difference_rms(&record.displacement_m).unwrap_or(0.0);
        let of_noise = through(added(&record.drive_m, &noise[0], |_| size_m));
        let late_s = JITTER * record.step_s;
        let jitter = added(&record.drive_m, &noise[1], |i| late_s * record.velocity_m_per_s[i]);
        let of_jitter: Vec<f64> = through(jitter)
            .iter()
            .enumerate()
            .map(|(i, moved_n)| {
                let (before, after) = (i.saturating_sub(1), (i + 1).min(force_n.len() - 1));
                let rate = (force_n[after] - force_n[before]) / (2.0 * record.step_s);
                moved_n - rate * late_s * noise[1][i]
            })
            .collect();
        let of_gain: Vec<f64> = force_n.iter().map(|force| GAIN * force).collect();
        let half = (0.5 * AVERAGED_S / record.step_s).round() as usize;
        let averaged = moving_mean(force_n, half);
        let of_corners: Vec<f64> =
            force_n.iter().zip(&averaged).map(|(f, mean)| f - mean).collect();
        let bench = [of(&of_noise), of(&of_jitter), of(&of_gain), of(&of_corners)];
        Some(Self { residual: of(residual_n), bench, force_n: force })
    }
}

/// Two white noises of unit variance for a test.
fn noises(test: &Test, index: usize) -> [Vec<f64>; 2] {
    let mut random = ChaCha8Rng::seed_from_u64(SEED.wrapping_add(index as u64));
    let mut uniform = || f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5;
    // Four uniform numbers are normal enough for a root mean square.
    let mut noise = || {
        (0..test.record.len())
            .map(|_| (0..4).map(|_| uniform()).sum::<f64>() * 3.0_f64.sqrt())
            .collect()
    };
    [noise(), noise()]
}

fn added(values: &[f64], noise: &[f64], size: impl Fn(usize) -> f64) -> Vec<f64> {
    values
        .iter()
        .zip(noise)
        .enumerate()
        .map(|(i, (value, noise))| value + size(i) * noise)
        .collect()
}

/// Mean square of the residual of every block over the bench's share of it, and the share of all
/// that is made by errors of the bench that nothing shows: the last three.
fn beyond_the_bench(tests: &[Blocks]) -> (Vec<Vec<f64>>, f64) {
    let mean = |values: &[f64]| signal::statistics::mean(values).max(f64::MIN_POSITIVE);
    let mut own: Vec<f64> = tests.iter().map(|test| mean(&test.residual)).collect();
    let mut shares = [0.5_f64; 4];
    let expected = |test: &Blocks, own: f64, shares: &[f64; 4], k: usize| {
        own + shares.iter().zip(&test.bench).map(|(share, bench)| share * bench[k]).sum::<f64>()
    };
    for _ in 0..ITERATIONS {
        // Multiplicative steps towards the maximum likelihood of the variances; none can change
        // its sign.
        let mut ratio = [(0.0, 0.0); 4];
        for (test, own) in tests.iter().zip(&mut own) {
            let (mut up, mut down) = (0.0, 0.0);
            for (k, residual) in test.residual.iter().enumerate() {
                let c = expected(test, *own, &shares, k).max(f64::MIN_POSITIVE);
                up += residual / (c * c);
                down += 1.0 / c;
                for (ratio, bench) in ratio.iter_mut().zip(&test.bench) {
                    ratio.0 += bench[k] * residual / (c * c);
                    ratio.1 += bench[k] / c;
                }
            }
            *own *= if down > 0.0 { up / down } else { 1.0 };
        }
        for (share, (up, down)) in shares.iter_mut().zip(ratio) {
            *share = if down > 0.0 { (*share * up / down).min(1.0) } else { 0.0 };
        }
    }
    let excess = tests.iter().zip(&own).map(|(test, own)| {
        let each = test.residual.iter().enumerate();
        each.map(|(k, residual)| residual / expected(test, *own, &shares, k).max(f64::MIN_POSITIVE))
            .collect()
    });
    let (mut unseen, mut all) = (0.0, 0.0);
    for (test, own) in tests.iter().zip(&own) {
        for k in 0..test.residual.len() {
            let of = |error: usize| shares[error] * test.bench[error][k];
            unseen += (1..4).map(of).sum::<f64>();
            all += expected(test, *own, &shares, k);
        }
    }
    (excess.collect(), if all > 0.0 { unseen / all } else { 0.0 })
}
