//! The physics of the locomotive: what must hold whatever the numbers in its file.

#![expect(clippy::unwrap_used, reason = "a test stops where it fails")]

mod contact_sweep;
mod convergence;
mod energy;

mod equilibrium;
mod lanes;
mod locomotive;
mod signs;
