//! A wheelset on its two rails.
//!
//! Each wheel stands on an effective rail mass with lateral and vertical stiffness and damping (the
//! Mr, Kry, Cry, Krz, Crz of the SS9 study): rail, sleeper and the moving share of the ballast as
//! one mass that travels with the wheel.

use super::body::{BodyId, LATERAL, PITCH, Pose, ROLL, VERTICAL, YAW};
use crate::track::{IrregularitySample, LayoutPoint};
use crate::wheel_rail::table::ContactTable;
use crate::wheel_rail::wheel::{Surface, Wheel, WheelForce, WheelMotion};

/// Effective rail mass under one wheel and what holds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RailSupport {
    /// Moving mass, lateral and vertical (kg).
    pub mass_kg: [f64; 2],
    /// Stiffness, lateral and vertical (N/m).
    pub stiffness_n_per_m: [f64; 2],
    /// Damping, lateral and vertical (N s/m).
    pub damping_n_s_per_m: [f64; 2],
}

/// A wheelset with two equal wheels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axle {
    /// The rolling body.
    pub body: BodyId,
    /// Both wheels.
    pub wheel: Wheel,
    /// The rail under each; `None` for a rail that does not give way.
    pub rail: Option<RailSupport>,
}

/// Displacement or velocity of one rail: right, down.
pub(super) type RailPose = [f64; 2];

impl Axle {
    pub(super) fn runs_on_profiles(&self) -> bool {
        self.wheel.surface == Surface::Profiles
    }

    /// Force of one wheel on the wheelset, in its local axes; `side` is +1 right, -1 left.
    #[inline(always)]
    pub(super) fn wheel_force(
        &self,
        table: Option<&ContactTable>,
        side: f64,
        position: &[f64; 5],
        velocity: &[f64; 5],
        rail: [RailPose; 2],
        place: &Place,
    ) -> (WheelForce, f64) {
        debug_assert!(side.abs() == 1.0, "side {side}, expected 1 or -1");
        debug_assert!(self.wheel.radius_m > 0.0, "a wheel of {} m", self.wheel.radius_m);
        let [rail_position, rail_velocity] = rail;
        let (irregular_right, irregular_down) = place.irregularity.rail(side);
        let roll = side * position[ROLL];
        let right = position[LATERAL] - rail_position[0] - irregular_right;
        let down = position[VERTICAL] - rail_position[1] - irregular_down;
        let motion = WheelMotion {
            shift_m: side * right - roll * self.wheel.radius_m,
            drop_m: down + roll * self.wheel.tape_m,
            roll_rad: roll,
            yaw_rad: side * position[YAW],
            lateral_m_per_s: side * (velocity[LATERAL] - rail_velocity[0]),
            vertical_m_per_s: velocity[VERTICAL] - rail_velocity[1],
            roll_rad_per_s: side * velocity[ROLL],
            spin_rad_per_s: velocity[PITCH] - place.speed_m_per_s / self.wheel.radius_m,
            yaw_rad_per_s: side
                * (velocity[YAW] + place.speed_m_per_s * place.layout.curvature_per_m),
            speed_m_per_s: place.speed_m_per_s,
        };
        (self.wheel.force(table, &motion), motion.shift_m)
    }
}

/// Where a wheelset is and how fast it runs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) speed_m_per_s: f64,
    pub(super) layout: LayoutPoint,
    pub(super) irregularity: IrregularitySample,
}

/// Adds the forces of both wheels to their wheelset, as one sum, so that a mirrored vehicle gets
/// the mirrored force to the last bit.
#[inline(always)]
pub(super) fn add_wheels<const L: usize>(
    forces: &mut Pose<L>,
    lane: usize,
    left: &WheelForce,
    right: &WheelForce,
) {
    forces[LATERAL].add_lane(lane, right.lateral_n - left.lateral_n);
    forces[VERTICAL].add_lane(lane, right.vertical_n + left.vertical_n);
    forces[ROLL].add_lane(lane, right.roll_n_m - left.roll_n_m);
    forces[PITCH].add_lane(lane, right.pitch_n_m + left.pitch_n_m);
    forces[YAW].add_lane(lane, right.yaw_n_m - left.yaw_n_m);
}
