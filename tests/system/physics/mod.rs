//! The physics of the locomotive: what must hold whatever the numbers in its file.

#![expect(clippy::large_stack_arrays, reason = "dampers are large, a test's stack is larger")]

mod contact_sweep;
mod convergence;
mod equilibrium;
mod lanes;
mod locomotive;
mod long_rest;
mod signs;
mod worn_out;
