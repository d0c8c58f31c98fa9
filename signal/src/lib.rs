//! Sampled signals, and long work in shards.
//!
//! | module | what |
//! | --- | --- |
//! | [`statistics`] | mean, rms, percentiles, zero crossings |
//! | [`repeats`] | spread of repeats, difference of two sets of them, many differences at once |
//! | [`spectrum`] | power spectral density by Welch's method |
//! | [`response`] | a filter given by its frequency response |
//! | [`guiding_force`] | the filters of EN 14363 for guiding forces |
//! | [`random`] | uniform and Gaussian numbers from a seed |
//! | [`shards`] | many independent items, in shards that can be stopped, continued and merged |
//! | [`error`] | what can go wrong in any of them |
//!
//! Read [`spectrum`] first for signals; [`shards`] stands alone. The crate knows nothing of
//! vehicles and dampers; `files` says where its files go and what an identity is.

pub mod error;
pub mod guiding_force;
mod origin;
pub mod random;
pub mod repeats;
pub mod response;
mod shard;
pub mod shards;
pub mod spectrum;
pub mod statistics;

pub use error::SignalError;
