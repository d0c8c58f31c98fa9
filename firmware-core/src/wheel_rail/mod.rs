//! Wheel and rail.

pub mod geometry;
