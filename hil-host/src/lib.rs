//! The host of a damper bench: bus, clock, control loop, emulated rig, recorder, command line.
//!
//! One control cycle is one straight line, [`control::Session::cycle`]:
//! ```text
//! receive -> decode -> guard -> vehicle step -> compensate -> encode -> send -> record
//! ```
//! Frames come and go over a [`bus`]: emulated rigs in memory, or SocketCAN. The [`clock`] keeps
//! absolute deadlines, [`realtime`] asks the kernel for what it may give. Rows and frames leave
//! through bounded queues to the [`record`]; [`columns`], [`summary`] and [`page`] turn them into
//! numbers and a report, [`comparison`] sets a run beside the same run with another damper.
//! [`characterise`] is a visit to a damper bench. [`rig`] is the other end of the bus, in line or as a
//! process of its own.

pub mod bus;
pub mod clock;
pub mod columns;
pub mod comparison;
pub mod control;
pub mod page;
pub mod realtime;
pub mod record;
pub mod rig;
pub mod run;
pub mod summary;
