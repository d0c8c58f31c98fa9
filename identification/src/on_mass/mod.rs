//! Force in, motion out: a body on a damper, its force measured and its motion predicted.
//!
//! ```text
//! m y'' = u - k0 y - c0 y' - F(y, y')
//! ```
//!
//! A linear body first; then candidates of motion, one law after the other.

mod body;
mod candidates;
mod control;
mod fit;
mod inter_sample;
mod law;
mod linear;
mod model;
mod periods;
mod record;
mod search;
mod travel;
#[cfg(test)]
mod prototype;

pub use control::OnMassControl;
