//! How ride is asked for, with every number that matters to the answer.

use super::grade::Kind;
use serde::Serialize;

/// A way to ask.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Procedure {
    /// Whose grades are reported.
    pub kind: Kind,
    /// Seeds of the tracks.
    pub seeds: Vec<u64>,
    /// Time at the beginning of each that does not count (s).
    pub run_in_s: f64,
    /// Time that counts (s).
    pub section_s: f64,
    /// Height of the floor above the rails (m).
    pub floor_height_m: f64,
}

impl Default for Procedure {
    /// Five tracks of a minute: the sixty blocks of 5 s of EN 12299.
    fn default() -> Self {
        Self {
            kind: Kind::Locomotive,
            seeds: (1..=5).collect(),
            run_in_s: 5.0,
            section_s: 60.0,
            floor_height_m: 1.25,
        }
    }
}
