//! Sampled signals: spectra, statistics, filters, and long work in shards.

pub mod error;
pub mod guiding_force;
pub mod response;
pub mod shards;
pub mod spectrum;
pub mod statistics;
