//! The two ends of the bus, without an operating system.
//!
//! - [`rig`]: a rig as the bus sees it, around any [`rig::Plant`]: emulated on the host, or a real
//!   one behind a microcontroller.
//! - [`locomotive`]: the host's end with one rig, where no operating system is.
//! - [`track`]: the track by messages, for a locomotive without memory for all of it.
//! - [`timed`]: either of them, driven by a timer and with a CAN driver of `embedded_can`;
//!   [`loopback`] and [`serial_line`] are doubles of one.
//!
//! Frames and cycles go in, frames come out; there is no clock, no bus and no source of numbers
//! here. What the host runs and what a Cortex-M7 runs is the same code, and gives the same bits.
//!
//! Layers: `can-protocol` has the frames and the arming exchange, `firmware-core` the states. The
//! physics of an emulated rig is `rig-emulator`; processes, clocks and SocketCAN are `hil-host`.
#![no_std]
#![forbid(unsafe_code)]

pub mod can;
pub mod locomotive;
pub mod loopback;
pub mod rig;
pub mod serial_line;
pub mod timed;
pub mod track;
mod wire_frame;
mod wire_state;

pub use wire_frame::{MAX_BYTES, WireFrame};
pub use wire_state::wire_state;

/// Cycles without a valid command after which a commanded rig goes safe.
pub const WATCHDOG_CYCLES: u32 = 5;
