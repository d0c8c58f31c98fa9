//! The trajectory hash: one number that two runs share only when every bit of them is the same.
//!
//! FNV-1a ([`crate::fnv`]) over 64-bit words instead of bytes. The words are the IEEE bits of the
//! positions of all bodies and rails, then of the forces in the damper slots, every cycle.

use super::LineState;
use crate::fnv;
use crate::vehicle::Vehicle;

impl LineState {
    /// Adds the cycle that was done last to the hash of those before it, from [`fnv::START`].
    #[must_use]
    pub fn hashed(&self, hash: u64, vehicle: &Vehicle) -> u64 {
        let bodies = self.vehicle.position.iter().take(vehicle.bodies.len()).flatten();
        let rails = self.vehicle.rail_position.iter().take(vehicle.axles.len()).flatten().flatten();
        let forces = self.vehicle.damper_n.iter();
        bodies
            .chain(rails)
            .chain(forces)
            .fold(hash, |hash, value| fnv::add(hash, value.lane(0).to_bits()))
    }
}
