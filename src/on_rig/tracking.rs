//! How well the ram has followed: the last table, and `tracking.json`.
//!
//! The file keeps the delay of this rig for later runs: per test and over all of them, with
//! standard errors, the date and the node. The delay is that of the displacement against the
//! command of the cycle in which it arrives ([`hil_host::run::Delay`]).

use crate::date::Date;
use can_protocol::Node;
pub(super) use hil_host::TRACKING;
use hil_host::run::{Delay, MeasuredTest};
use report::{Cell, Table};
use serde::Serialize;

/// How well the ram has followed in every test.
pub(super) fn table(tests: &[MeasuredTest]) -> Table {
    let table = Table::new("")
        .text("test")
        .fixed("delay", "ms", 2)
        .fixed("+-", "ms", 3)
        .fixed("rms error", "%", 2)
        .fixed("most", "mm", 3)
        .fixed("missing", "cycles", 0);
    table.rows(tests.iter().map(|test| -> [Cell; 6] {
        [
            test.name.as_str().into(),
            (1e3 * test.delay.mean_s).into(),
            test.delay.standard_error_s.map(|error_s| 1e3 * error_s).into(),
            (1e2 * test.tracking_nrmse).into(),
            (1e3 * test.tracking_most_m).into(),
            (test.missing as f64).into(),
        ]
    }))
}

/// `tracking.json`.
#[derive(Debug, Serialize)]
pub(super) struct TrackingFile {
    format: u32,
    /// The day on which it was measured.
    date: String,
    node: u8,
    bus: String,
    /// Over all tests.
    delay_s: Option<f64>,
    delay_standard_error_s: Option<f64>,
    tests: Vec<TrackedTest>,
}

#[derive(Debug, Serialize)]
struct TrackedTest {
    name: String,
    /// That of a sine of the same displacement and speed, rms; none where nothing has moved.
    frequency_hz: Option<f64>,
    delay_s: Option<f64>,
    delay_standard_error_s: Option<f64>,
    /// Rms of the error over the standard deviation of the command.
    error_rms: Option<f64>,
    error_most_m: f64,
    samples: usize,
    missing: u64,
}

impl TrackingFile {
    /// The tracking of these tests, today.
    pub(super) fn of(tests: &[MeasuredTest], node: Node, bus: String) -> Self {
        let finite = |value: f64| value.is_finite().then_some(value);
        let whole = Delay::over(tests);
        let tracked = |test: &MeasuredTest| TrackedTest {
            name: test.name.clone(),
            frequency_hz: finite(test.frequency_hz),
            delay_s: finite(test.delay.mean_s),
            delay_standard_error_s: test.delay.standard_error_s,
            error_rms: finite(test.tracking_nrmse),
            error_most_m: test.tracking_most_m,
            samples: test.cycles.len(),
            missing: test.missing,
        };
        Self {
            format: 1,
            date: Date::today().to_string(),
            node: node.number(),
            bus,
            delay_s: finite(whole.mean_s),
            delay_standard_error_s: whole.standard_error_s,
            tests: tests.iter().map(tracked).collect(),
        }
    }
}
