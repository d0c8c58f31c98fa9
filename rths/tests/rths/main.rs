//! The benchmark as a command asks it.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod el_centro;
mod synthetic;

use rths::{Benchmark, Record, run};
use std::sync::atomic::AtomicBool;

/// All runs of a record.
fn benchmark(record: &Record) -> Benchmark {
    run(record, 1, &AtomicBool::new(false), &|_, _| ()).unwrap()
}
