//! What is asked, with every number that matters to the answer.

use super::condition::{CONDITIONS, Condition};
use super::from_below::Climb;
use super::perturbed::RIGS;
use super::ring_down::Release;
use serde::Serialize;

/// Dead times of the rig (ms).
pub const DEAD_TIMES_MS: [u16; 5] = [1, 2, 5, 10, 15];

/// Dead times at which what takes long is asked (ms).
const LONG_AT_MS: [u16; 2] = [5, 15];

/// What is asked of a compensator.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Question {
    /// Seed of the perturbed rigs.
    pub seed: u64,
    /// The states of the dampers.
    pub dampers: Vec<Condition>,
    /// Dead times of the rig (ms).
    pub dead_times_ms: Vec<u16>,
    /// How many perturbed rigs.
    pub perturbed_rigs: u64,
    /// Whether critical speeds are asked for.
    pub critical_speeds: bool,
    /// Dead times at which critical speeds are asked for (ms).
    pub long_at_ms: Vec<u16>,
    /// How critical speeds are approached from below, if they are.
    pub climb: Option<Climb>,
}

/// How a critical speed is approached from below.
const CLIMB: Climb = Climb {
    from_kmh: 150.0,
    step_kmh: 2.5,
    margin: 0.05,
    release: Release {
        burst_m: 4e-3,
        burst_hz: 3.4,
        window_m: [1e-3, 4e-3],
        watched_s: 6.0,
        stroke_limit_m: 15e-3,
    },
};

impl Question {
    /// Everything.
    pub fn full(seed: u64) -> Self {
        Self {
            seed,
            dampers: CONDITIONS.to_vec(),
            dead_times_ms: DEAD_TIMES_MS.to_vec(),
            perturbed_rigs: RIGS,
            critical_speeds: true,
            long_at_ms: LONG_AT_MS.to_vec(),
            climb: Some(CLIMB),
        }
    }

    /// How many perturbed rigs are asked for with a damper.
    pub(super) fn rigs(&self, damper: Condition) -> u64 {
        if damper.has_aims() { self.perturbed_rigs } else { 0 }
    }

    /// One dead time on the nominal rig, new and worn, without critical speeds: seconds.
    pub fn quick(seed: u64) -> Self {
        Self {
            seed,
            dampers: vec![Condition::New, Condition::Worn],
            dead_times_ms: vec![5],
            perturbed_rigs: 0,
            critical_speeds: false,
            long_at_ms: Vec::new(),
            climb: None,
        }
    }
}
