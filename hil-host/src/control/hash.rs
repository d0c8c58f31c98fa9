//! The name of the trajectory hash ([`firmware_core::line::LineState::hashed`]) in results.

/// Name of the algorithm in `summary.json`.
pub(crate) const ALGORITHM: &str = "fnv1a-64 over little-endian f64 words";
