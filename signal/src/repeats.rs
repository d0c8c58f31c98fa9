//! Repeats of a measurement: their spread, and the difference of two sets of them.
//!
//! ```text
//! d = mean(b) - mean(a)        e_a = s_a^2 / n_a,  e_b = s_b^2 / n_b
//! d +- t(0.975, v) sqrt(e_a + e_b)
//! v = (e_a + e_b)^2 / (e_a^2 / (n_a - 1) + e_b^2 / (n_b - 1))
//! ```
//! The interval is Welch's (The generalization of "Student's" problem, Biometrika 34, 1947), for
//! sets whose variances may differ. Where many differences are judged at once, some are far from
//! zero by chance; Holm's procedure (A simple sequentially rejective multiple test procedure,
//! Scandinavian Journal of Statistics 6, 1979) keeps the probability of one wrong claim or more at
//! the level, whether or not the differences depend on one another.
//!
//! Limits: repeats are taken as normally distributed and independent. Two or three of them say
//! little about a variance, and the interval is as wide as that.

use crate::statistics::{mean, min_max};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Some repeats of one quantity, in its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeats {
    /// How many.
    pub count: usize,
    /// Their mean.
    pub mean: f64,
    /// Standard deviation of one repeat, with n - 1; none of a single one.
    pub deviation: Option<f64>,
    /// Least and greatest.
    pub range: (f64, f64),
}

impl Repeats {
    /// Of these values; none of no value.
    ///
    /// ```
    /// use signal::repeats::Repeats;
    /// let found = Repeats::of(&[9.0, 10.0, 11.0]).unwrap();
    /// assert_eq!((found.mean, found.deviation), (10.0, Some(1.0)));
    /// ```
    pub fn of(values: &[f64]) -> Option<Self> {
        let range = min_max(values)?;
        let (count, mean) = (values.len(), mean(values));
        let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
        let deviation = (count > 1).then(|| (squares / (count - 1) as f64).sqrt());
        Some(Self { count, mean, deviation, range })
    }

    /// Variance of the mean; none of a single repeat.
    fn variance_of_mean(&self) -> Option<f64> {
        Some(self.deviation?.powi(2) / self.count as f64)
    }
}

/// The difference of the means of two sets of repeats, by Welch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanDifference {
    /// Mean of the second set less that of the first.
    pub difference: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Degrees of freedom of that.
    pub freedom: f64,
    /// Probability of a difference at least as large, to either side, where there is none.
    pub p: f64,
}

impl MeanDifference {
    /// Of the second set from the first; none where one of them has no spread, and where neither
    /// varies at all: values that are equal to the last bit do not say how well they repeat.
    ///
    /// ```
    /// use signal::repeats::{MeanDifference, Repeats};
    /// let [new, worn] = [[9.0, 10.0, 11.0], [13.0, 14.0, 15.0]];
    /// let [new, worn] = [new, worn].map(|values| Repeats::of(&values).unwrap());
    /// let found = MeanDifference::between(&new, &worn).unwrap();
    /// // Four degrees of freedom: t = 2.776, and an error of sqrt(2/3).
    /// let [low, high] = found.interval(0.05);
    /// assert!((low - (4.0 - 2.2669)).abs() < 1e-3 && (high - (4.0 + 2.2669)).abs() < 1e-3);
    /// ```
    pub fn between(first: &Repeats, second: &Repeats) -> Option<Self> {
        let (one, other) = (first.variance_of_mean()?, second.variance_of_mean()?);
        let variance = one + other;
        if variance <= 0.0 || !variance.is_finite() {
            return None;
        }
        let part = |variance: f64, count: usize| variance * variance / (count - 1) as f64;
        let freedom = variance * variance / (part(one, first.count) + part(other, second.count));
        let (difference, standard_error) = (second.mean - first.mean, variance.sqrt());
        let student = StudentsT::new(0.0, 1.0, freedom).ok()?;
        let p = (2.0 * student.sf((difference / standard_error).abs())).min(1.0);
        Some(Self { difference, standard_error, freedom, p })
    }

    /// The interval that holds the true difference but for a probability of `level`.
    pub fn interval(&self, level: f64) -> [f64; 2] {
        debug_assert!((0.0..1.0).contains(&level), "a level of {level}");
        let factor = StudentsT::new(0.0, 1.0, self.freedom)
            .map_or(f64::INFINITY, |student| student.inverse_cdf(1.0 - 0.5 * level));
        let half = factor * self.standard_error;
        [self.difference - half, self.difference + half]
    }
}

/// Holm's adjusted probabilities, in the order of `p`: those at most as large as a level are
/// claimed at that level for all together.
///
/// ```
/// // By hand: 3 x 0.01, then the larger of that and 2 x 0.02, then of that and 1 x 0.5.
/// assert_eq!(signal::repeats::holm(&[0.5, 0.01, 0.02]), [0.5, 0.03, 0.04]);
/// ```
pub fn holm(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|a, b| p[*a].total_cmp(&p[*b]));
    let (mut adjusted, mut largest) = (vec![0.0; p.len()], 0.0_f64);
    for (rank, index) in order.into_iter().enumerate() {
        largest = largest.max((p.len() - rank) as f64 * p[index]).min(1.0);
        adjusted[index] = largest;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Extra hours of sleep with two drugs: Student, The probable error of a mean, Biometrika 6,
    /// 1908; data set `sleep` of R.
    const SLEEP: [[f64; 10]; 2] = [
        [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0],
        [1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4],
    ];

    #[test]
    fn welch_of_the_sleep_data_is_that_of_r() {
        // `t.test(extra ~ group, data = sleep)`, as R's manual prints it.
        let [one, other] = SLEEP.map(|values| Repeats::of(&values).unwrap());
        let found = MeanDifference::between(&one, &other).unwrap();
        assert!((one.mean - 0.75).abs() < 1e-12 && (other.mean - 2.33).abs() < 1e-12);
        assert!((found.difference / found.standard_error - 1.8608).abs() < 5e-5, "{found:?}");
        assert!((found.freedom - 17.776).abs() < 5e-4, "{found:?}");
        assert!((found.p - 0.07939).abs() < 5e-6, "{found:?}");
        let [low, high] = found.interval(0.05);
        assert!((low + 0.205_483_2).abs() < 1e-6 && (high - 3.365_483_2).abs() < 1e-6);
    }

    #[test]
    fn quantiles_are_those_of_the_table() {
        // Two sets of n with the same spread have 2 (n - 1) degrees of freedom; quantiles of
        // Student's t at 0.975 from any table.
        for (count, quantile) in [(2, 4.302_65), (3, 2.776_45), (4, 2.446_91), (6, 2.228_14)] {
            let freedom = 2.0 * f64::from(count - 1);
            let unit = MeanDifference { difference: 0.0, standard_error: 1.0, freedom, p: 1.0 };
            let [low, high] = unit.interval(0.05);
            assert!((high - quantile).abs() < 1e-5 && low == -high, "{freedom}: {high}");
        }
    }

    #[test]
    fn what_has_no_spread_has_no_interval() {
        let of = |values: &[f64]| Repeats::of(values).unwrap();
        let (one, three, equal) = (of(&[1.0]), of(&[1.0, 2.0, 3.0]), of(&[5.0, 5.0]));
        assert_eq!(MeanDifference::between(&one, &three), None);
        assert_eq!(MeanDifference::between(&three, &one), None);
        assert_eq!(MeanDifference::between(&equal, &equal), None);
        assert_eq!((one.deviation, Repeats::of(&[])), (None, None));
        // One that does not vary takes nothing from the spread of the other.
        let found = MeanDifference::between(&three, &equal).unwrap();
        assert!((found.freedom - 2.0).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn holm_is_that_of_r_and_never_below_the_probability() {
        // `p.adjust(c(0.01, 0.02, 0.03, 0.04), "holm")` of R.
        let adjusted = holm(&[0.01, 0.02, 0.03, 0.04]);
        let expected = [0.04, 0.06, 0.06, 0.06];
        let near = |(a, b): (&f64, f64)| (a - b).abs() < 1e-15;
        assert!(adjusted.iter().zip(expected).all(near), "{adjusted:?}");
        assert_eq!(holm(&[0.9, 0.8]), [1.0, 1.0]);
        assert_eq!(holm(&[]), [0.0; 0]);
    }
}
