//! Studies of a vehicle: from which speed on it hunts, how it rides, how it goes through a curve.
//!
//! A study is a question ([`study::Study`]) that is asked at every point of a grid of the
//! scenario's numbers. The vehicle always runs on the line that also drives a rig, in virtual time.
//!
//! Read in this order:
//!
//! | module | what |
//! | --- | --- |
//! | [`trip`] | a vehicle under way: on one track at one speed, recorded at 1 kHz |
//! | [`critical_speed`], [`rig_delay`], [`ride`], [`curve`] | the questions, each with its text and its page |
//! | [`yaw_damper_problem`] | the reference problem for compensators: coupled runs against the all-model run |
//! | [`modes`], `describing_function` | linear vibrations, with a damper as stiffness and damping |
//! | [`receptance`] | poles and residues of the vehicle at the places of its dampers |
//! | `one_force` | scenarios that no study of hunting or ride fits |
//! | [`study`] | asking at every point; the identity of a study |
//! | [`grid`], [`GridPoint`], [`OverSeeds`] | points, their answers, quantities over several tracks |
//! | [`StudyError`] | what can go wrong in any of them |
//!
//! The crate uses `scenario` for what it simulates, `rig-emulator` for dampers behind rigs,
//! `signal` for what it makes of the signals, `files` for identities and `report` for pages. It
//! knows nothing of records and buses.

pub mod critical_speed;
pub mod curve;
mod describing_function;
mod error;
pub mod grid;
pub mod modes;
mod one_force;
mod over_keys;
mod over_seeds;
mod point;
mod point_table;
pub mod receptance;
pub mod ride;
pub mod rig_delay;
pub mod study;
pub mod trip;
pub mod yaw_damper_problem;

pub use error::StudyError;
pub use over_seeds::OverSeeds;
pub use point::GridPoint;
