//! The physics of an emulated rig: what moves the ram, and what is mounted on it.
//!
//! [`Emulator`] is a rig that exists only as numbers. A cycle takes a [`Target`] and gives a
//! [`Reading`]; the same cycles give the same bits on every machine. The drive is one of three:
//!
//! | kind | what moves the ram | late because of |
//! | --- | --- | --- |
//! | `ideal` | a lag and a limit of the speed | a number |
//! | `servo` | position controller, servo-valve, cylinder with compressible oil | physics |
//! | `rths-benchmark` | the plant of a published benchmark, [`BenchmarkPlant`] | physics, as published |
//!
//! Read in this order:
//!
//! 1. [`nodes::rig::Ram`]: the ram that follows, stops and centres.
//! 2. `emulator`: delay line, drive, sensors; `plant`: the emulator behind a node of the bus.
//! 3. `ideal`, `servo`, `benchmark`: the drives. Each moves the same `mechanics`, and what is
//!    mounted on it (`specimen`).
//! 4. [`benchmark_plant`], with [`runge_kutta`]: the plant alone, which `rths` uses too.
//! 5. `noise`: the sensors' noise.
//!
//! Layers: `scenario` reads the file of a rig, `firmware-core` has the damper. What a rig says on a
//! bus, and when it may move, is `nodes`.

mod benchmark;
pub mod benchmark_plant;
mod emulator;
mod ideal;
mod integration;
mod mechanics;
mod noise;
mod plant;
mod servo;
mod specimen;

pub use benchmark_plant::BenchmarkPlant;
pub use emulator::{AT_REST_M_PER_S, Emulator, EmulatorState};
pub use integration::runge_kutta;
pub use nodes::rig::{DECELERATION_M_PER_S2, Limits, RamState, Reading, Reference, Target};
