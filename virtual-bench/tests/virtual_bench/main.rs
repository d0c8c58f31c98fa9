//! A visit from its files to its records and back.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod round_trip;
mod stopping;
mod support;
