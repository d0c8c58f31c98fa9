//! The control loop.
//!
//! ```text
//! receive -> decode -> guard -> vehicle step -> compensate -> encode -> send -> record
//! ```
//! and then the wait for the next tick. [`Session::cycle`] is that line. Between receive and send
//! it neither allocates nor locks, logs or calls through a pointer.
//!
//! A [`Session`] holds the parameters and [`SessionState`] everything that changes; a [`Course`] is
//! the track under a long run. [`Buses`] are its buses and the recorder that keeps every frame.
//! [`Session::greet`] meets the rigs and arms them. A [`Port`] is the host's end of one rig: what
//! is believed of it, what it says of itself, and a [`Watch`] over its damper. A [`DelayGate`]
//! keeps a session from RUN whose delay costs too much of the damping. The first cause that ends a
//! run is a [`Stop`]; `drop_out` has the rigs without which one goes on. [`Session::notify`] hands
//! it to the events of the run, and what a check has noted.

mod arming;
mod buses;
mod course;
mod cycle;
mod delay_gate;
mod drop_out;
mod greeting;
mod hash;
mod measuring;
mod no_answer;
mod notices;
mod open_loop;
mod pacing;
mod port;
mod recent_skips;
mod requests;
mod row;
mod session;
mod stop;
mod stopwatch;
mod terms;
mod watch;

pub use buses::Buses;
pub use course::{Course, NoStretch};
pub use delay_gate::{COST_REFUSED, COST_WARNED, DelayGate, DelayGateState};
pub use no_answer::NoAnswer;
pub use notices::Notices;
pub use open_loop::{Motion, Seen};
pub(crate) use pacing::Ending;
pub use pacing::{End, Pace, STOP_S};
pub(crate) use port::{Agreed, MOST_FORCE_N};
pub use port::{Port, PortState};
pub use requests::{Asker, Requests};
pub use session::{Session, SessionState};
pub use stop::{DropOutSummary, NotedSummary, Notice, Stop, StopSummary};
pub(crate) use stopwatch::{Stage, Stopwatch};
pub use terms::Arming;
pub use watch::{View, Watch, WatchState};

pub(crate) use hash::ALGORITHM as HASH_ALGORITHM;
