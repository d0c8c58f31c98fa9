//! Rates with their uncertainty.
//!
//! ```text
//! ( p + z^2/2n -+ z sqrt(p(1-p)/n + z^2/4n^2) ) / (1 + z^2/n)        z = 1.96
//! ```
//!
//! Source: Wilson 1927. It holds near 0 and 1, where rates of a campaign are.

use serde::Serialize;

/// Quantile of a two-sided interval of 95 %.
const Z: f64 = 1.959_964;

/// A count out of many, with the 95 % interval of its rate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Rate {
    /// How many.
    pub count: usize,
    /// Out of how many.
    pub of: usize,
    /// Their ratio; none where there is no case.
    pub rate: Option<f64>,
    /// Lower end of its 95 % interval.
    pub lower: f64,
    /// Upper end of its 95 % interval.
    pub upper: f64,
}

impl Rate {
    /// A rate.
    ///
    /// ```
    /// use evidence::campaign::Rate;
    /// // None wrong in 300: up to 1.3 % are still possible.
    /// assert!((Rate::new(0, 300).upper - 0.0126).abs() < 1e-4);
    /// ```
    pub fn new(count: usize, of: usize) -> Self {
        debug_assert!(count <= of, "{count} of {of}");
        if of == 0 {
            return Self { count, of, rate: None, lower: 0.0, upper: 1.0 };
        }
        let n = of as f64;
        let p = count as f64 / n;
        let middle = p + Z * Z / (2.0 * n);
        let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
        let whole = 1.0 + Z * Z / n;
        let lower = ((middle - half) / whole).max(0.0);
        Self { count, of, rate: Some(p), lower, upper: ((middle + half) / whole).min(1.0) }
    }

    /// Counts what holds.
    pub fn of(each: impl Iterator<Item = bool>) -> Self {
        let (count, of) =
            each.fold((0, 0), |(count, of), holds| (count + usize::from(holds), of + 1));
        Self::new(count, of)
    }
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
            let rate = Rate::new(count, of);
            assert!((rate.lower - lower).abs() < 6e-5, "{rate:?}");
            assert!((rate.upper - upper).abs() < 6e-5, "{rate:?}");
        }
    }
}
