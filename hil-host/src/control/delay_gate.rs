//! The gate before RUN: what the delay of a rig costs, measured before its force acts.
//!
//! ```text
//! RAMP_IN:  motion faded in | delay measured | force faded in | RUN
//! ```
//! Between the fades the ram moves with the vehicle and the model's force acts. The first second
//! is for the compensator to settle; the blocks behind it give the delay with its interval
//! ([`DelayBlocks`]). Where the worse end of it costs more than [`COST_REFUSED`] of the damping at
//! the hunting frequency the session ramps out before the measured force has acted, unless the slot
//! accepts that. A slot whose motion is too small to measure passes: nothing is known of it, and
//! the summary says so.

use firmware_core::line::{BLOCK_S, DelayBlocks, FEWEST_BLOCKS};
use firmware_core::vehicle::DAMPER_SLOTS;
use firmware_core::virtual_wear::WearFound;
use scenario::run::MEASURING_S;

/// Share of the damping from which on a run is warned of.
pub const COST_WARNED: f64 = 0.02;
/// Share of the damping from which on it is refused.
pub const COST_REFUSED: f64 = 0.05;

/// Time before the blocks: a compensator settles (s).
pub(super) const SETTLING_S: f64 = BLOCK_S;

// One block more than an interval needs.
const _: () = assert!(MEASURING_S == SETTLING_S + (FEWEST_BLOCKS + 1) as f64 * BLOCK_S);

/// Parameters of the gate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DelayGate {
    /// The hunting frequency, Hz.
    pub hunting_hz: f64,
    /// Slots whose cost is accepted whatever it is.
    pub accepted: [bool; DAMPER_SLOTS],
}

/// What the gate has measured.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DelayGateState {
    /// The delays by slot.
    pub delays: [DelayBlocks; DAMPER_SLOTS],
    /// What was found of wear in software, by slot, once it is judged.
    pub wear: [Option<WearFound>; DAMPER_SLOTS],
    /// Whether they are judged.
    pub(super) is_judged: bool,
}
