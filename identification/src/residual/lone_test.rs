//! Is most of the residual in one test?
//!
//! The noise of one bench is as large in all tests. An effect that only one motion reaches, and a
//! fault of one record, are in one of them.

use crate::test_set::TestSet;
use signal::statistics::percentile;

/// Share of the squared residual from which one test holds most of it.
const MOST_OF_ALL: f64 = 0.7;
/// It is louder than the others from this ratio of its mean square to that of the middle one.
const LOUDER: f64 = 6.0;

/// The test that holds most of the squared residual, if one of several does.
pub(super) struct LoneTest<'a> {
    name: &'a str,
    /// Sum of its squared residual, N2.
    pub(super) square_n2: f64,
    /// Its share of all.
    share: f64,
    /// Its mean square over the middle one of all tests.
    pub(super) ratio: f64,
}

impl<'a> LoneTest<'a> {
    pub(super) fn of(residual_n: &[Vec<f64>], tests: &'a TestSet) -> Option<Self> {
        let each = tests.tests.iter().zip(residual_n).map(|(test, residual)| {
            let counted = &residual[test.counted()];
            let square_n2: f64 = counted.iter().map(|r| r * r).sum();
            (square_n2, square_n2 / counted.len().max(1) as f64, test)
        });
        let all: Vec<_> = each.collect();
        let total: f64 = all.iter().map(|(square, ..)| square).sum();
        let means: Vec<f64> = all.iter().map(|(_, mean, _)| *mean).collect();
        let middle = percentile(&means, 0.5)?;
        let (square_n2, mean, test) = all.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        let share = square_n2 / total;
        (all.len() > 2 && share > MOST_OF_ALL).then(|| Self {
            name: &test.record.name,
            square_n2: *square_n2,
            share,
            ratio: mean / middle.max(f64::MIN_POSITIVE),
        })
    }

    /// Whether it is much louder than the others.
    pub(super) fn is_louder(&self) -> bool {
        self.ratio > LOUDER
    }

    pub(super) fn description(&self) -> String {
        format!("test {} holds {:.0} % of the squared residual", self.name, 100.0 * self.share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use measurement::{Measurement, Series};

    /// Four tests of 2 s.
    fn tests() -> TestSet {
        let w = std::f64::consts::TAU * 2.0;
        let x = |n: usize| 5e-3 * libm::sin(w * n as f64 * 1e-3);
        let f = |n: usize| 1e4 * libm::cos(w * n as f64 * 1e-3);
        let record = |name: &str| {
            let (x, f) = ((0..2000).map(x).collect(), (0..2000).map(f).collect());
            Measurement::from_series(Series::sampled(name, 1e3, x, f)).unwrap()
        };
        TestSet::new(["a", "b", "c", "d"].map(record).into())
    }

    #[test]
    fn a_test_that_is_louder_than_the_others_holds_most() {
        let tests = tests();
        let residual = |sizes: [f64; 4]| -> Vec<Vec<f64>> {
            let each = sizes.iter().zip(&tests.tests);
            each.map(|(size, test)| vec![*size; test.record.len()]).collect()
        };
        assert!(LoneTest::of(&residual([1.0; 4]), &tests).is_none());
        let sizes = residual([1.0, 1.0, 10.0, 1.0]);
        let lone = LoneTest::of(&sizes, &tests).unwrap();
        assert_eq!(lone.description(), "test c holds 97 % of the squared residual");
        assert!((lone.ratio - 100.0).abs() < 1e-9 && lone.is_louder());
        // It holds most without being much louder.
        let sizes = residual([0.1, 0.9, 2.2, 1.0]);
        assert!(LoneTest::of(&sizes, &tests).is_some_and(|lone| !lone.is_louder()));
    }
}
