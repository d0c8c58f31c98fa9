//! What happens to the displacement on its way from the vehicle to a rig.
//!
//! At present: wear injected in software. Compensation of the rig's delay will be added, one file
//! each; until then the fixed latency of the loop (one cycle, plus the actuator) stays in the loop.

mod virtual_wear;

pub use virtual_wear::{VirtualWear, VirtualWearState};
