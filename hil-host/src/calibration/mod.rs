//! Calibration of a rig from tests in open loop.
//!
//! | what is mounted | what is found |
//! | --- | --- |
//! | a rigid bar | stiffness of fixture and bar in series, skew of force against displacement ([`BarFit`]) |
//! | nothing | mass behind the load cell ([`EndMassFit`]) |
//! | a force that is known | gain and offset of the load cell ([`GainFit`]) |
//!
//! The first two compare force and displacement at the frequency of a sine ([`SinePair`]), so that
//! noise, offsets and harmonics of either count in the standard errors alone.

mod bar;
mod end_mass;
mod gain;
mod sine_fit;

pub use bar::{BarFit, BarPoint};
pub use end_mass::EndMassFit;
pub use gain::{GainFit, Reading};
pub use sine_fit::SinePair;
