//! The critical speeds of one point of a grid.

use super::ascent::Ascent;
use super::fold::Fold;
use super::linear::LinearSpeed;
use crate::point::GridPoint;
use serde::{Deserialize, Serialize};

/// A point of the grid and its critical speeds.
pub type Point = GridPoint<CriticalSpeeds>;

/// The answer at a point.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CriticalSpeeds {
    /// Equivalent conicity at 3 mm (UIC 519), or that of the cone.
    pub equivalent_conicity_at_3_mm: Option<f64>,
    /// Coefficient of friction.
    pub friction: Option<f64>,
    /// Over irregular track.
    pub ascent: Option<Ascent>,
    /// Down the limit cycle.
    pub fold: Option<Fold>,
    /// By eigenvalues, for every stroke.
    pub linear: Vec<LinearSpeed>,
}
