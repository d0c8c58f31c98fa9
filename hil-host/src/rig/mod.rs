//! The emulated rig: a [`nodes::rig::RigNode`] around the physics of `rig-emulator`.
//!
//! It runs in line on the memory bus and in its own process ([`process`]). The same frames get the
//! same answers, bit for bit.

mod account;
pub mod process;
mod replayed;

pub use nodes::WATCHDOG_CYCLES;
pub use nodes::rig::{Condition, FrameCounts, LAGGING_M, Timing};
pub(crate) use nodes::rig::{Outbox, Says, Session, follow};
pub use rig_emulator::{
    DECELERATION_M_PER_S2, Emulator, EmulatorState, Limits, RamState, Reading, Reference, Target,
};

use crate::draw::Draw;

/// An emulated rig on the bus. A clone is a snapshot; comparing two compares everything they
/// remember.
pub type RigNode = nodes::rig::RigNode<Emulator, Draw>;

impl nodes::rig::Numbers for Draw {
    fn seeded(seed: u64, stream: u64) -> Self {
        Self::seeded(seed, stream)
    }

    fn number(&mut self) -> u32 {
        self.number()
    }
}
