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

use super::body::{BODIES_MAX, BodyId, COORDINATES, LATERAL, PITCH, Pose, ROLL, VERTICAL, YAW};
use super::links::{Forces, Motion};
use super::running::{Places, Running};
use super::state::VehicleState;
use super::wheels::{Kept, WheelWork};
use super::{AXLES_MAX, DAMPER_SLOTS, GRAVITY_M_PER_S2, Vehicle};
use crate::lanes::Lanes;
use crate::number::Group;
use crate::track::LayoutPoint;

/// What a substep works out and the next one writes over: made once a step.
struct Work<const L: usize> {
    /// Velocities at the time of the positions, in each body's own track frame.
    velocity: [Pose<L>; BODIES_MAX],
    /// Inverse of mass or inertia; zero where a coordinate is held.
    per_inertia: [[f64; COORDINATES]; BODIES_MAX],
    forces: Forces<L>,
    wheels: WheelWork<L>,
    has_equal_axles: bool,
    /// None until a track that is not straight needs it.
    curved: Option<Curved<L>>,
}

/// Bodies on a track that is not straight; unused on one that is.
struct Curved<const L: usize> {
    places: Places<L>,
    /// Positions in the tangent frame of the vehicle's reference point.
    position: [Pose<L>; BODIES_MAX],
    /// Velocities in that frame.
    velocity: [Pose<L>; BODIES_MAX],
}

impl<const L: usize> Curved<L> {
    fn straight() -> Self {
        let places = [[LayoutPoint::default(); L]; BODIES_MAX];
        Self { places, position: rest(), velocity: rest() }
    }
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
        self.step_keeping(state, running, dampers, substeps, Kept::Forces);
    }

    /// The same where nobody looks at the wheel forces afterwards: the state keeps those of an
    /// earlier step; all else has the bits of [`Vehicle::step`].
    pub fn step_unseen<const L: usize>(
        &self,
        state: &mut VehicleState<L>,
        running: &Running<'_, L>,
        dampers: &mut impl DamperForces,
        substeps: u32,
    ) {
        self.step_keeping(state, running, dampers, substeps, Kept::Shifts);
    }

    fn step_keeping<const L: usize>(
        &self,
        state: &mut VehicleState<L>,
        running: &Running<'_, L>,
        dampers: &mut impl DamperForces,
        substeps: u32,
        kept: Kept,
    ) {
        self.assert_runs(running);
        let mut work = self.work();
        for left in (0..substeps).rev() {
            let kept = if left == 0 { kept } else { Kept::Nothing };
            self.forces(&mut work, state, running, dampers, kept);
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
        self.forces(&mut self.work(), state, running, dampers, Kept::Forces);
    }

    fn work<const L: usize>(&self) -> Work<L> {
        let mut per_inertia = [[0.0; COORDINATES]; BODIES_MAX];
        for (body, per_inertia) in self.bodies.iter().zip(&mut per_inertia) {
            for (coordinate, (value, free)) in per_inertia.iter_mut().zip(body.free).enumerate() {
                if free {
                    *value = 1.0 / body.inertia(coordinate);
                }
            }
        }
        Work {
            velocity: rest(),
            per_inertia,
            forces: rest(),
            wheels: WheelWork::none(),
            has_equal_axles: self.has_equal_axles(),
            curved: None,
        }
    }

    /// The same in memory that is there already.
    #[inline(always)]
    fn forces<const L: usize>(
        &self,
        work: &mut Work<L>,
        state: &mut VehicleState<L>,
        running: &Running<'_, L>,
        dampers: &mut impl DamperForces,
        kept: Kept,
    ) {
        let substep = running.substep_s;
        let Work { velocity, per_inertia, forces, wheels, has_equal_axles, curved } = work;
        self.velocities(state, running, velocity);
        let curved = if running.is_tangent() {
            None
        } else {
            let curved = curved.get_or_insert_with(Curved::straight);
            self.shift_to_common_frame(state, running, velocity, curved);
            Some(&*curved)
        };
        let motion = match curved {
            None => Motion { position: &state.position, velocity },
            Some(curved) => Motion { position: &curved.position, velocity: &curved.velocity },
        };
        let places = curved.map(|curved| &curved.places);
        self.weight(places, running, velocity, forces);
        for element in &self.suspensions {
            element.act(&motion, forces);
        }
        for element in &self.torsions {
            element.act(&motion, forces);
        }
        for element in &self.bump_stops {
            element.act(&motion, forces);
        }
        for (slot, mount) in self.dampers.iter().enumerate().take(DAMPER_SLOTS) {
            let extension = mount.extension(motion.position);
            let rate = mount.extension(motion.velocity);
            let mut tension = Lanes::ZERO;
            for (lane, force) in tension.0.iter_mut().enumerate() {
                *force =
                    dampers.force_n(slot, lane, extension.lane(lane), rate.lane(lane), substep);
            }
            mount.pull(tension, forces);
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
        if *has_equal_axles {
            self.wheels::<Group, L>(state, running, velocity, places, wheels, kept);
        } else {
            self.wheels::<f64, L>(state, running, velocity, places, wheels, kept);
        }
        self.add_wheels(wheels, forces);
        self.accelerate(state, per_inertia, forces);
    }

    /// Extension (m) and its rate (m/s) of every damper slot at the time of the positions.
    pub fn damper_motions<const L: usize>(
        &self,
        state: &VehicleState<L>,
        running: &Running<'_, L>,
    ) -> [(Lanes<L>, Lanes<L>); DAMPER_SLOTS] {
        let mut velocity = rest();
        self.velocities(state, running, &mut velocity);
        let mut curved = None;
        let (position, velocity) = if running.is_tangent() {
            (&state.position, &velocity)
        } else {
            let curved = curved.insert(Curved::straight());
            self.shift_to_common_frame(state, running, &velocity, curved);
            (&curved.position, &curved.velocity)
        };
        let mut motions = [(Lanes::ZERO, Lanes::ZERO); DAMPER_SLOTS];
        for (motion, mount) in motions.iter_mut().zip(&self.dampers) {
            *motion = (mount.extension(position), mount.extension(velocity));
        }
        motions
    }

    /// Velocities at the time of the positions.
    #[inline(always)]
    fn velocities<const L: usize>(
        &self,
        state: &VehicleState<L>,
        running: &Running<'_, L>,
        velocity: &mut [Pose<L>; BODIES_MAX],
    ) {
        let half = 0.5 * running.substep_s;
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
    }

    /// Shifts every body from its own track frame into the tangent frame of the reference point.
    fn shift_to_common_frame<const L: usize>(
        &self,
        state: &VehicleState<L>,
        running: &Running<'_, L>,
        velocity: &[Pose<L>; BODIES_MAX],
        curved: &mut Curved<L>,
    ) {
        curved.position = state.position;
        curved.velocity = *velocity;
        for (lane, track) in running.tracks.iter().enumerate() {
            let speed = running.speed_m_per_s.lane(lane);
            let distance = state.distance_m.lane(lane);
            let origin = track.layout.at(distance);
            for (index, body) in self.bodies.iter().enumerate().take(BODIES_MAX) {
                let at = track.layout.at(distance + body.station_m);
                let ahead = body.station_m;
                let offset = at.offset_m - origin.offset_m - origin.heading_rad * ahead;
                let heading = at.heading_rad - origin.heading_rad;
                let turn = at.curvature_per_m - origin.curvature_per_m;
                // Rotation about the track centre moves the centre of gravity sideways as well.
                let cant = at.cant_rad - origin.cant_rad;
                let cant_rate = speed * (at.cant_rate_rad_per_m - origin.cant_rate_rad_per_m);
                let pose = &mut curved.position[index];
                pose[LATERAL].add_lane(lane, offset + cant * body.height_m);
                pose[ROLL].add_lane(lane, cant);
                pose[YAW].add_lane(lane, heading);
                let rate = &mut curved.velocity[index];
                rate[LATERAL].add_lane(
                    lane,
                    speed * (heading - origin.curvature_per_m * ahead) + cant_rate * body.height_m,
                );
                rate[ROLL].add_lane(lane, cant_rate);
                rate[YAW].add_lane(lane, speed * turn);
                if let Some(place) = curved.places[index].get_mut(lane) {
                    *place = at;
                }
            }
        }
    }

    /// Gravity, the inertia forces of the track frame and the gyroscopic moments of rolling bodies.
    #[inline(always)]
    fn weight<const L: usize>(
        &self,
        places: Option<&Places<L>>,
        running: &Running<'_, L>,
        velocity: &[Pose<L>; BODIES_MAX],
        forces: &mut Forces<L>,
    ) {
        for (index, body) in self.bodies.iter().enumerate().take(BODIES_MAX) {
            let force = &mut forces[index];
            *force = [Lanes::ZERO; COORDINATES];
            force[VERTICAL] = Lanes::splat(body.mass_kg * GRAVITY_M_PER_S2);
            for lane in 0..L {
                let speed = running.speed_m_per_s.lane(lane);
                let at = places.and_then(|places| places[index].get(lane));
                if let Some(at) = at {
                    let centripetal = speed * speed * at.curvature_per_m;
                    let roll_acceleration = speed * speed * at.cant_bend_rad_per_m2;
                    let yaw_acceleration = speed * speed * at.curvature_rate_per_m2;
                    let [roll, _, yaw] = body.inertia_kg_m2;
                    let outward = GRAVITY_M_PER_S2 * at.cant_rad
                        - centripetal
                        - roll_acceleration * body.height_m;
                    let down = GRAVITY_M_PER_S2 + centripetal * at.cant_rad;
                    force[LATERAL].set_lane(lane, body.mass_kg * outward);
                    force[VERTICAL].set_lane(lane, body.mass_kg * down);
                    force[ROLL].set_lane(lane, -roll * roll_acceleration);
                    force[YAW].set_lane(lane, -yaw * yaw_acceleration);
                }
                if let Some(radius) = body.rolling_radius_m {
                    let moves = |coordinate: usize| velocity[index][coordinate].lane(lane);
                    let momentum = body.inertia(PITCH) * (moves(PITCH) - speed / radius);
                    let [turn, tilt] = at.map_or([0.0; 2], |at| {
                        [speed * at.curvature_per_m, speed * at.cant_rate_rad_per_m]
                    });
                    force[ROLL].add_lane(lane, momentum * (moves(YAW) + turn));
                    force[YAW].add_lane(lane, -momentum * (moves(ROLL) + tilt));
                }
            }
        }
    }

    #[inline(always)]
    fn accelerate<const L: usize>(
        &self,
        state: &mut VehicleState<L>,
        per_inertia: &[[f64; COORDINATES]; BODIES_MAX],
        forces: &Forces<L>,
    ) {
        for ((force, per_inertia), acceleration) in
            forces.iter().zip(per_inertia).zip(&mut state.acceleration).take(self.bodies.len())
        {
            for ((force, per_inertia), acceleration) in
                force.iter().zip(per_inertia).zip(acceleration)
            {
                *acceleration =
                    if *per_inertia > 0.0 { *force * *per_inertia } else { Lanes::ZERO };
            }
        }
    }

    #[inline(always)]
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
            let (position, velocity) = (position.as_flattened_mut(), velocity.as_flattened_mut());
            for ((position, velocity), rate) in
                position.iter_mut().zip(velocity).zip(rate.as_flattened())
            {
                *velocity += *rate * substep;
                *position += *velocity * substep;
            }
        }
        state.distance_m += running.speed_m_per_s * substep;
    }
}

/// No motion, no force.
fn rest<const L: usize>() -> [Pose<L>; BODIES_MAX] {
    [[Lanes::ZERO; COORDINATES]; BODIES_MAX]
}
