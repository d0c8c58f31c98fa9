//! Rates with their uncertainty.
//!
//! ```text
//! ( p + z^2/2n -+ z sqrt(p(1-p)/n + z^2/4n^2) ) / (1 + z^2/n)        z = 1.645
//! ```
//!
//! Source: Wilson 1927. It holds near 0 and 1, where rates of a campaign are. Each end is a
//! one-sided bound of 95 %: the rate is above the lower one with that confidence.

use serde::Serialize;

/// Quantile of a one-sided bound of 95 %.
const ONE_SIDED: f64 = 1.644_854;

/// A count out of many, with the one-sided 95 % bounds of its rate (Wilson).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Rate {
    /// How many.
    pub count: usize,
    /// Out of how many.
    pub of: usize,
    /// Their ratio; none where there is no case.
    pub rate: Option<f64>,
    /// Its lower bound, one-sided 95 %.
    pub lower: f64,
    /// Its upper bound, one-sided 95 %.
    pub upper: f64,
}

impl Rate {
    /// A rate.
    ///
    /// ```
    /// use evidence::campaign::Rate;
    /// // None wrong in 300: up to 0.9 % are still possible.
    /// assert!((Rate::new(0, 300).upper - 0.0089).abs() < 1e-4);
    /// ```
    pub fn new(count: usize, of: usize) -> Self {
        debug_assert!(count <= of, "{count} of {of}");
        if of == 0 {
            return Self { count, of, rate: None, lower: 0.0, upper: 1.0 };
        }
        let (lower, upper) = score_interval(count, of, ONE_SIDED);
        Self { count, of, rate: Some(count as f64 / of as f64), lower, upper }
    }

    /// Counts what holds.
    pub fn of(each: impl Iterator<Item = bool>) -> Self {
        let (count, of) =
            each.fold((0, 0), |(count, of), holds| (count + usize::from(holds), of + 1));
        Self::new(count, of)
    }
}

/// Both ends of Wilson's score interval at a quantile.
fn score_interval(count: usize, of: usize, z: f64) -> (f64, f64) {
    let n = of as f64;
    let p = count as f64 / n;
    let middle = p + z * z / (2.0 * n);
    let half = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    let whole = 1.0 + z * z / n;
    (((middle - half) / whole).max(0.0), ((middle + half) / whole).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_those_that_newcombe_printed() {
        // Newcombe 1998, Statistics in Medicine 17, table I, method 3.
        for (count, of, lower, upper) in [
            (81, 263, 0.2553, 0.3662),
            (15, 148, 0.0624, 0.1605),
            (0, 20, 0.0, 0.1611),
            (1, 29, 0.0061, 0.1718),
        ] {
            // Two-sided ones of 95 %.
            let (low, high) = score_interval(count, of, 1.959_964);
            assert!((low - lower).abs() < 6e-5, "{low}");
            assert!((high - upper).abs() < 6e-5, "{high}");
        }
    }
}
