//! Scenarios from files: what is read, what is refused, and in which words.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod dampers;
mod inputs;
mod refused;
mod rigs;
mod support;
mod vehicle;
