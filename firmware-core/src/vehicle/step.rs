//! One step of a vehicle.
//!
//! Leapfrog: positions at whole substeps, velocities at half substeps, one force evaluation each.
//! ```text
//! v_n     = v_(n-1/2) + h/2 a_(n-1)          (estimate for creep and damping forces)
//! a_n     = forces(q_n, v_n, t_n) / m
//! v_(n+1/2) = v_(n-1/2) + h a_n,   q_(n+1) = q_n + h v_(n+1/2)
//! ```
//! Second order. Elastic forces keep their energy (symplectic) up to `omega h = 2`; velocity
//! forces act as in the two-step Adams-Bashforth rule, stable up to a rate of `1/h`, which sets the
//! lowest running speed because creep grows like `1/V`. Every evaluation is at the time of the
//! positions, so an event-exact damper and a real one see one sample per substep.

use super::axle::{Place, RailSupport, add_wheels};
use super::body::{BODIES_MAX, BodyId, LATERAL, PITCH, Pose, ROLL, VERTICAL, YAW};
use super::links::{Forces, Motion};
use super::state::VehicleState;
use super::{AXLES_MAX, DAMPER_SLOTS, GRAVITY_M_PER_S2, Vehicle};
use crate::lanes::Lanes;
use crate::track::{LayoutPoint, Track};
use crate::wheel_rail::table::ContactTable;

/// Where everything is and how fast it moves.
struct Kinematics<const L: usize> {
    /// Velocities in each body's own track frame.
    velocity: [Pose<L>; BODIES_MAX],
    /// The track under each body.
    places: [[LayoutPoint; L]; BODIES_MAX],
    /// Positions in the tangent frame of the vehicle's reference point.
    common: [Pose<L>; BODIES_MAX],
    /// Velocities in that frame.
    common_velocity: [Pose<L>; BODIES_MAX],
}

/// How the vehicle runs during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Running<'a, const L: usize = 1> {
    /// Running speed (m/s), positive.
    pub speed_m_per_s: Lanes<L>,
    /// The track.
    pub track: &'a Track<'a>,
    /// The contact table of wheels that run on profiles.
    pub contact: Option<&'a ContactTable>,
    /// Length of one substep (s).
    pub substep_s: f64,
}

/// Where the forces in the damper slots come from.
pub trait DamperForces {
    /// Force of a slot (N, positive in tension) after its extension has moved to `extension_m` (m)
    /// at `rate_m_per_s` within one substep.
    fn force_n(
        &mut self,
        slot: usize,
        lane: usize,
        extension_m: f64,
        rate_m_per_s: f64,
        substep_s: f64,
    ) -> f64;
}

/// Empty damper slots.
impl DamperForces for () {
    fn force_n(&mut self, _: usize, _: usize, _: f64, _: f64, _: f64) -> f64 {
        0.0
    }
}

impl Vehicle {
    /// Advances by `substeps` substeps.
    pub fn step<const L: usize>(
        &self,
        state: &mut VehicleState<L>,
        running: &Running<'_, L>,
        dampers: &mut impl DamperForces,
        substeps: u32,
    ) {
        self.assert_runs(running);
        for _ in 0..substeps {
            self.evaluate(state, running, dampers);
            self.advance(state, running);
        }
        debug_assert!(
            state.position[BodyId::GROUND.index()] == [Lanes::ZERO; 5],
            "the ground has moved"
        );
        debug_assert!(
            state.distance_m.0.iter().all(|distance_m| !distance_m.is_nan()),
            "the distance follows from the speed, whatever the bodies do"
        );
    }

    /// What a step relies on and the caller provides.
    fn assert_runs<const L: usize>(&self, running: &Running<'_, L>) {
        let substep_s = running.substep_s;
        debug_assert!(substep_s > 0.0 && substep_s.is_finite(), "substep of {substep_s} s");
        debug_assert!(
            running.contact.is_some() || !self.runs_on_profiles(),
            "wheels on profiles need a contact table"
        );
    }

    /// Sets velocities from a state at rest or in steady motion, so that the first substep starts
    /// at second order. Call it once after positions and velocities have been set.
    pub fn start<const L: usize>(&self, state: &mut VehicleState<L>, running: &Running<'_, L>) {
        self.assert_runs(running);
        debug_assert!(self.check().is_ok(), "a vehicle that cannot run");
        let velocity = state.half_velocity;
        let rails = state.rail_half_velocity;
        // Without an earlier acceleration the velocities themselves are the estimate.
        state.acceleration = [[Lanes::ZERO; 5]; BODIES_MAX];
        state.rail_acceleration = [[[Lanes::ZERO; 2]; 2]; AXLES_MAX];
        self.evaluate(state, running, &mut ());
        let half = -0.5 * running.substep_s;
        for ((value, start), rate) in
            state.half_velocity.iter_mut().zip(&velocity).zip(&state.acceleration)
        {
            for ((value, start), rate) in value.iter_mut().zip(start).zip(rate) {
                *value = *start + *rate * half;
            }
        }
        for ((value, start), rate) in state
            .rail_half_velocity
            .iter_mut()
            .flatten()
            .flatten()
            .zip(rails.iter().flatten().flatten())
            .zip(state.rail_acceleration.iter().flatten().flatten())
        {
            *value = *start + *rate * half;
        }
    }

    /// Evaluates all forces and leaves the accelerations in the state.
    pub fn evaluate<const L: usize>(
        &self,
        state: &mut VehicleState<L>,
        running: &Running<'_, L>,
        dampers: &mut impl DamperForces,
    ) {
        let substep = running.substep_s;
        let Kinematics { velocity, places, common, common_velocity } =
            self.kinematics(state, running);
        let motion = Motion { position: &common, velocity: &common_velocity };

        let mut forces: Forces<L> = [[Lanes::ZERO; 5]; BODIES_MAX];
        self.weight(&places, running, &velocity, &mut forces);
        for element in &self.suspensions {
            element.act(&motion, &mut forces);
        }
        for element in &self.torsions {
            element.act(&motion, &mut forces);
        }
        for element in &self.bump_stops {
            element.act(&motion, &mut forces);
        }
        for (slot, mount) in self.dampers.iter().enumerate().take(DAMPER_SLOTS) {
            let extension = mount.extension(motion.position);
            let rate = mount.extension(motion.velocity);
            let mut tension = Lanes::ZERO;
            for (lane, force) in tension.0.iter_mut().enumerate() {
                *force =
                    dampers.force_n(slot, lane, extension.lane(lane), rate.lane(lane), substep);
            }
            mount.pull(tension, &mut forces);
            if let Some(kept) = state.damper_n.get_mut(slot) {
                *kept = tension;
            }
            if let Some(kept) = state.extension_m.get_mut(slot) {
                *kept = extension;
            }
            if let Some(kept) = state.extension_m_per_s.get_mut(slot) {
                *kept = rate;
            }
        }
        self.wheels(state, running, &velocity, &places, &mut forces);
        self.accelerate(state, &forces);
    }

    /// Extension (m) and its rate (m/s) of every damper slot at the time of the positions.
    pub fn damper_motions<const L: usize>(
        &self,
        state: &VehicleState<L>,
        running: &Running<'_, L>,
    ) -> [(Lanes<L>, Lanes<L>); DAMPER_SLOTS] {
        let moving = self.kinematics(state, running);
        let mut motions = [(Lanes::ZERO, Lanes::ZERO); DAMPER_SLOTS];
        for (motion, mount) in motions.iter_mut().zip(&self.dampers) {
            *motion = (mount.extension(&moving.common), mount.extension(&moving.common_velocity));
        }
        motions
    }

    /// Velocities at the time of the positions, and both in the common frame of the vehicle.
    #[inline(always)]
    fn kinematics<const L: usize>(
        &self,
        state: &VehicleState<L>,
        running: &Running<'_, L>,
    ) -> Kinematics<L> {
        let half = 0.5 * running.substep_s;
        let mut velocity = [[Lanes::ZERO; 5]; BODIES_MAX];
        for ((value, late), rate) in velocity
            .iter_mut()
            .zip(&state.half_velocity)
            .zip(&state.acceleration)
            .take(self.bodies.len())
        {
            for ((value, late), rate) in value.iter_mut().zip(late).zip(rate) {
                *value = *late + *rate * half;
            }
        }
        let mut moving = Kinematics {
            velocity,
            places: [[LayoutPoint::default(); L]; BODIES_MAX],
            common: state.position,
            common_velocity: velocity,
        };
        if !running.track.layout.is_tangent() {
            self.shift_to_common_frame(
                state,
                running,
                &mut moving.places,
                &mut moving.common,
                &mut moving.common_velocity,
            );
        }
        moving
    }

    /// Shifts every body from its own track frame into the tangent frame of the reference point.
    fn shift_to_common_frame<const L: usize>(
        &self,
        state: &VehicleState<L>,
        running: &Running<'_, L>,
        places: &mut [[LayoutPoint; L]; BODIES_MAX],
        position: &mut [Pose<L>; BODIES_MAX],
        velocity: &mut [Pose<L>; BODIES_MAX],
    ) {
        for lane in 0..L {
            let speed = running.speed_m_per_s.lane(lane);
            let distance = state.distance_m.lane(lane);
            let origin = running.track.layout.at(distance);
            for (index, body) in self.bodies.iter().enumerate().take(BODIES_MAX) {
                let at = running.track.layout.at(distance + body.station_m);
                let ahead = body.station_m;
                let offset = at.offset_m - origin.offset_m - origin.heading_rad * ahead;
                let heading = at.heading_rad - origin.heading_rad;
                let turn = at.curvature_per_m - origin.curvature_per_m;
                // Rotation about the track centre moves the centre of gravity sideways as well.
                let cant = at.cant_rad - origin.cant_rad;
                let cant_rate = speed * (at.cant_rate_rad_per_m - origin.cant_rate_rad_per_m);
                let pose = &mut position[index];
                pose[LATERAL].add_lane(lane, offset + cant * body.height_m);
                pose[ROLL].add_lane(lane, cant);
                pose[YAW].add_lane(lane, heading);
                let rate = &mut velocity[index];
                rate[LATERAL].add_lane(
                    lane,
                    speed * (heading - origin.curvature_per_m * ahead) + cant_rate * body.height_m,
                );
                rate[ROLL].add_lane(lane, cant_rate);
                rate[YAW].add_lane(lane, speed * turn);
                if let Some(place) = places[index].get_mut(lane) {
                    *place = at;
                }
            }
        }
    }

    /// Gravity, the inertia forces of the track frame and the gyroscopic moments of rolling bodies.
    fn weight<const L: usize>(
        &self,
        places: &[[LayoutPoint; L]; BODIES_MAX],
        running: &Running<'_, L>,
        velocity: &[Pose<L>; BODIES_MAX],
        forces: &mut Forces<L>,
    ) {
        for (index, body) in self.bodies.iter().enumerate().take(BODIES_MAX) {
            for lane in 0..L {
                let speed = running.speed_m_per_s.lane(lane);
                let at = places[index].get(lane).copied().unwrap_or_default();
                let centripetal = speed * speed * at.curvature_per_m;
                let roll_acceleration = speed * speed * at.cant_bend_rad_per_m2;
                let yaw_acceleration = speed * speed * at.curvature_rate_per_m2;
                let [roll, _, yaw] = body.inertia_kg_m2;
                let force = &mut forces[index];
                force[LATERAL].add_lane(
                    lane,
                    body.mass_kg
                        * (GRAVITY_M_PER_S2 * at.cant_rad
                            - centripetal
                            - roll_acceleration * body.height_m),
                );
                force[VERTICAL]
                    .add_lane(lane, body.mass_kg * (GRAVITY_M_PER_S2 + centripetal * at.cant_rad));
                force[ROLL].add_lane(lane, -roll * roll_acceleration);
                force[YAW].add_lane(lane, -yaw * yaw_acceleration);
                if let Some(radius) = body.rolling_radius_m {
                    let momentum =
                        body.inertia(PITCH) * (velocity[index][PITCH].lane(lane) - speed / radius);
                    let turn = velocity[index][YAW].lane(lane) + speed * at.curvature_per_m;
                    let tilt = velocity[index][ROLL].lane(lane) + speed * at.cant_rate_rad_per_m;
                    force[ROLL].add_lane(lane, momentum * turn);
                    force[YAW].add_lane(lane, -momentum * tilt);
                }
            }
        }
    }

    fn wheels<const L: usize>(
        &self,
        state: &mut VehicleState<L>,
        running: &Running<'_, L>,
        velocity: &[Pose<L>; BODIES_MAX],
        places: &[[LayoutPoint; L]; BODIES_MAX],
        forces: &mut Forces<L>,
    ) {
        let half = 0.5 * running.substep_s;
        for (number, axle) in self.axles.iter().enumerate().take(AXLES_MAX) {
            let index = axle.body.index();
            debug_assert!(index < self.bodies.len(), "axle {number} on body {index}");
            let Some(body) = self.bodies.get(index) else { continue };
            for lane in 0..L {
                let distance = state.distance_m.lane(lane) + body.station_m;
                let place = Place {
                    speed_m_per_s: running.speed_m_per_s.lane(lane),
                    layout: places[index].get(lane).copied().unwrap_or_default(),
                    irregularity: running.track.irregularity.at(distance),
                };
                let scalar = |pose: &Pose<L>| pose.map(|value| value.lane(lane));
                let (here, moving) = (scalar(&state.position[index]), scalar(&velocity[index]));
                for (which, side) in [-1.0, 1.0].into_iter().enumerate() {
                    let at = state.rail_position[number][which].map(|v| v.lane(lane));
                    let [right, down] = state.rail_half_velocity[number][which];
                    let [right_rate, down_rate] = state.rail_acceleration[number][which];
                    let speed = [
                        right.lane(lane) + half * right_rate.lane(lane),
                        down.lane(lane) + half * down_rate.lane(lane),
                    ];
                    let (force, shift) = axle.wheel_force(
                        running.contact,
                        side,
                        &here,
                        &moving,
                        [at, speed],
                        &place,
                    );
                    if let Some(rail) = axle.rail {
                        let [lateral, vertical] = rail_acceleration(
                            &rail,
                            at,
                            speed,
                            side * force.lateral_n,
                            force.vertical_n,
                        );
                        let [kept_lateral, kept_vertical] =
                            &mut state.rail_acceleration[number][which];
                        set_lane(kept_lateral, lane, lateral);
                        set_lane(kept_vertical, lane, vertical);
                    }
                    set_lane(&mut state.shifts_m[number][which], lane, shift);
                    if let Some(kept) = state.wheels[number][which].get_mut(lane) {
                        *kept = force;
                    }
                }
                let [left, right] = &state.wheels[number];
                if let (Some(left), Some(right)) = (left.get(lane), right.get(lane)) {
                    add_wheels(&mut forces[index], lane, left, right);
                }
            }
        }
    }

    fn accelerate<const L: usize>(&self, state: &mut VehicleState<L>, forces: &Forces<L>) {
        for ((body, force), acceleration) in
            self.bodies.iter().zip(forces).zip(&mut state.acceleration)
        {
            for (coordinate, (force, acceleration)) in
                force.iter().zip(acceleration.iter_mut()).enumerate()
            {
                let free = body.free.get(coordinate).copied().unwrap_or(false);
                *acceleration =
                    if free { *force * (1.0 / body.inertia(coordinate)) } else { Lanes::ZERO };
            }
        }
    }

    fn advance<const L: usize>(&self, state: &mut VehicleState<L>, running: &Running<'_, L>) {
        let substep = running.substep_s;
        for ((position, velocity), rate) in state
            .position
            .iter_mut()
            .zip(&mut state.half_velocity)
            .zip(&state.acceleration)
            .take(self.bodies.len())
        {
            for ((position, velocity), rate) in
                position.iter_mut().zip(velocity.iter_mut()).zip(rate)
            {
                *velocity += *rate * substep;
                *position += *velocity * substep;
            }
        }
        let rails = state
            .rail_position
            .iter_mut()
            .zip(&mut state.rail_half_velocity)
            .zip(&state.rail_acceleration)
            .take(self.axles.len());
        for ((position, velocity), rate) in rails {
            for ((position, velocity), rate) in position
                .iter_mut()
                .flatten()
                .zip(velocity.iter_mut().flatten())
                .zip(rate.iter().flatten())
            {
                *velocity += *rate * substep;
                *position += *velocity * substep;
            }
        }
        state.distance_m += running.speed_m_per_s * substep;
    }
}

/// Acceleration of a rail mass: right, down. The wheel's force on the wheelset acts on it reversed.
#[inline(always)]
fn rail_acceleration(
    rail: &RailSupport,
    position: [f64; 2],
    velocity: [f64; 2],
    right_n: f64,
    down_n: f64,
) -> [f64; 2] {
    let [lateral_kg, vertical_kg] = rail.mass_kg;
    let [lateral_k, vertical_k] = rail.stiffness_n_per_m;
    let [lateral_c, vertical_c] = rail.damping_n_s_per_m;
    [
        (-right_n - lateral_k * position[0] - lateral_c * velocity[0]) / lateral_kg,
        (-down_n - vertical_k * position[1] - vertical_c * velocity[1]) / vertical_kg,
    ]
}

#[inline(always)]
fn set_lane<const L: usize>(lanes: &mut Lanes<L>, lane: usize, value: f64) {
    if let Some(slot) = lanes.0.get_mut(lane) {
        *slot = value;
    }
}
