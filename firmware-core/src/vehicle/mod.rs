//! A vehicle as data: bodies, force elements between points, wheelsets on rails.
//!
//! ```text
//! m q'' = sum of element forces + gravity + wheel/rail forces - inertia of the track frame
//! ```
//! Every body moves with a frame that runs along the track at its own station at the running speed;
//! its coordinates are lateral, vertical, roll, pitch, yaw against that frame (x forward, y right,
//! z down). No vehicle has code of its own: the SS9, a coach and a seven-degree-of-freedom bogie
//! are lists of the same elements. Small angles, rigid bodies, no longitudinal motion.

mod axle;
mod body;
mod links;
mod running;
mod state;
mod step;
mod wheels;

pub use axle::{Axle, RailSupport};
pub use body::{BODIES_MAX, Body, BodyId, COORDINATES, LATERAL, PITCH, Pose, ROLL, VERTICAL, YAW};
pub use links::{Anchor, BUMP_POINTS_MAX, BumpStop, DamperMount, Suspension, Torsion};
pub use running::Running;
pub use state::VehicleState;
pub use step::DamperForces;

use nalgebra::Vector3;

/// Largest number of suspension elements.
pub const SUSPENSIONS_MAX: usize = 48;
/// Largest number of rotational springs.
pub const TORSIONS_MAX: usize = 8;
/// Largest number of bump stops.
pub const BUMP_STOPS_MAX: usize = 12;
/// Largest number of wheelsets.
pub const AXLES_MAX: usize = 8;
/// Damper slots: each is modelled or on a rig.
pub const DAMPER_SLOTS: usize = 4;

/// Acceleration of gravity (m/s2).
pub const GRAVITY_M_PER_S2: f64 = 9.81;

/// A vehicle. Build it from data, check it with [`Vehicle::check`], then step it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Vehicle {
    /// The bodies.
    pub bodies: heapless::Vec<Body, { BODIES_MAX - 1 }>,
    /// Springs and dampers between points.
    pub suspensions: heapless::Vec<Suspension, SUSPENSIONS_MAX>,
    /// Rotational springs.
    pub torsions: heapless::Vec<Torsion, TORSIONS_MAX>,
    /// Lateral stops.
    pub bump_stops: heapless::Vec<BumpStop, BUMP_STOPS_MAX>,
    /// Damper slots, in the order in which their forces are applied.
    pub dampers: heapless::Vec<DamperMount, DAMPER_SLOTS>,
    /// Wheelsets.
    pub axles: heapless::Vec<Axle, AXLES_MAX>,
}

/// Why a vehicle cannot run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VehicleError {
    /// A mass or inertia of a free coordinate that is not positive: body, coordinate, value.
    Inertia(usize, usize, f64),
    /// An element names a body that does not exist.
    MissingBody(usize),
    /// An axle's body has no rolling radius.
    NotRolling(usize),
    /// A number that is not finite in the named element.
    NotFinite(&'static str),
}

impl core::fmt::Display for VehicleError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Inertia(body, coordinate, value) => write!(
                f,
                "body {body}, coordinate {coordinate}: inertia {value}, expected a positive number"
            ),
            Self::MissingBody(body) => write!(f, "body {body} does not exist"),
            Self::NotRolling(axle) => write!(f, "axle {axle}: its body has no rolling radius"),
            Self::NotFinite(element) => write!(f, "a number in {element} is not finite"),
        }
    }
}

impl core::error::Error for VehicleError {}

impl Vehicle {
    /// A damper between two places of the ground and nothing else: what a bench in open loop has.
    pub fn of_one_damper() -> Self {
        let anchor = Anchor { body: BodyId::GROUND, point_m: Vector3::zeros() };
        let mount = DamperMount { first: anchor, second: anchor, direction: Vector3::x() };
        let mut vehicle = Self::default();
        let is_full = vehicle.dampers.push(mount).is_err();
        debug_assert!(!is_full, "a vehicle has room for a damper");
        vehicle
    }

    /// How far its outermost wheelset is from its reference point (m).
    pub fn reach_m(&self) -> f64 {
        let bodies = self.axles.iter().filter_map(|axle| self.bodies.get(axle.body.index()));
        bodies.map(|body| body.station_m.abs()).fold(0.0, f64::max)
    }

    /// Checks what a step relies on.
    ///
    /// # Errors
    /// The first thing found wrong.
    pub fn check(&self) -> Result<(), VehicleError> {
        for (index, body) in self.bodies.iter().enumerate() {
            for (coordinate, free) in body.free.iter().enumerate() {
                let inertia = body.inertia(coordinate);
                if *free && !(inertia > 0.0 && inertia.is_finite()) {
                    return Err(VehicleError::Inertia(index, coordinate, inertia));
                }
            }
        }
        let known = |body: BodyId| {
            if body == BodyId::GROUND || body.index() < self.bodies.len() {
                Ok(())
            } else {
                Err(VehicleError::MissingBody(body.index()))
            }
        };
        for element in &self.suspensions {
            known(element.first.body)?;
            known(element.second.body)?;
            if !element
                .stiffness_n_per_m
                .iter()
                .chain(&element.damping_n_s_per_m)
                .chain(&element.play_m)
                .all(|v| v.is_finite())
            {
                return Err(VehicleError::NotFinite("suspension"));
            }
        }
        for element in &self.torsions {
            known(element.first)?;
            known(element.second)?;
        }
        for element in &self.bump_stops {
            known(element.first.body)?;
            known(element.second.body)?;
        }
        for element in &self.dampers {
            known(element.first.body)?;
            known(element.second.body)?;
        }
        for (index, axle) in self.axles.iter().enumerate() {
            known(axle.body)?;
            match self.bodies.get(axle.body.index()) {
                Some(Body { rolling_radius_m: Some(radius), .. }) if *radius > 0.0 => {}
                _ => return Err(VehicleError::NotRolling(index)),
            }
        }
        Ok(())
    }

    /// Number of free coordinates of the bodies; the rails under the wheels are not counted.
    pub fn degrees_of_freedom(&self) -> usize {
        self.bodies.iter().flat_map(|body| body.free).filter(|free| *free).count()
    }

    /// Whether a wheel runs on real profiles, so that [`Running`] must carry a contact table.
    pub fn runs_on_profiles(&self) -> bool {
        self.axles.iter().any(Axle::runs_on_profiles)
    }

    /// Total mass (kg).
    pub fn mass_kg(&self) -> f64 {
        self.bodies.iter().map(|body| body.mass_kg).sum()
    }
}
