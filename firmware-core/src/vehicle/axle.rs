//! A wheelset on its two rails.
//!
//! Each wheel stands on an effective rail mass with lateral and vertical stiffness and damping (the
//! Mr, Kry, Cry, Krz, Crz of the SS9 study): rail, sleeper and the moving share of the ballast as
//! one mass that travels with the wheel.

use super::body::{BodyId, LATERAL, PITCH, ROLL, VERTICAL, YAW};
use crate::number::Number;
use crate::wheel_rail::wheel::{Surface, Wheel, WheelMotion};

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
type RailPose<N> = [N; 2];

impl Axle {
    pub(super) fn runs_on_profiles(&self) -> bool {
        self.wheel.surface == Surface::Profiles
    }

    /// Motion of wheels against their rails, in their local axes.
    #[inline(always)]
    pub(super) fn wheel_motion<N: Number>(
        &self,
        position: &[N; 5],
        velocity: &[N; 5],
        rail: [RailPose<N>; 2],
        place: &Place<N>,
    ) -> WheelMotion<N> {
        debug_assert!(self.wheel.radius_m > 0.0, "a wheel of {} m", self.wheel.radius_m);
        let [rail_position, rail_velocity] = rail;
        let [irregular_right, irregular_down] = place.irregular_m;
        let (side, radius_m) = (place.side, N::splat(self.wheel.radius_m));
        let roll = side * position[ROLL];
        let right = position[LATERAL] - rail_position[0] - irregular_right;
        let down = position[VERTICAL] - rail_position[1] - irregular_down;
        WheelMotion {
            shift_m: side * right - roll * radius_m,
            drop_m: down + roll * N::splat(self.wheel.tape_m),
            roll_rad: roll,
            yaw_rad: side * position[YAW],
            lateral_m_per_s: side * (velocity[LATERAL] - rail_velocity[0]),
            vertical_m_per_s: velocity[VERTICAL] - rail_velocity[1],
            roll_rad_per_s: side * velocity[ROLL],
            spin_rad_per_s: velocity[PITCH] - place.speed_m_per_s / radius_m,
            yaw_rad_per_s: side * (velocity[YAW] + place.speed_m_per_s * place.curvature_per_m),
            speed_m_per_s: place.speed_m_per_s,
        }
    }
}

/// Where wheels are and how fast they run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place<N> {
    /// +1 right, -1 left.
    pub(super) side: N,
    pub(super) speed_m_per_s: N,
    pub(super) curvature_per_m: N,
    /// Irregularity of the rail: right, down (m).
    pub(super) irregular_m: [N; 2],
}
