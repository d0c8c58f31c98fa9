//! How long cycles take and how late they begin, as the page shows it.

use crate::counts::Counts;
use crate::summary::{Percentiles, percentiles};
use hdrhistogram::Histogram;
use serde::Serialize;

/// A wake-up that is later than this is counted as late (ns): the budget of `yawbench rtcheck`.
pub(super) const LATE_NS: u64 = 100_000;

/// Bins of the histogram in a factor of ten.
const PER_DECADE: [f64; 8] = [1.0, 1.33, 1.78, 2.37, 3.16, 4.22, 5.62, 7.5];

/// Factors of ten, from 1 µs.
const DECADES: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];

/// Times of the cycles so far.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub(crate) struct Timing {
    /// From receive to send (µs).
    cycle_us: Option<Percentiles>,
    /// How late cycles began (µs).
    lateness_us: Option<Percentiles>,
    /// Ticks of the clock that were skipped.
    skipped: u64,
    /// Wake-ups that were late.
    late: u64,
    /// Cycles between two edges; the last bin holds all that took longer.
    histogram: Vec<u64>,
}

impl Timing {
    /// The times of a run so far.
    pub(super) fn of(counts: &Counts) -> Self {
        Self {
            cycle_us: Some(percentiles(&counts.cycle_ns)),
            lateness_us: Some(percentiles(&counts.lateness_ns)),
            skipped: counts.skipped,
            late: counts.lateness_ns.count_between(LATE_NS, u64::MAX),
            histogram: binned(&counts.cycle_ns),
        }
    }
}

/// Lower edges of the bins (µs).
pub(crate) fn edges_us() -> Vec<f64> {
    DECADES.iter().flat_map(|decade| PER_DECADE.map(|step| decade * step)).collect()
}

/// Times in nanoseconds, counted by bin.
fn binned(times_ns: &Histogram<u64>) -> Vec<u64> {
    let edges = edges_us();
    let mut bins = vec![0; edges.len()];
    for bucket in times_ns.iter_recorded() {
        let time_us = bucket.value_iterated_to() as f64 * 1e-3;
        let above = edges.partition_point(|edge| *edge <= time_us);
        // What is shorter than the first edge counts there.
        if let Some(bin) = bins.get_mut(above.saturating_sub(1)) {
            *bin += bucket.count_since_last_iteration();
        }
    }
    bins
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Row;

    #[test]
    fn every_cycle_is_in_one_bin_and_late_ones_are_counted() {
        let mut counts = Counts::default();
        let times_ns = [200, 1_000, 31_700, 31_700, 9_999_000, 4_000_000_000];
        for (cycle, cycle_ns) in (1..).zip(times_ns) {
            let lateness_ns = if cycle > 4 { 250_000 } else { 5_000 };
            counts.take(&Row { cycle, cycle_ns, lateness_ns, skipped: 1, ..Row::default() });
        }
        let timing = Timing::of(&counts);
        let edges = edges_us();
        assert!(edges.is_sorted() && edges.len() == timing.histogram.len());
        let bin_of = |time_us: f64| edges.partition_point(|edge| *edge <= time_us) - 1;
        assert_eq!(timing.histogram[0], 2);
        assert_eq!(timing.histogram[bin_of(31.7)], 2);
        assert_eq!(timing.histogram.last(), Some(&2));
        assert_eq!(timing.histogram.iter().sum::<u64>(), 6);
        assert_eq!((timing.skipped, timing.late), (6, 2));
    }
}
