//! The trajectory hash: one number that two runs share only when every bit of them is the same.
//!
//! FNV-1a ([`firmware_core::fnv`]) over 64-bit words instead of bytes. The words are the IEEE bits
//! of the positions of all bodies and rails, then of the forces in the damper slots, every cycle.

use firmware_core::fnv;
use firmware_core::line::LineState;
use firmware_core::vehicle::Vehicle;

/// Name of the algorithm in `summary.json`.
pub(crate) const ALGORITHM: &str = "fnv1a-64 over little-endian f64 words";

/// The hash of nothing.
pub(super) const START: u64 = fnv::START;

/// Adds one cycle.
pub(super) fn add_cycle(hash: u64, vehicle: &Vehicle, state: &LineState) -> u64 {
    let bodies = state.vehicle.position.iter().take(vehicle.bodies.len()).flatten();
    let rails = state.vehicle.rail_position.iter().take(vehicle.axles.len()).flatten().flatten();
    let forces = state.vehicle.damper_n.iter();
    let mut hash = hash;
    for value in bodies.chain(rails).chain(forces) {
        hash = fnv::add(hash, value.lane(0).to_bits());
    }
    hash
}
