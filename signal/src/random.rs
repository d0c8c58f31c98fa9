//! Random numbers: `ChaCha8`, one seed for all and a stream for each use of it.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;

/// A stream of random numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Random {
    bits: ChaCha8Rng,
    /// The second Gaussian of a pair.
    spare: Option<f64>,
}

impl Random {
    /// A stream of a seed; streams do not depend on one another.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut bits = ChaCha8Rng::seed_from_u64(seed);
        bits.set_stream(stream);
        Self { bits, spare: None }
    }

    /// A seed of its own for the part of this number.
    ///
    /// ```
    /// use signal::random::Random;
    /// assert_ne!(Random::seed_of(1, 0), Random::seed_of(1, 1));
    /// ```
    pub fn seed_of(seed: u64, part: u64) -> u64 {
        Self::new(seed, part).bits.next_u64()
    }

    /// Uniform above 0 and up to 1.
    pub fn uniform(&mut self) -> f64 {
        ((self.bits.next_u64() >> 11) + 1) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform between two values.
    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.uniform()
    }

    /// A phase, rad.
    pub fn phase(&mut self) -> f64 {
        TAU * self.uniform()
    }

    /// Gaussian of mean 0 and variance 1 (Box and Muller).
    pub fn gaussian(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * libm::log(self.uniform())).sqrt();
        let angle = self.phase();
        self.spare = Some(radius * libm::sin(angle));
        radius * libm::cos(angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaussians_have_mean_variance_and_tails() {
        let mut random = Random::new(20_141, 3);
        let count = 200_000;
        let values: Vec<f64> = (0..count).map(|_| random.gaussian()).collect();
        let mean = crate::statistics::mean(&values);
        let square = crate::statistics::rms(&values).powi(2);
        let beyond = values.iter().filter(|v| v.abs() > 2.0).count() as f64 / f64::from(count);
        // Four standard deviations of each estimate.
        assert!(mean.abs() < 0.009, "{mean}");
        assert!((square - 1.0).abs() < 0.013, "{square}");
        assert!((beyond - 0.0455).abs() < 0.002, "{beyond}");
    }
}
