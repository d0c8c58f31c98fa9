//! The record: rows and frames leave the loop through bounded queues and never hold it up.
//!
//! The loop pushes into two heapless single-producer queues. One ordinary thread drains them and
//! sends what it finds to the record file, the bus log, and the progress and statistics. A full
//! queue drops and counts where a clock sets the pace; without a clock the loop waits for room.
//! [`measured`] reads a record or a bus log back as a damper test.

mod bus_log;
mod input_kind;
pub mod measured;
mod npy;
mod queues;
mod row;

pub use bus_log::{BusEvent, BusLog};
pub use input_kind::InputKind;
pub use npy::NpyWriter;
pub use queues::{Batch, Drain, EVENTS, Queues, ROWS, Recorder};
pub use row::{FrameBytes, Row};
