//! The difference of a residual between cycles of equal motion: noise, or something that changes?
//!
//! Noise of the load cell has one size throughout a cycle. A valve that switches, or a current that
//! was not recorded, changes the force by a share of it, so the difference between cycles is large
//! where the force is. With the mean squares of difference and force over a twelfth of a cycle,
//!
//! ```text
//! d^2 = a + s F^2          a for each test, s for all, by least squares
//! ```
//!
//! the difference grows with the force where the ranks of both correlate beyond chance, `s`
//! explains half of the squared difference, and the change of the gain `sqrt(s / 2)` is more than
//! 0.2 %, which a bench may make by itself.
//!
//! Limits: noise of the displacement grows with the slope of the force and not with the force; a
//! change that comes back in every cycle is no difference.

use super::ranks::{correlation, ranks};
use signal::statistics::{mean, robust_rms};

/// Parts of a cycle.
const PARTS: usize = 12;
/// Differences beyond this multiple of their robust standard deviation are outliers, if no more
/// than this share of all is.
const OUTLIER: f64 = 6.0;
const MOST_OUTLIERS: f64 = 0.01;
/// Least rank correlation, in itself and in standard errors.
const LEAST_CORRELATION: f64 = 0.25;
const STANDARD_ERRORS: f64 = 2.5;
/// Share of the squared difference that has to grow.
const LEAST_SHARE: f64 = 0.5;
/// Change of the gain from cycle to cycle that is the bench's own.
const GAIN: f64 = 0.002;

/// The difference between two cycles at one phase.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Difference {
    /// Difference of the residual, N.
    pub n: f64,
    /// Mean of the measured forces, N.
    pub force_n: f64,
}

/// Differences of all pairs of cycles.
#[derive(Debug, Clone, Default)]
pub(crate) struct Differences {
    square_n2: f64,
    count: usize,
    /// Mean squares of difference and force over parts of cycles, test by test, N2.
    parts: Vec<Vec<(f64, f64)>>,
}

impl Differences {
    /// Adds the pairs of a test.
    pub(crate) fn add(&mut self, pairs: impl Iterator<Item = Vec<Difference>>) {
        let pairs: Vec<Vec<Difference>> = pairs.collect();
        let sizes: Vec<f64> = pairs.iter().flatten().map(|difference| difference.n.abs()).collect();
        let robust_n = robust_rms(&sizes).unwrap_or(0.0);
        let is_outlier = |size: f64| size > OUTLIER * robust_n;
        let outliers = sizes.iter().filter(|size| is_outlier(**size)).count();
        let few = outliers as f64 <= MOST_OUTLIERS * sizes.len() as f64;
        for size in sizes.iter().filter(|size| !(few && is_outlier(**size))) {
            self.square_n2 += size * size;
            self.count += 1;
        }
        let part = |part: &[Difference]| {
            let square = |of: fn(&Difference) -> f64| {
                part.iter().map(|one| of(one) * of(one)).sum::<f64>() / part.len() as f64
            };
            (square(|one| one.n), square(|one| one.force_n))
        };
        let parts = pairs.iter().flat_map(|pair| pair.chunks(pair.len().div_ceil(PARTS).max(1)));
        self.parts.push(parts.map(part).collect());
    }

    /// Mean square of the differences, N2; none where there is none.
    pub(crate) fn mean_square_n2(&self) -> Option<f64> {
        (self.count > 0).then(|| self.square_n2 / self.count as f64)
    }

    /// rms of the part of a cycle that changes with the force, N; none where the differences do not
    /// grow with it.
    pub(crate) fn growing_n(&self) -> Option<f64> {
        let (mut rank_sum, mut count) = (0.0, 0.0);
        let (mut along, mut across) = (0.0, 0.0);
        let (mut all_n2, mut force_n2) = (0.0, 0.0);
        for parts in self.parts.iter().filter(|parts| parts.len() >= PARTS) {
            let (differences, forces): (Vec<f64>, Vec<f64>) = parts.iter().copied().unzip();
            rank_sum += parts.len() as f64 * correlation(&ranks(&differences), &ranks(&forces), 0);
            count += parts.len() as f64;
            let (mean_d, mean_f) = (mean(&differences), mean(&forces));
            for (d, f) in parts {
                along += (d - mean_d) * (f - mean_f);
                across += (f - mean_f) * (f - mean_f);
            }
            all_n2 += differences.iter().sum::<f64>();
            force_n2 += forces.iter().sum::<f64>();
        }
        if count == 0.0 || across <= 0.0 || all_n2 <= 0.0 {
            return None;
        }
        let by_rank = rank_sum / count;
        let slope = along / across;
        let grows = by_rank > LEAST_CORRELATION
            && by_rank * f64::sqrt(count) > STANDARD_ERRORS
            && slope * force_n2 > LEAST_SHARE * all_n2
            && slope > 2.0 * GAIN * GAIN;
        grows.then(|| (0.5 * slope * force_n2 / count).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    /// Eight pairs of cycles of 10 kN, with noise of 100 N and a gain that differs by so much.
    fn differences(gain: f64, odd: &[f64]) -> Differences {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut normal = move || {
            (0..12).map(|_| f64::from(random.next_u32()) / 4_294_967_296.0).sum::<f64>() - 6.0
        };
        let pairs = (0..8).map(|pair| {
            let sign = if pair % 3 == 0 { 0.0 } else { 1.0 };
            let each = (0..1000).map(|n| {
                let force_n = 1e4 * libm::sin(std::f64::consts::TAU * f64::from(n) * 1e-3);
                let noise_n = 100.0 * f64::sqrt(2.0) * normal();
                Difference { n: noise_n + sign * gain * force_n, force_n }
            });
            let mut pair: Vec<Difference> = each.collect();
            for (one, odd) in pair.iter_mut().zip(odd) {
                one.n += odd;
            }
            pair
        });
        let pairs: Vec<Vec<Difference>> = pairs.collect();
        let mut differences = Differences::default();
        differences.add(pairs.into_iter());
        differences
    }

    fn floor_n(differences: &Differences) -> f64 {
        (0.5 * differences.mean_square_n2().unwrap()).sqrt()
    }

    #[test]
    fn noise_of_the_load_cell_does_not_grow_with_the_force() {
        let noise = differences(0.0, &[]);
        assert!(noise.growing_n().is_none());
        assert!((floor_n(&noise) - 100.0).abs() < 3.0, "{}", floor_n(&noise));
    }

    #[test]
    fn a_valve_that_switches_between_cycles_was_a_noise_floor() {
        // Five of eight pairs differ by 12 % of 7071 N rms.
        let growing_n = differences(0.12, &[]).growing_n().unwrap();
        assert!((growing_n - 0.12 * 7071.0 * (0.5_f64 * 0.625).sqrt()).abs() < 20.0, "{growing_n}");
        assert!(differences(0.04, &[]).growing_n().is_some());
        // A gain that differs by a thousandth is the bench's own.
        assert!(differences(0.001, &[]).growing_n().is_none());
    }

    #[test]
    fn a_few_samples_at_the_start_do_not_make_the_floor() {
        let started = differences(0.0, &[2500.0, -1200.0]);
        assert!((floor_n(&started) - 100.0).abs() < 3.0, "{}", floor_n(&started));
    }
}
