//! Periods of a record: found, averaged, and compared with each other for the noise.

/// Shortest period, samples.
const SHORTEST: usize = 16;
/// rms difference of two periods of the force over the rms force, up to which they are the same.
const SAME: f64 = 0.03;
/// Difference that shows that the force has changed at all within a period.
const OTHER: f64 = 0.5;
/// Samples that a first comparison uses.
const FEW: usize = 500;
/// Ratio of the difference of the first period to that of the others beyond which it is a
/// transient.
const TRANSIENT: f64 = 1.5;

/// A record folded into one period.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Folded {
    /// Mean force of every sample of the period, N.
    pub(super) force_n: Vec<f64>,
    /// Mean motion.
    pub(super) motion: Vec<f64>,
    /// Periods in the mean.
    pub(super) periods: usize,
    /// rms deviation of a single period from the others, where there are two or more.
    pub(super) noise: Option<f64>,
    /// The first period was left out.
    pub(super) transient: bool,
}

/// Averages the last whole periods of a record. The first of three or more is left out where it
/// differs from the others by more than they differ from each other.
pub(super) fn fold(force_n: &[f64], motion: &[f64], period: usize) -> Folded {
    debug_assert!(period > 0 && period <= motion.len(), "a period of {period} samples");
    let whole = motion.len() / period;
    let skipped = motion.len() - whole * period;
    let chunks = |values: &[f64], first: usize| -> Vec<Vec<f64>> {
        values[skipped..].chunks_exact(period).skip(first).map(<[f64]>::to_vec).collect()
    };
    let transient = whole >= 3 && {
        let all = chunks(motion, 0);
        let later = &all[1..];
        let (mean, noise) = (mean(later), scatter(later));
        let first = rms(all[0].iter().zip(&mean).map(|(one, mean)| one - mean));
        let expected = noise * libm::sqrt(1.0 + 1.0 / later.len() as f64);
        first > TRANSIENT * expected
    };
    let first = usize::from(transient);
    let kept = chunks(motion, first);
    Folded {
        force_n: mean(&chunks(force_n, first)),
        motion: mean(&kept),
        periods: kept.len(),
        noise: (kept.len() > 1).then(|| scatter(&kept)),
        transient,
    }
}

/// The period of a force in samples, if it repeats itself twice or more.
pub(super) fn period_of(force_n: &[f64]) -> Option<usize> {
    let count = force_n.len();
    let mean = force_n.iter().sum::<f64>() / count as f64;
    let size = rms(force_n.iter().map(|force| force - mean));
    if size.is_nan() || size <= 0.0 {
        return None;
    }
    let difference = |period: usize, stride: usize| {
        let pairs = force_n.iter().zip(&force_n[period..]).step_by(stride);
        rms(pairs.map(|(early, late)| late - early)) / size
    };
    let stride = (count / 2).div_ceil(FEW);
    let mut changed = false;
    let mut best: Option<(usize, f64)> = None;
    for period in 1..=count / 2 {
        let now = difference(period, stride);
        changed |= now > OTHER;
        match best {
            Some((_, least)) if now < least => best = Some((period, now)),
            // Past the minimum.
            Some(_) => break,
            None if changed && period >= SHORTEST && now < SAME => best = Some((period, now)),
            None => {}
        }
    }
    best.map(|(period, _)| period).filter(|period| difference(*period, 1) < SAME)
}

fn mean(periods: &[Vec<f64>]) -> Vec<f64> {
    let length = periods.first().map_or(0, Vec::len);
    let at = |sample: usize| periods.iter().map(|period| period[sample]).sum::<f64>();
    (0..length).map(|sample| at(sample) / periods.len() as f64).collect()
}

/// rms deviation of single periods, without the bias of their own mean.
fn scatter(periods: &[Vec<f64>]) -> f64 {
    let mean = mean(periods);
    let deviations =
        periods.iter().flat_map(|period| period.iter().zip(&mean).map(|(one, mean)| one - mean));
    let count = periods.len() as f64;
    rms(deviations) * libm::sqrt(count / (count - 1.0))
}

/// Root of the mean square.
pub(super) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) =
        values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    libm::sqrt(sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};
    use std::f64::consts::TAU;

    /// Uniform in -1 to 1.
    fn draw(random: &mut ChaCha8Rng) -> f64 {
        f64::from(random.next_u32()) / f64::from(u32::MAX) * 2.0 - 1.0
    }

    #[test]
    fn periods_over_each_other_show_the_noise_and_the_transient() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let period = 500;
        let force: Vec<f64> = (0..5 * period)
            .map(|n| {
                let t = TAU * n as f64 / period as f64;
                libm::sin(3.0 * t) + libm::cos(7.0 * t)
            })
            .collect();
        assert_eq!(period_of(&force), Some(period));
        let motion: Vec<f64> = force.iter().map(|f| f + 0.1 * draw(&mut random)).collect();
        let folded = fold(&force, &motion, period);
        let sigma = 0.1 / libm::sqrt(3.0);
        assert!((folded.noise.unwrap() / sigma - 1.0).abs() < 0.03, "{folded:?}");
        assert_eq!((folded.periods, folded.transient), (5, false));
        let mut beginning = motion.clone();
        for (n, value) in beginning.iter_mut().enumerate().take(period) {
            *value += libm::exp(-0.02 * n as f64);
        }
        let folded = fold(&force, &beginning, period);
        assert_eq!((folded.periods, folded.transient), (4, true));
    }

    #[test]
    fn a_slow_force_and_a_sweep_are_not_periodic() {
        let sweep: Vec<f64> =
            (0..4000).map(|n| libm::sin(1e-5 * f64::from(n) * f64::from(n))).collect();
        assert_eq!(period_of(&sweep), None);
        let ramp: Vec<f64> = (0..400).map(f64::from).collect();
        assert_eq!(period_of(&ramp), None);
        assert_eq!(period_of(&[3.0; 100]), None);
        let sine: Vec<f64> = (0..4000).map(|n| libm::sin(TAU * f64::from(n) / 800.0)).collect();
        assert_eq!(period_of(&sine), Some(800));
    }
}
