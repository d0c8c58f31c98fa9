//! The track under the vehicle: its layout in plan and cant, and its irregularity.
//!
//! Axes: x forward, y right, z down. Distance runs along the track centre line.

mod irregularity;
mod layout;
mod window;

pub use irregularity::{Irregularity, IrregularitySample};
pub use layout::{Layout, LayoutError, LayoutPoint, SECTIONS_MAX};
pub use window::Window;

/// A track: layout and irregularity.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Track<'a> {
    /// Curvature and cant.
    pub layout: Layout,
    /// Deviation of the rails from it.
    pub irregularity: Irregularity<'a>,
}
