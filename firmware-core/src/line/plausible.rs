//! Whether a vehicle is still on its track: all numbers, wheels near their rails, dampers within
//! any stroke.

use super::SlotState;
use crate::lanes::Lanes;
use crate::vehicle::{DAMPER_SLOTS, Vehicle, VehicleState};

/// No wheel is further than this from its rail (m).
const SHIFT_MAX_M: f64 = 0.1;
/// No yaw damper is stroked further than this (m).
const STROKE_MAX_M: f64 = 0.5;

/// Whether the vehicle in a lane is on its track after a step; `motions` are those of its dampers
/// and `slots` what they remember.
pub fn is_plausible<const L: usize>(
    vehicle: &Vehicle,
    state: &VehicleState<L>,
    motions: &[(Lanes<L>, Lanes<L>); DAMPER_SLOTS],
    slots: &[SlotState; DAMPER_SLOTS],
    lane: usize,
) -> bool {
    let near = |value: f64, bound: f64| value.abs() <= bound;
    let mut wheels = state.shifts_m.iter().take(vehicle.axles.len()).flatten();
    let mut strokes = motions.iter().zip(slots);
    state.is_finite_in(lane)
        && wheels.all(|shift| near(shift.lane(lane), SHIFT_MAX_M))
        && strokes.all(|((extension, _), slot)| {
            near(extension.lane(lane) - slot.mid_stroke_m, STROKE_MAX_M)
        })
}
