//! The curving at one point of a grid.

use super::assessment::Curve;
use crate::point::GridPoint;
use serde::{Deserialize, Serialize};

/// A point of the grid and the curving there.
pub type Point = GridPoint<CurveAnswer>;

/// The answer at a point.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CurveAnswer {
    /// The curving.
    pub curve: Option<Curve>,
}
