//! From files to a vehicle that can run.
//!
//! A scenario is a TOML file that names a vehicle, a speed, a track and the dampers in its slots.
//! [`run::Run::load`] reads it with everything it names and returns a run that is ready to be
//! simulated: the vehicle of the step, its contact table, the track, the dampers, and the steady
//! motion to start from.
//!
//! Read [`run`] first. The parts of the file follow: [`vehicle`] and [`wheel_rail`], whose numbers
//! carry their provenance ([`quantity`]); [`damper`], the damper of each slot, and [`watch`], the
//! model that a rig is compared with; [`track`] and [`irregularity`]; [`rig`] and
//! [`plausibility`], what is believed of it, and `compensation`, how its delay is compensated;
//! [`compare`]. `stand_in` has the dampers for which the rig of another one stands.
//! [`setting`] changes single numbers by their key, as studies do. [`datasheet::Datasheet`]
//! converts a maker's data into a nominal damper.
//!
//! What is computed from them: wheel and rail [`profile`]s become the contact table of the step
//! ([`contact_geometry`], [`conicity`]), [`equilibrium`] is the steady motion, [`minimum_speed`]
//! the speed below which the substeps are too coarse. `typical` has the usual ranges of dampers and
//! vehicles, for [`run::Run::warnings`].
//!
//! Files are read through [`source`], with the limits of the crate `files`; `Run::inputs` holds the
//! hash of each, by its role. [`ScenarioError`] is the one error: a line with file, line, key, what
//! was found and what was expected.
//!
//! Layers: this crate uses `files` and `firmware-core`; it knows no bus, no study and no command.

pub mod compare;
mod compensation;
pub mod conicity;
pub mod contact_geometry;
mod cycle;
pub mod damper;
pub mod damper_mass;
pub mod datasheet;
mod effective;
mod empirical;
pub mod equilibrium;
mod error;
mod inputs;
pub mod irregularity;
mod kind;
mod known;
pub mod minimum_speed;
mod motion;
mod mounted;
pub mod plausibility;
pub mod profile;
pub mod quantity;
mod readiness;
pub mod rig;
pub mod run;
mod run_file;
mod second_run;
mod servo;
pub mod setting;
mod slot;
pub mod source;
mod stand_in;
mod title;
pub mod track;
mod typical;
pub mod vehicle;
pub mod watch;
pub mod wheel_rail;

pub use error::{Place, ScenarioError, SettingError};
pub use kind::Kind;
