//! The critical speeds at one delay.

use crate::critical_speed::Critical;
use crate::point::GridPoint;
use serde::{Deserialize, Serialize};

/// A point of the grid and its critical speeds.
pub(super) type Point = GridPoint<RigDelay>;

/// The answer at a point.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RigDelay {
    /// With all dampers modelled in their places.
    pub modelled: Option<Speeds>,
    /// Frequency of hunting there (Hz).
    pub hunting_hz: Option<f64>,
    /// With the dampers behind rigs that the scenario has on rigs; none where it has none there.
    pub as_in_scenario: Option<OnRigs>,
    /// With all dampers behind rigs; none where that is the same.
    pub all_on_rigs: Option<OnRigs>,
}

/// A critical speed, found in two ways.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Speeds {
    /// Below which no hunting stays.
    pub fold: Critical,
    /// From which on a small motion grows.
    pub linear: Critical,
    /// From which on irregular track throws the vehicle into a hunting that stays, mean over seeds
    /// (km/h); none where it was not asked for or lies outside of the range.
    pub hunts_from_kmh: Option<f64>,
}

/// What dampers behind rigs make of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OnRigs {
    /// How many dampers are behind rigs.
    pub rigs: usize,
    /// Delay of the force, as a run measures it; mean over the rigs (s).
    pub measured_delay_s: Option<f64>,
    /// Damping that it costs at the frequency of hunting, by the formula (%).
    pub damping_lost_percent: Option<f64>,
    /// The critical speeds.
    pub speeds: Speeds,
}

impl OnRigs {
    /// How far a speed is off that of modelled dampers (km/h), and in per cent of it; none where
    /// either is not in the range.
    pub fn difference(
        &self,
        modelled: Option<Speeds>,
        of: impl Fn(&Speeds) -> Option<f64>,
    ) -> Option<[f64; 2]> {
        let (own, other) = (of(&self.speeds)?, of(&modelled?)?);
        Some([own - other, 100.0 * (own / other - 1.0)])
    }
}
