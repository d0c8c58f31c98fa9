//! The critical speed of a vehicle, found in three ways that answer three questions.
//!
//! | module | question |
//! | --- | --- |
//! | `ascent` | from which speed on does class-6 track throw the vehicle into a hunting motion that stays when the track is perfect again? |
//! | `stability` | the same with the irregularity kept on, by guiding forces and EN 14363's limit |
//! | `fold` | below which speed does no hunting motion stay, however it began? |
//! | `linear` | from which speed on does a small motion grow, with the dampers as they are at one stroke? |
//!
//! The first depends on the track and on a threshold and is what the study calls critical speed;
//! seeds give its range. The second depends on neither and bounds it from below; between the two a
//! vehicle runs quietly or hunts, as it comes. The third says little with clearance and relief, and
//! is stated for several strokes.

mod answer;
mod ascent;
mod bracket;
mod fold;
mod hunting;
mod linear;
mod locus;
mod page;
mod procedure;
mod stability;
mod study;
mod text;

pub use answer::{CriticalSpeeds, Point};
pub use ascent::{Ascent, OnTrack, offset_wheelset, set_off};
pub use bracket::Critical;
pub use fold::{CyclePoint, Fold};
pub(crate) use fold::{burst, burst_s, burst_track};
pub use hunting::Hunting;
pub use linear::{AtSpeed, LinearSpeed, Mode, STROKES_M};
pub use procedure::{Criterion, Procedure};
pub use study::Question;
