//! What a vehicle remembers between steps.

use super::body::{BODIES_MAX, Body, COORDINATES, Pose};
use super::{AXLES_MAX, DAMPER_SLOTS};
use crate::lanes::Lanes;
use crate::wheel_rail::wheel::WheelForce;

/// State of `L` vehicles side by side. Copying it is a snapshot; putting it back restores the run
/// to the last bit.
///
/// Velocities are kept half a substep behind the positions (see the step); the accelerations are
/// those of the last evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct VehicleState<const L: usize = 1> {
    /// Distance run by the vehicle's reference point (m).
    pub distance_m: Lanes<L>,
    /// Positions of the bodies.
    pub position: [Pose<L>; BODIES_MAX],
    /// Velocities of the bodies, half a substep behind.
    pub half_velocity: [Pose<L>; BODIES_MAX],
    /// Accelerations of the bodies at the last evaluation.
    pub acceleration: [Pose<L>; BODIES_MAX],
    /// Positions of the rails: axle, side (left, right), then right and down (m).
    pub rail_position: [[[Lanes<L>; 2]; 2]; AXLES_MAX],
    /// Velocities of the rails, half a substep behind.
    pub rail_half_velocity: [[[Lanes<L>; 2]; 2]; AXLES_MAX],
    /// Accelerations of the rails at the last evaluation.
    pub rail_acceleration: [[[Lanes<L>; 2]; 2]; AXLES_MAX],
    /// Wheel forces at the last evaluation: axle, side (left, right), lane.
    pub wheels: [[[WheelForce; L]; 2]; AXLES_MAX],
    /// Lateral shift of each wheel against its rail at the last evaluation (m).
    pub shifts_m: [[Lanes<L>; 2]; AXLES_MAX],
    /// Extension of each damper slot at the last evaluation (m).
    pub extension_m: [Lanes<L>; DAMPER_SLOTS],
    /// Extension rate of each damper slot at the last evaluation (m/s).
    pub extension_m_per_s: [Lanes<L>; DAMPER_SLOTS],
    /// Force of each damper slot at the last evaluation (N).
    pub damper_n: [Lanes<L>; DAMPER_SLOTS],
}

impl<const L: usize> Default for VehicleState<L> {
    fn default() -> Self {
        let pose = [Lanes::ZERO; 5];
        let rails = [[[Lanes::ZERO; 2]; 2]; AXLES_MAX];
        Self {
            distance_m: Lanes::ZERO,
            position: [pose; BODIES_MAX],
            half_velocity: [pose; BODIES_MAX],
            acceleration: [pose; BODIES_MAX],
            rail_position: rails,
            rail_half_velocity: rails,
            rail_acceleration: rails,
            wheels: [[[WheelForce::default(); L]; 2]; AXLES_MAX],
            shifts_m: [[Lanes::ZERO; 2]; AXLES_MAX],
            extension_m: [Lanes::ZERO; DAMPER_SLOTS],
            extension_m_per_s: [Lanes::ZERO; DAMPER_SLOTS],
            damper_n: [Lanes::ZERO; DAMPER_SLOTS],
        }
    }
}

impl<const L: usize> VehicleState<L> {
    /// Whether every position is a number: false after a blow-up.
    pub fn is_finite(&self) -> bool {
        self.position.iter().flatten().all(|value| value.0.iter().all(|v| v.is_finite()))
    }

    /// The same of the vehicle in one lane.
    pub fn is_finite_in(&self, lane: usize) -> bool {
        self.position.iter().flatten().all(|value| value.lane(lane).is_finite())
    }

    /// Puts a vehicle that ran alone into a lane.
    pub fn put(&mut self, lane: usize, alone: &VehicleState) {
        for (lanes, one) in self.numbers_mut().zip(alone.numbers()) {
            lanes.set_lane(lane, one.lane(0));
        }
        let wheels = self.wheels.as_flattened_mut().iter_mut();
        for (lanes, [one]) in wheels.zip(alone.wheels.as_flattened()) {
            if let Some(place) = lanes.get_mut(lane) {
                *place = *one;
            }
        }
    }

    /// Takes the vehicle of a lane out, as one that runs alone.
    pub fn take(&self, lane: usize, alone: &mut VehicleState) {
        for (one, lanes) in alone.numbers_mut().zip(self.numbers()) {
            one.set_lane(0, lanes.lane(lane));
        }
        let wheels = alone.wheels.as_flattened_mut().iter_mut();
        for ([one], lanes) in wheels.zip(self.wheels.as_flattened()) {
            if let Some(place) = lanes.get(lane) {
                *one = *place;
            }
        }
    }

    /// Every number but those of the wheels.
    fn numbers(&self) -> impl Iterator<Item = &Lanes<L>> {
        let bodies = [&self.position, &self.half_velocity, &self.acceleration];
        let rails = [&self.rail_position, &self.rail_half_velocity, &self.rail_acceleration];
        let slots = [&self.extension_m, &self.extension_m_per_s, &self.damper_n];
        core::iter::once(&self.distance_m)
            .chain(bodies.into_iter().flatten().flatten())
            .chain(rails.into_iter().flatten().flatten().flatten())
            .chain(self.shifts_m.iter().flatten())
            .chain(slots.into_iter().flatten())
    }

    /// The same in the same order.
    fn numbers_mut(&mut self) -> impl Iterator<Item = &mut Lanes<L>> {
        let bodies = [&mut self.position, &mut self.half_velocity, &mut self.acceleration];
        let rails =
            [&mut self.rail_position, &mut self.rail_half_velocity, &mut self.rail_acceleration];
        let slots = [&mut self.extension_m, &mut self.extension_m_per_s, &mut self.damper_n];
        core::iter::once(&mut self.distance_m)
            .chain(bodies.into_iter().flatten().flatten())
            .chain(rails.into_iter().flatten().flatten().flatten())
            .chain(self.shifts_m.iter_mut().flatten())
            .chain(slots.into_iter().flatten())
    }

    /// Velocity of a coordinate at the time of the positions, to second order (m/s, rad/s).
    pub fn velocity(&self, body: usize, coordinate: usize, substep_s: f64) -> Lanes<L> {
        debug_assert!(body < BODIES_MAX, "body {body} of {BODIES_MAX}");
        debug_assert!(coordinate < COORDINATES, "coordinate {coordinate} of {COORDINATES}");
        let half = self.half_velocity.get(body).and_then(|pose| pose.get(coordinate));
        let rate = self.acceleration.get(body).and_then(|pose| pose.get(coordinate));
        match (half, rate) {
            (Some(half), Some(rate)) => *half + *rate * (0.5 * substep_s),
            _ => Lanes::ZERO,
        }
    }

    /// Kinetic energy of all bodies in one lane, with the velocities half a step behind (J).
    pub fn kinetic_energy_j(&self, bodies: &[Body], lane: usize) -> f64 {
        debug_assert!(bodies.len() < BODIES_MAX, "{} bodies", bodies.len());
        let mut energy = 0.0;
        for (body, velocity) in bodies.iter().zip(&self.half_velocity) {
            for (coordinate, value) in velocity.iter().enumerate() {
                let value = value.lane(lane);
                energy += 0.5 * body.inertia(coordinate) * value * value;
            }
        }
        energy
    }
}

#[cfg(all(test, debug_assertions))]
mod tests {
    use super::*;

    #[test]
    #[should_panic(expected = "body 16 of 16")]
    fn a_body_that_does_not_exist_stops_a_debug_build() {
        let _ = VehicleState::<1>::default().velocity(BODIES_MAX, 0, 1e-3);
    }

    #[test]
    #[should_panic(expected = "coordinate 5 of 5")]
    fn a_coordinate_that_does_not_exist_stops_a_debug_build() {
        let _ = VehicleState::<1>::default().velocity(0, COORDINATES, 1e-3);
    }
}
