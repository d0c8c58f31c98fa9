//! Studies of a vehicle.

pub mod critical_speed;
pub mod curve;
pub mod describing_function;
pub mod modes;
pub mod over_keys;
pub mod ride;
pub mod study;
pub mod sweep;
pub mod trip;
