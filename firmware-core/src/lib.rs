//! The vehicle, the contact, the damper: a fixed step without heap.
#![no_std]
#![forbid(unsafe_code)]

pub mod damper;
pub mod lanes;
pub mod track;
pub mod vehicle;
pub mod wheel_rail;
