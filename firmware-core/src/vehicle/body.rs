//! Rigid bodies and the numbers by which elements find them.

use crate::lanes::Lanes;
use nalgebra::Vector3;

/// Places for bodies in a vehicle; the last one is the ground.
pub const BODIES_MAX: usize = 16;

/// Coordinates of a body, in this order: lateral, vertical (m), roll, pitch, yaw (rad).
pub const COORDINATES: usize = 5;
/// Index of the lateral coordinate.
pub const LATERAL: usize = 0;
/// Index of the vertical coordinate.
pub const VERTICAL: usize = 1;
/// Index of the roll coordinate.
pub const ROLL: usize = 2;
/// Index of the pitch coordinate.
pub const PITCH: usize = 3;
/// Index of the yaw coordinate.
pub const YAW: usize = 4;

/// One value per coordinate of a body and lane.
pub type Pose<const L: usize> = [Lanes<L>; COORDINATES];

/// A rigid body that moves with the track frame at its own station.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Mass (kg).
    pub mass_kg: f64,
    /// Moments of inertia about its centre: roll, pitch, yaw (kg m2).
    pub inertia_kg_m2: [f64; 3],
    /// Which of the five coordinates are free.
    pub free: [bool; COORDINATES],
    /// Position of the centre along the vehicle, forward positive (m).
    pub station_m: f64,
    /// Height of the centre above the rail head (m).
    pub height_m: f64,
    /// Nominal rolling radius of a body that rolls on the track (m).
    pub rolling_radius_m: Option<f64>,
}

impl Body {
    /// Mass or inertia that belongs to a coordinate.
    pub fn inertia(&self, coordinate: usize) -> f64 {
        debug_assert!(coordinate < COORDINATES, "coordinate {coordinate} of {COORDINATES}");
        let [roll, pitch, yaw] = self.inertia_kg_m2;
        match coordinate {
            LATERAL | VERTICAL => self.mass_kg,
            ROLL => roll,
            PITCH => pitch,
            _ => yaw,
        }
    }
}

/// Number of a body in its vehicle. Always inside `0..BODIES_MAX`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BodyId(u8);

impl BodyId {
    /// The track frame itself, which never moves.
    pub const GROUND: Self = Self(BODIES_MAX as u8 - 1);

    /// The body with this index; `None` when there is no such place or it is the ground's.
    pub const fn new(index: usize) -> Option<Self> {
        if index < BODIES_MAX - 1 { Some(Self(index as u8)) } else { None }
    }

    /// Index into an array of `BODIES_MAX`; the mask proves to the compiler that it is inside.
    #[inline(always)]
    pub fn index(self) -> usize {
        debug_assert!((self.0 as usize) < BODIES_MAX, "body {} of {BODIES_MAX}", self.0);
        self.0 as usize & (BODIES_MAX - 1)
    }
}

/// Displacement (or velocity) of a point of a body, forward, right, down, for small angles.
#[inline(always)]
pub(super) fn point_motion<const L: usize>(pose: &Pose<L>, point: &Vector3<f64>) -> [Lanes<L>; 3] {
    let [lateral, vertical, roll, pitch, yaw] = *pose;
    [
        pitch * point.z - yaw * point.y,
        lateral + yaw * point.x - roll * point.z,
        vertical + roll * point.y - pitch * point.x,
    ]
}

/// Adds a force at a point to the generalised forces of a body.
#[inline(always)]
pub(super) fn apply_force<const L: usize>(
    forces: &mut Pose<L>,
    point: &Vector3<f64>,
    force: &[Lanes<L>; 3],
) {
    let [x, y, z] = *force;
    forces[LATERAL] += y;
    forces[VERTICAL] += z;
    forces[ROLL] += z * point.y - y * point.z;
    forces[PITCH] += x * point.z - z * point.x;
    forces[YAW] += y * point.x - x * point.y;
}
