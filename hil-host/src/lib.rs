//! The host of a damper bench: buses, clock, control loop, emulated rig, recorder, report of a run.
//!
//! One control cycle is one straight line, [`control::Session::cycle`]:
//! ```text
//! receive -> decode -> guard -> vehicle step -> compensate -> encode -> send -> record
//! ```
//!
//! Read in this order:
//!
//! 1. [`bus`]: a trait of four methods, with emulated rigs in memory or `SocketCAN` behind it.
//! 2. [`clock`]: absolute deadlines on a grid that never shifts; [`realtime`]: what the kernel is
//!    asked for.
//! 3. [`control`]: the loop, and the watch over the damper of each rig.
//! 4. [`rig`]: the other end of the bus, in line or as a process of its own; `reset` releases one
//!    that is latched; [`Draw`] is the source of the numbers of both sides.
//!    The delay that a rig leaves to the force is measured in blocks
//!    ([`firmware_core::line::DelayBlocks`]).
//! 5. [`gateway`]: a rig that speaks its own messages, by its DBC, behind a bus of ours.
//! 6. [`record`]: rows and frames leave the loop through bounded queues; a record or a bus log is
//!    read back as a damper test.
//! 7. [`faults`]: faults that are injected into a coupled run in virtual time.
//! 8. [`run`](mod@run): from a scenario to a result folder. Behind it, private: `counts` (while
//!    it goes on), `statistics` (from the record), `summary` (`summary.json`), `page`
//!    (`report.html`), `comparison` (the same run with another damper). [`rehearse`] runs it in
//!    memory first, and says how far every limit is away. [`side_by_side()`] reads finished runs
//!    and says which of their differences repeats do not explain.
//! 9. [`live`]: a page on this machine to watch a run and to end it.
//! 10. [`calibration`]: stiffness, skew, end mass and gain of a rig, from tests in open loop.
//!
//! Layers: `firmware-core` computes a cycle and `can-protocol` its frames; `scenario` reads the
//! input, `files` guards it and the result folder, `signal` and `report` make the statistics and
//! the page, `measurement` is the form in which a run is read back. No study is known here. What
//! goes wrong around a run is a [`BenchError`]; inside the loop nothing is an error.

pub mod bus;
pub mod calibration;
pub mod clock;
mod comparison;
pub mod control;
mod counts;
pub mod doctor;
mod draw;
mod error;
pub mod faults;
mod force_group;
pub mod gateway;
mod linear_vehicle;
pub mod live;
mod measured_ram;
mod options;
mod page;
mod progress_bar;
pub mod realtime;
pub mod record;
mod rehearsal;
pub mod replay;
mod reset;
pub mod rig;
pub mod rtcheck;
pub mod run;
mod side_by_side;
mod silence;
pub mod stability;
mod statistics;
mod summary;
pub mod track_server;
mod wear_map;

pub use comparison::{ComparedDamper, ComparedEffect, Comparison, Quantity};
pub use draw::Draw;
pub use error::BenchError;
pub use linear_vehicle::{Hunting, LinearMode, LinearVehicle};
pub use measured_ram::{MeasuredRam, MeasuredRams};
pub use options::{PaceChoice, RunOptions};
pub use rehearsal::{CheckMargin, LimitOf, Rehearsal, TRACKING, Verdict, rehearse};
pub use reset::{reset_over, reset_rig};
pub use side_by_side::{
    Aba, ComparedGroup, ComparedRun, Difference, Differing, GroupComparison, QuantityRepeats,
    RunGroups, SideBySide, Spread, Trust, side_by_side,
};
pub use summary::{
    Acceleration, Accelerations, ArmedSession, BusCount, DamperSummary, ForceRange, Frames,
    MeasuredDelay, Percentiles, StandInSummary, StepPercentiles, Stroke, Summary, TrackingSummary,
    WearSummary,
};
pub use wear_map::{Cell as WearCell, Question as WearQuestion, Sine, WearMap, wear_map};
