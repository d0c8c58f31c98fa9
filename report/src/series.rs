//! What a plot can hold: series of samples, bars, bands and maps; and the bins of a histogram.

use crate::error::Error;

/// One named thing that is drawn and that the legend can switch.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trace {
    pub(crate) name: String,
    pub(crate) kind: Kind,
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
    /// The record that the samples were chosen from; none where they are all.
    pub(crate) of: Option<Samples>,
}

/// How many samples a record has, where only some of them are handed to a plot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Samples {
    /// All samples of the record.
    pub all: u64,
    /// Those of them that are not finite.
    pub not_finite: u64,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Kind {
    Line {
        dashed: bool,
    },
    /// A wide grey line for others to be compared with.
    Backdrop,
    LineWithPoints,
    Scatter,
    /// `x` are edges, one more than `y`.
    Bars,
    /// Bars that lie, one name each; `x` are the lengths, `y` is empty.
    NamedBars {
        names: Vec<String>,
    },
    /// Filled between `y` and `upper`.
    Band {
        upper: Vec<f64>,
    },
    /// `z` row by row, one row for each y.
    Map {
        z: Vec<f64>,
        unit: String,
    },
}

impl Trace {
    pub(crate) fn new(name: &str, kind: Kind, x: &[f64], y: &[f64]) -> Self {
        Self { name: name.to_owned(), kind, x: x.to_vec(), y: y.to_vec(), of: None }
    }

    /// Checks that the columns fit each other.
    pub(crate) fn check(&self, plot: &str) -> Result<(), Error> {
        let mismatch =
            |x, y| Error::TraceLength { plot: plot.to_owned(), trace: self.name.clone(), x, y };
        let (x, y) = (self.x.len(), self.y.len());
        match &self.kind {
            Kind::Line { .. } | Kind::Backdrop | Kind::LineWithPoints | Kind::Scatter if x != y => {
                Err(mismatch(x, y))
            }
            Kind::Bars if x.saturating_sub(1) != y => Err(mismatch(x.saturating_sub(1), y)),
            Kind::NamedBars { names } if names.len() != x => Err(mismatch(x, names.len())),
            Kind::Band { upper } if x != y || upper.len() != x => {
                Err(mismatch(x, if x == y { upper.len() } else { y }))
            }
            Kind::Map { z, .. } if z.len() != x * y => {
                Err(Error::MapSize { plot: plot.to_owned(), expected: x * y, found: z.len() })
            }
            _ => Ok(()),
        }
    }

    /// The names of lying bars, if it has any.
    pub(crate) fn bar_names(&self) -> &[String] {
        match &self.kind {
            Kind::NamedBars { names } => names,
            _ => &[],
        }
    }

    /// True for what is read along x: one value of y over each x.
    pub(crate) fn runs_along_x(&self) -> bool {
        match self.kind {
            Kind::Line { .. } | Kind::Backdrop | Kind::LineWithPoints => {
                crate::thin::rises(&self.x)
            }
            Kind::Bars | Kind::Band { .. } => true,
            Kind::Scatter | Kind::NamedBars { .. } | Kind::Map { .. } => false,
        }
    }
}

/// Counts values into `bins` equal bins between the smallest and the largest one.
///
/// Returns the edges (`bins + 1`) and the counts (`bins`); values that are not finite are left out.
///
/// ```
/// let (edges, counts) = report::equal_bins(&[0.0, 0.1, 0.9, 1.0], 2);
/// assert_eq!((edges, counts), (vec![0.0, 0.5, 1.0], vec![2.0, 2.0]));
/// ```
pub fn equal_bins(values: &[f64], bins: usize) -> (Vec<f64>, Vec<f64>) {
    count_between(values.iter().map(|v| (*v, 1.0)), bins, |v| v, |v| v)
}

/// Counts positive values into `bins` bins of equal ratio, for times that spread over decades.
///
/// Returns the edges (`bins + 1`) and the counts (`bins`); other values are left out.
///
/// ```
/// let (edges, counts) = report::logarithmic_bins(&[1.0, 2.0, 100.0], 2);
/// assert_eq!(counts, [2.0, 1.0]);
/// assert!((edges[1] - 10.0).abs() < 1e-12);
/// ```
pub fn logarithmic_bins(values: &[f64], bins: usize) -> (Vec<f64>, Vec<f64>) {
    count_between(values.iter().map(|v| (*v, 1.0)), bins, libm::log10, libm::exp10)
}

/// [`logarithmic_bins`] of values that occur so many times each.
///
/// ```
/// let (_, counts) = report::logarithmic_bins_of_counts(&[(1.0, 5), (2.0, 2), (100.0, 1)], 2);
/// assert_eq!(counts, [7.0, 1.0]);
/// ```
pub fn logarithmic_bins_of_counts(values: &[(f64, u64)], bins: usize) -> (Vec<f64>, Vec<f64>) {
    let values = values.iter().map(|(value, count)| (*value, *count as f64));
    count_between(values, bins, libm::log10, libm::exp10)
}

fn count_between(
    values: impl Iterator<Item = (f64, f64)>,
    bins: usize,
    to_axis: fn(f64) -> f64,
    from_axis: fn(f64) -> f64,
) -> (Vec<f64>, Vec<f64>) {
    let places: Vec<(f64, f64)> =
        values.map(|(v, count)| (to_axis(v), count)).filter(|(p, _)| p.is_finite()).collect();
    let bins = bins.max(1);
    let place = || places.iter().map(|(place, _)| *place);
    let (Some(low), Some(high)) = (place().reduce(f64::min), place().reduce(f64::max)) else {
        return (Vec::new(), Vec::new());
    };
    // All values equal: one bin's width around them, so that the bar has an area.
    let (low, high) = if low == high { (low - 0.5, high + 0.5) } else { (low, high) };
    let width = (high - low) / bins as f64;
    let mut counts = vec![0.0; bins];
    for (place, count) in places {
        counts[(((place - low) / width) as usize).min(bins - 1)] += count;
    }
    let edges = (0..=bins).map(|k| from_axis(low + width * k as f64)).collect();
    (edges, counts)
}

#[cfg(test)]
mod tests {
    use super::{equal_bins, logarithmic_bins};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn every_finite_value_is_counted_once(
            values in prop::collection::vec(1.0e-3..1.0e3, 1..200),
            bins in 1_usize..40,
        ) {
            for (edges, counts) in [equal_bins(&values, bins), logarithmic_bins(&values, bins)] {
                prop_assert_eq!(counts.iter().sum::<f64>(), values.len() as f64);
                prop_assert_eq!((edges.len(), counts.len()), (bins + 1, bins));
                prop_assert!(edges.is_sorted());
            }
        }
    }

    #[test]
    fn nothing_and_one_value_have_bins_too() {
        assert_eq!(equal_bins(&[f64::NAN], 5), (vec![], vec![]));
        assert_eq!(equal_bins(&[3.0, 3.0], 1), (vec![2.5, 3.5], vec![2.0]));
    }
}
