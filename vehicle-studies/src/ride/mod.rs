//! How a vehicle rides on straight track: Sperling index, mean comfort, accelerations, spectra.
//!
//! | module | what it says |
//! | --- | --- |
//! | [`sperling`] | the index of GB 5599-85 (20 s windows) and of GB/T 5599-2019 (5 s windows) |
//! | [`Weighting`] | Wb and Wd, the weightings behind EN 12299's mean comfort |
//! | `grade` | what is excellent, good, qualified; the words of EN 12299 |
//! | `assessment` | [`Ride::of`]: all of it for one vehicle over the tracks of several seeds |
//!
//! The track is straight, with the irregularity of the scenario: random by its wavelengths with the
//! study's seeds, or measured; a scenario without any is refused. The vehicle has no longitudinal
//! motion, so mean comfort is that of two directions.

mod answer;
mod assessment;
mod grade;
mod page;
mod procedure;
mod shake;
pub mod sperling;
mod study;
mod text;
mod vibration;
mod weighting;

pub use answer::{Point, RideAnswer};
pub use assessment::Ride;
pub use grade::{Grade, Kind};
pub use procedure::Procedure;
pub use vibration::{Peak, PlaceRide, PlaceSpectrum, Vibration};
pub use weighting::Weighting;
