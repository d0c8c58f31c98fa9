//! Runs of the core that must give the same bits on every processor.
//!
//! The image makes them on its board, and its build script makes them on the host that builds it.
//! Each ends as one hash, so that two machines agree on every bit or on none.
//!
//! 1. [`locomotive`]: the creep laws under the whole vehicle; [`contact`]: what their tables hold.
//! 2. [`effect`]: each effect on a damper alone.
//! 3. [`two_roles`]: the locomotive and the rig as nodes of one bus.
//! 4. [`compensator`], [`state_machine`], [`codec`]: what surrounds the step.
#![no_std]
#![forbid(unsafe_code)]

pub mod codec;
pub mod compensator;
pub mod contact;
pub mod effect;
pub mod locomotive;
mod random;
pub mod state_machine;
pub mod two_roles;
mod two_sines;

pub use random::Random;
