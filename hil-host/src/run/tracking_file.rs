//! `tracking.json`: how the ram has followed the tests of an open loop. The schema is
//! `docs/schema/tracking.schema.json`.

use super::open_loop::MeasuredTest;
use serde::{Deserialize, Serialize};

/// The name of the file.
pub const TRACKING: &str = "tracking.json";

/// How the ram has followed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrackingFile {
    /// Version of this format.
    pub format: u32,
    /// The tests that were run to their end.
    pub tests: Vec<TestTracking>,
}

/// How the ram has followed one test; what a test without motion cannot show is null.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestTracking {
    /// The test.
    pub name: String,
    /// Delay of the measured displacement against the command of the cycle in which it arrives (s).
    pub ram_delay_s: Option<f64>,
    /// Rms of the difference over the rms of the command.
    pub nrmse: Option<f64>,
    /// Its largest value (m).
    pub most_m: Option<f64>,
    /// Cycles without a fresh measurement.
    pub missing_cycles: u64,
}

impl TrackingFile {
    /// Of the tests of an open loop.
    pub fn of(tests: &[MeasuredTest]) -> Self {
        let finite = |value: f64| value.is_finite().then_some(value);
        let of_test = |test: &MeasuredTest| TestTracking {
            name: test.name.clone(),
            ram_delay_s: finite(test.delay_s),
            nrmse: finite(test.tracking_nrmse),
            most_m: finite(test.tracking_most_m),
            missing_cycles: test.missing,
        };
        Self { format: 1, tests: tests.iter().map(of_test).collect() }
    }
}
