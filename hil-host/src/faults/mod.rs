//! Faults that are injected into a coupled run in virtual time, and what became of each.
//!
//! [`table()`] runs through the faults that have a name and an expected outcome, [`drop_outs()`]
//! through those of a rig without which the vehicle goes on; [`schedule()`] through random ones,
//! session after session; [`lose_at_random`] loses frames for hours. They run the loop itself: the
//! vehicle, the memory bus with an emulated rig, and a [`FaultyBus`] between them. A cycle takes no
//! time, and cycles are counted exactly. [`listen_to_sound_rigs`] runs sound rigs, on which every
//! alarm is a false one. This is a test of the loop and no safety function.

mod change;
mod drop_outs;
mod faulty_bus;
mod kind;
mod loss;
mod opener;
mod schedule;
mod session;
mod sound;
mod table;

pub use drop_outs::{drop_out_rows, drop_outs, on_rigs};
pub use faulty_bus::FaultyBus;
pub use kind::Fault;
pub use loss::{Losses, lose_at_random};
pub use opener::Opener;
pub use schedule::{Survey, schedule};
pub use session::{Injected, Injection, Violation, inject};
pub use sound::{
    FalseAlarm, Heard, SoundCase, SoundScenarios, alarm_rate_bound_per_h, listen_to_sound_rigs,
    sound_cases,
};
pub use table::{Expected, ROWS, Row, table};
