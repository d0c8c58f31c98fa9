//! Sensor noise, counted in cycles.
//!
//! White Gaussian noise by Box and Muller from a `ChaCha8` stream:
//!
//! ```text
//! (g1, g2) = sqrt(-2 ln u1) (cos 2 pi u2, sin 2 pi u2)
//! ```
//!
//! Every cycle owns one block of the stream, 16 words of which 8 make four Gaussians. The noise of
//! a cycle therefore depends on seed, stream and cycle number alone: not on what was asked for
//! before, not on wall time, and there is no state to snapshot. A real amplifier's noise is not
//! white; this one is there so that nothing downstream depends on exact numbers.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Words of the stream that belong to one cycle.
const WORDS_PER_CYCLE: u128 = 16;

/// A source of Gaussian noise.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Noise {
    start: ChaCha8Rng,
}

impl Noise {
    /// The noise of a seed; streams of one seed are independent (one per rig).
    pub(crate) fn new(seed: u64, stream: u64) -> Self {
        let mut start = ChaCha8Rng::seed_from_u64(seed);
        start.set_stream(stream);
        Self { start }
    }

    /// Four independent Gaussians of mean 0 and variance 1, those of this cycle.
    pub(crate) fn at(&self, cycle: u64) -> [f64; 4] {
        let mut random = self.start.clone();
        random.set_word_pos(u128::from(cycle) * WORDS_PER_CYCLE);
        let [a, b] = pair(&mut random);
        let [c, d] = pair(&mut random);
        [a, b, c, d]
    }
}

fn pair(random: &mut ChaCha8Rng) -> [f64; 2] {
    let radius = libm::sqrt(-2.0 * libm::log(uniform(random)));
    let angle = core::f64::consts::TAU * uniform(random);
    [radius * libm::cos(angle), radius * libm::sin(angle)]
}

/// Uniform above 0 and up to 1, so that its logarithm is finite.
fn uniform(random: &mut ChaCha8Rng) -> f64 {
    ((random.next_u64() >> 11) + 1) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_variance_tails_and_independence_are_gaussian() {
        const CYCLES: u64 = 50_000;
        let noise = Noise::new(20_141, 1);
        let count = CYCLES as f64;
        let (mut mean, mut square, mut cross, mut beyond, mut lagged) = (0.0, 0.0, 0.0, 0.0, 0.0);
        let mut last = 0.0;
        for cycle in 0..CYCLES {
            let [a, b, ..] = noise.at(cycle);
            mean += a / count;
            square += a * a / count;
            cross += a * b / count;
            lagged += a * last / count;
            beyond += f64::from(u8::from(a.abs() > 2.0)) / count;
            last = a;
        }
        // Four standard errors each: 1/sqrt(N) of the mean, sqrt(2/N) of the variance.
        let error = 4.0 / libm::sqrt(count);
        assert!(mean.abs() < error, "mean {mean}");
        assert!((square - 1.0).abs() < error * libm::sqrt(2.0), "variance {square}");
        assert!(cross.abs() < error, "of one pair {cross}");
        assert!(lagged.abs() < error, "of neighbours {lagged}");
        // 4.55 % of a Gaussian lie beyond two sigma.
        assert!((beyond - 0.0455).abs() < error * 0.21, "beyond two sigma {beyond}");
    }

    #[test]
    fn the_noise_depends_on_the_cycle_alone() {
        let noise = Noise::new(1, 0);
        assert_eq!(noise.at(7), noise.at(7));
        assert_ne!(noise.at(7), noise.at(8));
    }

    #[test]
    fn rigs_of_one_seed_and_seeds_of_one_rig_differ() {
        assert_ne!(Noise::new(1, 1).at(0), Noise::new(1, 2).at(0));
        assert_ne!(Noise::new(1, 1).at(0), Noise::new(2, 1).at(0));
    }
}
