//! A locomotive, its wheels on a real track, and its dampers, in fixed steps.
//!
//! `no_std`, no heap, no unsafe code, no panic path, bounded work, and the same bits on every
//! processor: all of it runs on a Linux host and on a microcontroller.
//!
//! Read in this order:
//!
//! 1. [`mod@line`]: one control cycle as one straight line. It joins everything below.
//! 2. [`guard`]: the last believed force of a rig; [`command`]: where its command stands, and the
//!    safe stop.
//! 3. [`vehicle`]: bodies and force elements from data, stepped by leapfrog.
//! 4. [`damper`]: the series damper, and [`damper::effects`], one file each, for what a nominal
//!    damper lacks.
//! 5. [`wheel_rail`]: contact tables, Hertz, Kalker, the creep laws, one file each.
//! 6. [`track`]: curvature, cant, irregularity.
//! 7. [`supervision`]: the states of a bench, what is believed, and how motion ends.
//! 8. [`virtual_wear`] and [`compensation`]: what is done to the displacement on its way to a rig.
//! 9. [`lanes`] and [`fnv`], on which the rest stands: one number per vehicle of a batch, and a
//!    hash.
//!
//! The layers, each using only those to its right:
//!
//! ```text
//! line -> vehicle -> wheel_rail, track -> lanes
//!      -> supervision -> guard, command
//!      -> virtual_wear -> compensation, damper, supervision
//!      -> compensation -> command
//!      -> damper
//! ```
//!
//! Parameters are `&self`, memory is `&mut state`; every state can be copied as a snapshot.
//! Whatever can be wrong with parameters is an [`Error`] when they are built. What happens in a
//! step is a state: a lost force, a derailment, a model that diverges. A debug build checks with
//! assertions what the code itself guarantees, such as slots, lanes and indices.
//!
//! Axes: x forward, y right, z down. SI units; the unit is the end of a name.
#![no_std]
#![forbid(unsafe_code)]

pub mod command;
pub mod compensation;
pub mod damper;
mod error;
pub mod fnv;
pub mod guard;
pub mod lanes;
pub mod line;
pub mod number;
mod ring;
pub mod sqrt;
pub mod supervision;
pub mod track;
pub mod vehicle;
pub mod virtual_wear;
pub mod wheel_rail;

pub use error::Error;
