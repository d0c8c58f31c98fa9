//! The two regimes in which a coupled run is compared with the all-model run.
//!
//! - `track`: class-6 track from end to end, at the speed of the scenario. Both runs are forced by
//!   the same track; 12 s behind a run-in are compared.
//! - `hunting`: 300 m of class-6 track, then perfect track, far above the critical speed. The limit
//!   cycle is compared once it has settled: nothing but its size and frequency is left of the
//!   start.

use crate::trip::track::rough_start;
use firmware_core::track::Layout;
use scenario::irregularity::{Band, aar6};
use scenario::run::CYCLE_S;
use scenario::track::OwnedTrack;
use serde::Serialize;

/// How the vehicle runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Regime {
    /// Over irregular track, well damped.
    Track,
    /// On perfect track, in its limit cycle.
    Hunting,
}

/// Both of them.
pub const REGIMES: [Regime; 2] = [Regime::Track, Regime::Hunting];

/// Length of irregular track that sets off the hunting (m).
const ROUGH_M: f64 = 300.0;
/// Irregular track beyond the way of the vehicle (m).
const BEYOND_M: f64 = 100.0;

impl Regime {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Track => "track",
            Self::Hunting => "hunting",
        }
    }

    /// Time before what is compared, and of what is compared (s).
    pub const fn times_s(self) -> [f64; 2] {
        match self {
            Self::Track => [4.0, 12.0],
            Self::Hunting => [20.0, 5.0],
        }
    }

    /// Cycles of a run.
    pub fn cycles(self) -> usize {
        let [before_s, compared_s] = self.times_s();
        ((before_s + compared_s) / CYCLE_S).round() as usize
    }

    /// Its track for a vehicle that runs at a speed (m/s).
    pub fn track(self, band: &Band, speed_m_per_s: f64) -> OwnedTrack {
        match self {
            Self::Track => {
                let [before_s, compared_s] = self.times_s();
                let end_m = speed_m_per_s * (before_s + compared_s) + BEYOND_M;
                OwnedTrack { layout: Layout::tangent(), samples: aar6(band, 0.0, end_m) }
            }
            Self::Hunting => rough_start(band, ROUGH_M),
        }
    }
}
