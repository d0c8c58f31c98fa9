//! A damper bench without a bench: records and laboratory figures of dampers that exist only as
//! models.
//!
//! In the order in which to read it:
//!
//! ```text
//! excitation        what the actuator does: motions as functions of time
//! specimen          what can be mounted: a trait; heat, how its oil warms
//!   modelled        the damper of the core with its effects
//!   series_model    an independent series damper, and disturbances that no effect describes
//!   hydraulic       the full hydraulic damper from chambers, valves and oil
//! bench_visit       which tests (protocol, scaled, test_list), by which sensors, recorded how
//! laboratory        the figures that a laboratory prints about its tests
//! characterisation  a visit with its figures, as one command makes it
//! ```
//!
//! What is wrong with an input is one line ([`VisitError`]). Every random number comes from a seed
//! ([`signal::random`]).
//!
//! Layers: above `measurement`, whose [`Measurement`](measurement::Measurement) a record becomes;
//! the identification uses this crate in its tests only.

pub mod bench_visit;
pub mod characterisation;
mod error;
pub mod excitation;
mod grid;
mod heat;
pub mod hydraulic;
pub mod laboratory;
mod modelled;
pub mod series_model;
pub mod specimen;

pub use error::VisitError;
