//! Quantities over the tracks of several seeds.

use serde::{Deserialize, Serialize};
use signal::statistics;

/// A quantity over the tracks of several seeds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OverSeeds {
    /// Mean.
    pub mean: f64,
    /// Lowest.
    pub lowest: f64,
    /// Highest.
    pub highest: f64,
}

impl OverSeeds {
    /// Of one value a seed; none without any.
    ///
    /// ```
    /// let over = vehicle_studies::OverSeeds::of([1.0, 4.0, 1.0]).unwrap();
    /// assert_eq!((over.mean, over.lowest, over.highest), (2.0, 1.0, 4.0));
    /// ```
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.into_iter().collect();
        let (lowest, highest) = statistics::min_max(&values)?;
        Some(Self { mean: statistics::mean(&values), lowest, highest })
    }
}

/// Seeds in words.
pub(crate) fn seeds_in_words(seeds: &[u64]) -> String {
    match (seeds.first(), seeds.last()) {
        (Some(first), Some(last)) if first != last => format!("{first} to {last}"),
        (Some(first), _) => first.to_string(),
        _ => "none".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_a_range_or_one() {
        assert_eq!(seeds_in_words(&[1, 2, 3]), "1 to 3");
        assert_eq!(seeds_in_words(&[7]), "7");
        assert_eq!(seeds_in_words(&[]), "none");
    }
}
