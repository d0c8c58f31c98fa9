//! From files to a vehicle that can run.
//!
//! [`run::Run::load`] reads a scenario with everything it names: the vehicle with the provenance of
//! its numbers ([`vehicle`], [`wheel_rail`]), the dampers ([`damper`]), the track ([`track`],
//! [`irregularity`]), the rig ([`rig`]), the damper to compare with ([`compare`]). It solves the
//! wheel and rail [`profile`]s into the contact table of the step ([`contact_geometry`]) and finds
//! the steady motion to start from ([`equilibrium`]). [`datasheet::Datasheet`] turns what a maker
//! says about a damper into its numbers. Whatever does not fit is one clear line with file, line
//! and key ([`source::ScenarioError`]).

pub mod compare;
pub mod conicity;
pub mod contact_geometry;
mod cycle;
pub mod damper;
pub mod damper_mass;
pub mod datasheet;
mod effective;
pub mod empirical;
pub mod equilibrium;
mod error;
mod inputs;
pub mod irregularity;
mod kind;
pub mod minimum_speed;
pub mod profile;
pub mod quantity;
pub mod rig;
pub mod run;
mod run_file;
mod second_run;
pub mod setting;
mod slot;
pub mod source;
mod title;
pub mod track;
pub mod typical;
pub mod vehicle;
pub mod watch;
pub mod wheel_rail;

pub use error::{Place, ScenarioError, SettingError};
pub use kind::Kind;
