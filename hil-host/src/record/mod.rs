//! The record: rows and frames leave the loop through bounded queues and never hold it up.
//!
//! The loop puts entries into two queues that hold four seconds. One ordinary thread per queue
//! polls it and writes what it finds at once, so that a program that is killed leaves all but the
//! last hundredths of a second; a third thread has the disk hold it. A third queue, for the few
//! notices of the loop, is emptied by the thread of the rows. A full queue drops and
//! counts where a clock sets the pace; without a clock the loop waits for room. What the disk does
//! not take is dropped and counted too. [`measured`] reads a record or a bus log back as a damper
//! test.

mod bus_log;
mod durable;
mod events;
mod force_source;
mod input_kind;
mod log_reader;
mod loss;
pub mod measured;
mod npy;
mod parts;
mod places;
mod queues;
mod reference;
mod row;
mod storage;

pub use bus_log::{BusEvent, BusLog, Direction};
pub(crate) use durable::OpenFiles;
pub use events::RunEvent;
pub(crate) use events::{EventLog, read_events};
pub use force_source::ForceSource;
pub use input_kind::InputKind;
pub(crate) use log_reader::{LogFault, LogLine, LogReader};
pub(crate) use loss::Loss;
pub use npy::NpyWriter;
pub(crate) use npy::{RowReader, rows_of};
pub(crate) use parts::{InParts, PART_CYCLES, by_part, open_parts, part_name, part_of, parts};
pub(crate) use places::ABOUT;
pub use queues::{Drain, LoggedFrame, Outlet, Queues, ROWS, Recorder};
pub(crate) use reference::column_reference;
pub use row::{FrameBytes, Row};
pub use storage::Storage;
