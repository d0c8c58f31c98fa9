//! `yawbench doctor`: is this machine ready for a control loop at 1 kHz, and is the bus?
//!
//! Reading and judging are apart. [`Machine`] and [`BusFacts`] are plain facts, read from files of
//! the kernel and from `ip`; [`judge_machine`] and [`judge_bus`] are pure functions from facts to
//! [`Check`]s, so that tests hold every row against machines that nobody has. [`ResponseTimes`] is
//! arithmetic on a list of messages, whose periods come from a DBC or from the protocol.
//!
//! Nothing is changed: every [`Check`] names the change, and a person makes it.

mod bus;
mod bus_facts;
mod bus_message;
mod check;
mod machine;
mod machine_facts;
mod messages;
mod process_facts;
mod response_time;

pub use bus::{Wanted, judge_bus};
pub use bus_facts::{BusFacts, Controller, InterfaceKind, Timing};
pub use bus_message::{BitRates, BusMessage};
pub use check::{Check, Verdict, asks_for_a_change, lines};
pub use machine::judge_machine;
pub use machine_facts::Machine;
pub use messages::{messages_of_dbc, messages_of_protocol};
pub use process_facts::Process;
pub use response_time::{ResponseTime, ResponseTimes, response_times};
