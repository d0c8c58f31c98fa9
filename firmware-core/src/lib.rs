//! A locomotive, its wheels on a real track, and its dampers, in fixed steps.
//!
//! `no_std`, no heap, no unsafe, no panic path, bounded work, and the same bits on every processor:
//! all of it runs on a Linux host and on a microcontroller. The line that a control cycle follows is
//! in [`mod@line`]; it joins
//!
//! - [`vehicle`]: bodies and force elements from data, stepped by leapfrog,
//! - [`wheel_rail`]: contact tables, Hertz, Kalker, the creep laws,
//! - [`track`]: curvature, cant, irregularity,
//! - [`damper`]: the series damper with its effects,
//! - [`guard`]: what a received force must pass,
//! - [`compensation`]: what is done to the displacement on its way to a rig.
//!
//! Parameters are `&self`, memory is `&mut state`; every state can be copied as a snapshot. Axes: x
//! forward, y right, z down. SI units; the unit stands at the end of a name.
#![no_std]
#![forbid(unsafe_code)]

pub mod compensation;
pub mod damper;
pub mod fnv;
pub mod guard;
pub mod lanes;
pub mod line;
pub mod track;
pub mod vehicle;
pub mod wheel_rail;
