//! From recorded signals to figures: spectra, statistics, assessment quantities.
//!
//! [`spectrum`] is Welch's power spectral density with its peak; [`statistics`] are rms, extremes,
//! percentiles and half cycles; [`guiding_force`] filters axle forces and Y/Q as acceptance tests do.
//! Nothing here knows where a signal comes from; units are those of the
//! caller.

pub mod error;
pub mod guiding_force;
pub mod measurement;
pub mod spectrum;
pub mod statistics;
