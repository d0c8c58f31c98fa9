//! What a rig shows of itself to whoever owns it: states, counts, the last reading.

use super::{Condition, FrameCounts, Numbers, Plant, Reading, RigNode, Timing};
use crate::wire_state::wire_state;
use can_protocol::{Node, Pace, RunState};
use firmware_core::supervision::State;

impl<P: Plant, N: Numbers> RigNode<P, N> {
    /// Its number.
    pub fn node(&self) -> Node {
        self.node
    }

    /// The number that it drew when it started.
    pub fn boot(&self) -> u32 {
        self.boot
    }

    /// Period, slow-down, pace and profile, as the last sync set them.
    pub fn timing(&self) -> Timing {
        self.timing
    }

    /// Who waits for whom.
    pub fn pace(&self) -> Pace {
        self.timing.pace
    }

    /// Its run state.
    pub fn run_state(&self) -> RunState {
        wire_state(self.machine)
    }

    /// Whether the ram follows commands.
    pub fn is_coupled(&self) -> bool {
        self.machine.moves()
    }

    /// Whether it stays in SAFE or FAULT until it is reset.
    pub fn is_latched(&self) -> bool {
        matches!(self.machine, State::Safe | State::Fault)
    }

    /// Whether nobody commands it: no session is armed, or its first command has not come yet.
    pub fn is_idle(&self) -> bool {
        !self.session.is_commanded()
    }

    /// Whether a session is armed, and not ended.
    pub fn is_armed(&self) -> bool {
        self.session.is_armed()
    }

    /// Its condition.
    pub fn condition(&self) -> Condition {
        self.condition
    }

    /// Whether the ram stands still, as its plant has it.
    pub fn is_at_rest(&self) -> bool {
        self.plant.is_at_rest(&self.state)
    }

    /// Cycles since it exists.
    pub fn cycles(&self) -> u64 {
        self.cycles
    }

    /// How often it was armed and set running.
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// How often it went to SAFE or FAULT by itself.
    pub fn safe_events(&self) -> u64 {
        self.safe_events
    }

    /// How the commands were received.
    pub fn frames(&self) -> FrameCounts {
        self.session.counts()
    }

    /// What its sensors showed last.
    pub fn last(&self) -> Option<Reading> {
        self.last
    }

    /// The physics: what the sensors would show without noise.
    pub fn physics(&self) -> &P::State {
        &self.state
    }
}
