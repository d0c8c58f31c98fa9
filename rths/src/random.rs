//! Random numbers: `ChaCha8`, one seed for all and a stream for each use.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;

/// A stream of random numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Random {
    bits: ChaCha8Rng,
    /// The second Gaussian of a pair.
    spare: Option<f64>,
}

impl Random {
    /// A stream of a seed; streams do not depend on one another.
    pub(crate) fn new(seed: u64, stream: u64) -> Self {
        let mut bits = ChaCha8Rng::seed_from_u64(seed);
        bits.set_stream(stream);
        Self { bits, spare: None }
    }

    /// Uniform above 0 and up to 1.
    pub(crate) fn uniform(&mut self) -> f64 {
        ((self.bits.next_u64() >> 11) + 1) as f64 / (1_u64 << 53) as f64
    }

    /// Gaussian of mean 0 and variance 1 (Box and Muller).
    pub(crate) fn gaussian(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * libm::log(self.uniform())).sqrt();
        let (sin, cos) = libm::sincos(TAU * self.uniform());
        self.spare = Some(radius * sin);
        radius * cos
    }
}
