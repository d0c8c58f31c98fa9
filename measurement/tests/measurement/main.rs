//! Files as users give them: what is read, what is refused, and what a message shows of them.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod cases;
mod companions;
mod exports;
mod inputs;
mod programs;
mod support;
