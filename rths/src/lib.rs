//! The virtual benchmark of real-time hybrid simulation of Silva, Gomez, Maghareh, Dyke and
//! Spencer (2020): a frame of three storeys under an earthquake, of which one part is simulated and
//! one part is a specimen on an actuator, simulated too. It asks how well a compensator makes the
//! actuator follow, and how close the coupled motion comes to that of the whole frame.
//!
//! The crate is built from the published numbers and contains no code of the benchmark. Its results
//! can be compared with the published table of the benchmark's own controller.
//!
//! Read in this order:
//!
//! 1. [`Case`], `structure`: the four frames, whole and without the specimen.
//! 2. `plants`: plants that differ from the nominal one, [`rig_emulator::BenchmarkPlant`].
//! 3. [`Record`]: the motion of the ground.
//! 4. `simulation`: one run in steps of 1/4096 s, with noise, converters and delays; `baseline`:
//!    the controller of the published table, the alternative to a compensator of `firmware-core`.
//! 5. [`Criteria`]: J1 to J9.
//! 6. `controllers`: what is compared; [`Benchmark`]: all runs, and [`published`], what they are
//!    compared with.

mod baseline;
mod benchmark;
mod case;
mod controllers;
mod criteria;
mod error;
mod plants;
pub mod published;
mod record;
mod simulation;
mod structure;

pub use benchmark::{
    Aim, BaselineRow, Benchmark, DelayRow, NOISE_SEEDS, NominalRow, Outside, PLANTS, PerturbedRow,
    Statistics, run,
};
pub use case::{CASES, Case};
pub use controllers::{COMPENSATORS, Candidate};
pub use criteria::{Criteria, NAMES};
pub use error::RthsError;
pub use record::{Record, SYNTHETIC_DURATION_S};
