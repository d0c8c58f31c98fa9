//! A damper bench without a bench.

pub mod bench_visit;
pub mod hydraulic;
pub mod laboratory;
pub mod series_model;
