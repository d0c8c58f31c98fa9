//! How long cycles and steps took.

use hdrhistogram::Histogram;
use serde::Serialize;

/// Percentiles of a time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Percentiles {
    pub p50: f64,
    pub p99: f64,
    pub p99_9: f64,
    pub max: f64,
}

/// Percentiles of the vehicle step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct StepPercentiles {
    pub p50: f64,
    pub p99: f64,
    pub max: f64,
}

/// A quantile of times in nanoseconds, in microseconds.
pub(crate) fn microseconds(histogram: &Histogram<u64>, quantile: f64) -> f64 {
    histogram.value_at_quantile(quantile) as f64 * 1e-3
}

pub(crate) fn percentiles(histogram: &Histogram<u64>) -> Percentiles {
    Percentiles {
        p50: microseconds(histogram, 0.5),
        p99: microseconds(histogram, 0.99),
        p99_9: microseconds(histogram, 0.999),
        max: microseconds(histogram, 1.0),
    }
}

pub(super) fn step_percentiles(histogram: &Histogram<u64>) -> StepPercentiles {
    StepPercentiles {
        p50: microseconds(histogram, 0.5),
        p99: microseconds(histogram, 0.99),
        max: microseconds(histogram, 1.0),
    }
}
