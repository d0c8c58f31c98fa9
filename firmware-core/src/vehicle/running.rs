//! How a vehicle runs during a step, and where.

use super::body::BODIES_MAX;
use crate::lanes::Lanes;
use crate::track::{LayoutPoint, Track};
use crate::wheel_rail::table::ContactTable;

/// The track under each body.
pub(super) type Places<const L: usize> = [[LayoutPoint; L]; BODIES_MAX];

/// How the vehicle runs during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Running<'a, const L: usize = 1> {
    /// Running speed (m/s), positive.
    pub speed_m_per_s: Lanes<L>,
    /// The track of each vehicle.
    pub tracks: [&'a Track<'a>; L],
    /// The contact table of wheels that run on profiles.
    pub contact: Option<&'a ContactTable>,
    /// Length of one substep (s).
    pub substep_s: f64,
}

impl<const L: usize> Running<'_, L> {
    /// Whether all tracks are straight.
    #[inline(always)]
    pub(super) fn is_tangent(&self) -> bool {
        self.tracks.iter().all(|track| track.layout.is_tangent())
    }
}
