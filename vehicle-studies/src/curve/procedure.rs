//! How curving is asked for, with every number that matters to the answer.

use serde::Serialize;

/// A way to ask.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Procedure {
    /// Seeds of random tracks.
    pub seeds: Vec<u64>,
    /// Prud'homme's factor: 1 for locomotives and coaches, 0.85 for freight wagons.
    pub k1: f64,
}

impl Default for Procedure {
    fn default() -> Self {
        Self { seeds: (1..=5).collect(), k1: 1.0 }
    }
}
