//! Wheel and rail: contact geometry tables, Hertz, Kalker, creep laws.

pub mod creep;
pub mod geometry;
pub mod hertz;
pub mod kalker;
pub mod table;
pub mod wheel;
