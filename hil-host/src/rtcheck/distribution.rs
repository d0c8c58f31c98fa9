//! Times as percentiles, as bins, and as a histogram in text.

use crate::summary::microseconds;
use hdrhistogram::Histogram;
use serde::Serialize;

/// Longest time that is distinguished (ns); longer ones count as this.
const MOST_NS: u64 = 10_000_000_000;

/// Digits of a time that are kept.
const DIGITS: u8 = 3;

/// Upper ends of the bins (µs); a last one takes the rest.
const ENDS_US: [f64; 13] =
    [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 10e3];

/// Letters of the longest bar.
const BAR: f64 = 40.0;

/// An empty histogram of times in nanoseconds with all its memory: recording allocates nothing.
pub(super) fn empty() -> Histogram<u64> {
    Histogram::new_with_bounds(1, MOST_NS, DIGITS)
        .unwrap_or_else(|error| unreachable!("constant bounds: {error}"))
}

/// Percentiles of some times (µs).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Distribution {
    pub p50: f64,
    pub p99: f64,
    pub p99_9: f64,
    pub p99_99: f64,
    pub max: f64,
}

impl Distribution {
    /// The percentiles of a histogram in nanoseconds; `None` of an empty one.
    pub fn of(histogram: &Histogram<u64>) -> Option<Self> {
        (!histogram.is_empty()).then(|| Self {
            p50: microseconds(histogram, 0.5),
            p99: microseconds(histogram, 0.99),
            p99_9: microseconds(histogram, 0.999),
            p99_99: microseconds(histogram, 0.9999),
            max: microseconds(histogram, 1.0),
        })
    }
}

/// Times that are longer than the bin before and at most this long.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bin {
    /// Its upper end (µs); `None` for the last one, which has none.
    pub up_to_us: Option<f64>,
    /// How many times there are in it.
    pub count: u64,
}

/// The bins of a histogram in nanoseconds, from the first to the last with anything in it.
pub(super) fn bins(histogram: &Histogram<u64>) -> Vec<Bin> {
    let ends = ENDS_US.into_iter().map(Some).chain([None]);
    let mut bins: Vec<Bin> = ends.map(|up_to_us| Bin { up_to_us, count: 0 }).collect();
    for value in histogram.iter_recorded() {
        let time_us = value.value_iterated_to() as f64 * 1e-3;
        let holds = |bin: &&mut Bin| bin.up_to_us.is_none_or(|up_to_us| time_us <= up_to_us);
        if let Some(bin) = bins.iter_mut().find(holds) {
            bin.count += value.count_since_last_iteration();
        }
    }
    let is_used = |bin: &Bin| bin.count > 0;
    let first = bins.iter().position(is_used).unwrap_or(bins.len());
    let last = bins.iter().rposition(is_used).map_or(first, |last| last + 1);
    bins.drain(first..last).collect()
}

/// Bins as lines of text. The length of a bar is the logarithm of its count, so that a single late
/// cycle among a million shows; the bin in which the budget ends is marked.
///
/// ```
/// use hil_host::rtcheck::{Bin, histogram_lines};
/// let bins = [
///     Bin { up_to_us: Some(10.0), count: 999 },
///     Bin { up_to_us: Some(20.0), count: 0 },
///     Bin { up_to_us: None, count: 1 },
/// ];
/// assert_eq!(
///     histogram_lines(&bins, 20.0),
///     [
///         "     up to 10 us  999  ########################################",
///         "     up to 20 us    0  < budget",
///         "          longer    1  ####",
///     ]
/// );
/// ```
pub fn histogram_lines(bins: &[Bin], budget_us: f64) -> Vec<String> {
    let most = bins.iter().map(|bin| bin.count).max().unwrap_or(0);
    let width = most.to_string().len();
    let mut before_us = 0.0;
    let mut lines = Vec::new();
    for bin in bins {
        let end = bin.up_to_us.map_or_else(|| "longer".to_owned(), |us| format!("up to {us} us"));
        let share = libm::log2(1.0 + bin.count as f64) / libm::log2(1.0 + most.max(1) as f64);
        let bar = "#".repeat((BAR * share).round() as usize);
        let holds_budget =
            before_us < budget_us && bin.up_to_us.is_none_or(|up_to_us| budget_us <= up_to_us);
        let mark = if holds_budget { "< budget" } else { "" };
        let gap = if bar.is_empty() || mark.is_empty() { "" } else { " " };
        lines.push(format!("{end:>16}  {:>width$}  {bar}{gap}{mark}", bin.count).trim_end().into());
        before_us = bin.up_to_us.unwrap_or(f64::INFINITY);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_time_is_in_one_bin_and_empty_ends_are_left_out() {
        let mut histogram = empty();
        // ns, and how often.
        for (time_ns, count) in [(0, 1), (9_000, 500), (40_000, 3), (3_000_000, 1)] {
            histogram.saturating_record_n(time_ns, count);
        }
        let bins = bins(&histogram);
        assert_eq!(bins.iter().map(|bin| bin.count).sum::<u64>(), 505);
        assert_eq!(bins.first(), Some(&Bin { up_to_us: Some(1.0), count: 1 }));
        assert_eq!(bins.last(), Some(&Bin { up_to_us: Some(5e3), count: 1 }));
        assert_eq!(bins.iter().find(|bin| bin.up_to_us == Some(10.0)).unwrap().count, 500);
        assert!(super::bins(&empty()).is_empty());
    }

    #[test]
    fn a_time_beyond_the_last_bin_is_shown_as_longer() {
        let mut histogram = empty();
        histogram.saturating_record(u64::MAX);
        histogram.saturating_record(11_000_000);
        let lines = histogram_lines(&bins(&histogram), 100.0);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].starts_with("          longer  2  ####"), "{lines:?}");
    }

    #[test]
    fn percentiles_are_in_microseconds() {
        let mut histogram = empty();
        histogram.saturating_record_n(10_000, 9_999);
        histogram.saturating_record(2_000_000);
        let found = Distribution::of(&histogram).unwrap();
        let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-3;
        assert!(near(found.p50, 10.0) && near(found.p99_9, 10.0), "{found:?}");
        assert!(near(found.p99_99, 10.0) && near(found.max, 2000.0), "{found:?}");
        assert_eq!(Distribution::of(&empty()), None);
    }
}
