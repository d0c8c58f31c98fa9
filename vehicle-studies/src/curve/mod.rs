//! How a vehicle goes through a curve: guiding forces, derailment, wheel load, wear, stability.
//!
//! | module | what it says |
//! | --- | --- |
//! | `sections` | where the full curve is, and where its transitions |
//! | `forces` | what one track does to one wheelset in one section, by EN 14363 and GB/T 5599-2019 |
//! | `passed` | one trip, and those forces for all wheelsets |
//! | `limits` | Prud'homme's limit and the others |
//! | `assessment` | [`Curve::of`]: all of it for one vehicle over the tracks of several seeds |
//!
//! The layout is that of the scenario, which needs a `[track.curve]`; so is the irregularity, with
//! the study's seeds where it is random. The straight lead-in is the run-in. A wheelset is judged
//! by where it stands itself, not the vehicle.

mod answer;
mod assessment;
mod forces;
mod limits;
mod page;
mod passed;
mod procedure;
mod sections;
mod study;
#[cfg(test)]
mod tests;
mod text;
mod wheelset;

pub use answer::{CurveAnswer, Point};
pub use assessment::{Curve, ForceSpectrum, SectionCurve};
pub use limits::AxleLimits;
pub(crate) use passed::Passed;
pub use procedure::Procedure;
pub use sections::{Part, Section};
pub use wheelset::{WheelCurve, WheelsetCurve};
