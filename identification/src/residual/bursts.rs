//! Is much of the residual in a few short stretches?
//!
//! Noise of a bench goes on through the whole record. A stop that is touched twice, a void that
//! opens in one stroke, or a cable, leaves its residual in a few short stretches. The residual is
//! whitened by its own colour, so that a slow drift does not swell in places, and its energy is
//! compared block by block (1/120 of a test, at least 10 samples):
//!
//! ```text
//! burst      energy above 10 times the median of the test: for white noise beyond one in 10^12
//! reported   bursts hold more than a fifth of the squared residual, in less than a twentieth of
//!            the blocks
//! ```
//!
//! Limits: corners of the force that a filter of the bench has rounded come with every stroke, in
//! more blocks than that; glitches of a logger are bursts, too.

use crate::colour::Colour;
use crate::test_set::TestSet;
use signal::statistics::percentile;

/// Blocks of a test.
const BLOCKS: usize = 120;
/// Fewest samples of a block.
const FEWEST_SAMPLES: usize = 10;
/// Energy of a burst, in multiples of the median.
const BURST: f64 = 10.0;
/// Share of the squared residual that bursts hold.
const LEAST_SHARE: f64 = 0.2;
/// Share of the blocks that they are.
const MOST_BLOCKS: f64 = 0.05;

/// Short stretches that hold much of the residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bursts {
    /// Their share of the squared residual.
    pub share: f64,
    /// Their duration, s.
    pub duration_s: f64,
    /// Duration of all tests, s.
    pub of_s: f64,
    /// The test with the largest.
    pub test: usize,
    /// The middle of the largest, as a sample of its test.
    pub largest_at: usize,
}

/// Looks for bursts; none where the residual is as large everywhere.
pub(crate) fn bursts(residual_n: &[Vec<f64>], tests: &TestSet) -> Option<Bursts> {
    let mut found = Bursts { share: 0.0, duration_s: 0.0, of_s: 0.0, test: 0, largest_at: 0 };
    let (mut held, mut whole) = (0.0, 0.0);
    let (mut count, mut blocks, mut largest) = (0.0, 0.0, 0.0);
    let square = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
    for (index, (test, residual)) in tests.tests.iter().zip(residual_n).enumerate() {
        let counted = test.counted();
        let plain = &residual[counted.clone()];
        let white = Colour::estimate(plain).whitened(plain);
        let length = (plain.len() / BLOCKS).max(FEWEST_SAMPLES);
        let energies: Vec<f64> = white.chunks_exact(length).map(square).collect();
        let Some(median) = percentile(&energies, 0.5) else { continue };
        let unit = median.max(f64::MIN_POSITIVE);
        for (k, energy) in energies.iter().enumerate() {
            let own = square(&plain[k * length..(k + 1) * length]);
            (whole, blocks) = (whole + own, blocks + 1.0);
            if *energy <= BURST * median {
                continue;
            }
            (held, count) = (held + own, count + 1.0);
            found.duration_s += length as f64 * test.record.step_s;
            // A test with more noise counts as much as another.
            if energy / unit > largest {
                largest = energy / unit;
                (found.test, found.largest_at) = (index, counted.start + k * length + length / 2);
            }
        }
        found.of_s += plain.len() as f64 * test.record.step_s;
    }
    found.share = if whole > 0.0 { held / whole } else { 0.0 };
    let few = count < MOST_BLOCKS * blocks;
    (few && found.share > LEAST_SHARE).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use measurement::{Measurement, Series};
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    fn tests() -> TestSet {
        let wave = |n: usize| 1e-3 * libm::sin(0.02 * n as f64);
        let x: Vec<f64> = (0..6000).map(wave).collect();
        let series = Series::sampled("a", 1e3, x.clone(), x.iter().map(|x| 1e7 * x).collect());
        TestSet::new(vec![Measurement::from_series(series).unwrap()])
    }

    fn noise() -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(4);
        (0..6000).map(|_| f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5).collect()
    }

    #[test]
    fn noise_has_no_bursts() {
        assert_eq!(bursts(&[noise()], &tests()), None);
    }

    #[test]
    fn a_blow_is_found_where_it_is() {
        let mut residual = noise();
        for (n, value) in residual[4000..4060].iter_mut().enumerate() {
            *value += if n % 3 == 0 { 8.0 } else { -6.0 };
        }
        let found = bursts(&[residual], &tests()).unwrap();
        assert!((3980..4080).contains(&found.largest_at), "{found:?}");
        assert!(found.share > 0.8 && found.duration_s < 0.2, "{found:?}");
    }
}
