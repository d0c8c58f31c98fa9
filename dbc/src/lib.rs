//! Message databases (DBC): which bits of a CAN frame hold which physical value.
//!
//! A [`Database`] is read once. A [`Signal`] of it is a plan that is ready to use: bit positions,
//! scaling and limits in fixed arrays. Reading and writing a payload with it allocates nothing and
//! cannot fail; a value that does not fit is saturated and reported, and never wraps.
//!
//! ```
//! use dbc::{Database, Value};
//! let text = "BO_ 256 MOTION: 4 RIG\n SG_ FORCE : 7|16@0- (0.5,0) [0|0] \"N\" HOST\n";
//! let database = Database::from_text("rig.dbc".as_ref(), text)?;
//! let (message, force) = database.signal("FORCE")?;
//! assert_eq!((message.id.raw(), force.unit.as_str()), (0x100, "N"));
//! let mut data = [0; 8];
//! force.signal.write(&mut data, -1.0);
//! assert_eq!(data[..2], [0xFF, 0xFE]);
//! assert_eq!(force.signal.read(&data), Value::Valid(-1.0));
//! # Ok::<(), dbc::DbcError>(())
//! ```
//!
//! Read in this order: `field` (bits), `signal` (values), `multiplex` (signals that are there only
//! sometimes), `overlap` (signals on the same bits), `database` (the file), `lines` (where a
//! message or a signal stands in it).

mod database;
mod error;
mod field;
mod id;
mod lines;
mod multiplex;
mod overlap;
mod signal;

pub use database::{Database, Message, NamedSignal};
pub use error::DbcError;
pub use id::CanId;
pub use signal::{Fit, Signal, Value};
