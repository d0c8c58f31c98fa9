//! The colour of a residual: an autoregressive model, and the filter that whitens with it.
//!
//! ```text
//! r_t = a_1 r_(t-1) + ... + a_p r_(t-p) + w_t
//! ```
//!
//! The coefficients come from Levinson's recursion on the sample autocovariance (stable by
//! construction), the order from Schwarz's criterion. The noise of a bench is coloured by filters,
//! ripple and the slow drift of an amplifier. Statistics that take its samples as independent find
//! effects in it that do not exist.

/// Highest order tried.
const HIGHEST_ORDER: usize = 16;

/// An autoregressive model of one test's residual.
#[derive(Debug, Clone, PartialEq)]
pub struct Colour {
    /// Coefficients, that of the last sample first.
    pub coefficients: Vec<f64>,
    /// rms of the whitened residual before scaling.
    pub innovation_rms: f64,
}

impl Colour {
    /// The colour of a residual.
    pub fn estimate(residual: &[f64]) -> Self {
        let n = residual.len();
        let covariance: Vec<f64> = (0..=HIGHEST_ORDER.min(n.saturating_sub(1)))
            .map(|lag| {
                let pairs = residual[lag..].iter().zip(residual);
                pairs.map(|(late, early)| late * early).sum::<f64>() / n.max(1) as f64
            })
            .collect();
        let variance = covariance.first().copied().unwrap_or(0.0);
        if variance <= 0.0 {
            return Self { coefficients: Vec::new(), innovation_rms: 0.0 };
        }
        let mut coefficients: Vec<f64> = Vec::new();
        let mut left = variance;
        let penalty = libm::log(n as f64) / n as f64;
        let mut best = (libm::log(left), coefficients.clone(), left);
        for order in 1..covariance.len() {
            let known: f64 =
                coefficients.iter().zip((1..order).rev()).map(|(a, lag)| a * covariance[lag]).sum();
            let reflection = (covariance[order] - known) / left;
            let mirrored: Vec<f64> = coefficients.iter().rev().copied().collect();
            for (a, b) in coefficients.iter_mut().zip(mirrored) {
                *a -= reflection * b;
            }
            coefficients.push(reflection);
            left *= 1.0 - reflection * reflection;
            if left <= 0.0 {
                break;
            }
            let score = libm::log(left) + order as f64 * penalty;
            if score < best.0 {
                best = (score, coefficients.clone(), left);
            }
        }
        Self { coefficients: best.1, innovation_rms: best.2.sqrt() }
    }

    /// A signal through the whitening filter, in units of the innovation; zero before its start.
    pub fn whitened(&self, signal: &[f64]) -> Vec<f64> {
        let scale = if self.innovation_rms > 0.0 { 1.0 / self.innovation_rms } else { 1.0 };
        (0..signal.len())
            .map(|i| {
                let past = signal[..i].iter().rev();
                let known: f64 = self.coefficients.iter().zip(past).map(|(a, r)| a * r).sum();
                (signal[i] - known) * scale
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    fn uniform(random: &mut ChaCha8Rng) -> f64 {
        f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5
    }

    #[test]
    fn finds_the_coefficients_and_whitens() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let (mut series, mut last, mut before) = (Vec::new(), 0.0, 0.0);
        for _ in 0..40_000 {
            let now = 1.5 * last - 0.7 * before + uniform(&mut random);
            (before, last) = (last, now);
            series.push(now);
        }
        let colour = Colour::estimate(&series);
        assert!((colour.coefficients[0] - 1.5).abs() < 0.02, "{colour:?}");
        assert!((colour.coefficients[1] + 0.7).abs() < 0.02, "{colour:?}");
        // Uniform over one: its rms is 1 / sqrt(12).
        assert!((colour.innovation_rms - 12.0_f64.sqrt().recip()).abs() < 0.003);
        let white = colour.whitened(&series);
        let neighbours = white[1..].iter().zip(&white).map(|(a, b)| a * b).sum::<f64>();
        assert!((neighbours / white.len() as f64).abs() < 0.02);
    }
}
