//! Identification on records whose truth is known.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod empirical_map;
mod findings;
mod interruption;
mod neighbours;
mod on_mass;
mod one_test;
mod support;
mod without_cycles;
