//! The ride at one point of a grid.

use super::assessment::Ride;
use crate::point::GridPoint;
use serde::{Deserialize, Serialize};

/// A point of the grid and the ride there.
pub type Point = GridPoint<RideAnswer>;

/// The answer at a point.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RideAnswer {
    /// The ride.
    pub ride: Option<Ride>,
}
