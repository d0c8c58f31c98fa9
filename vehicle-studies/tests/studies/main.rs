//! Studies as a command asks them.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod among_others;
mod changed_files;
mod from_below;
mod late_rigs;
mod no_dampers;
mod stopped;
mod support;
mod yaw_damper;
