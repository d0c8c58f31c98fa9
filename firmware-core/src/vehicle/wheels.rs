//! All wheels of a vehicle, or of several side by side, in groups.
//!
//! The wheels of a vehicle with equal axles are taken four at a time; in a batch of four vehicles
//! such a group is one wheel of each. A vehicle whose axles differ has them taken one by one. The
//! bits are the same, because each wheel's force depends on its own place alone.

use super::axle::{Axle, Place, RailSupport};
use super::body::{BODIES_MAX, BodyId, COORDINATES, LATERAL, PITCH, Pose, ROLL, VERTICAL, YAW};
use super::links::Forces;
use super::running::{Places, Running};
use super::state::VehicleState;
use super::{AXLES_MAX, Vehicle};
use crate::lanes::Lanes;
use crate::number::Number;

/// Which wheel: the last index is the vehicle in a batch.
#[derive(Debug, Clone, Copy)]
struct Seat {
    axle: usize,
    side: usize,
    lane: usize,
    body: usize,
    /// A group may have more places than there are wheels left.
    is_taken: bool,
}

/// A value for each wheel.
type PerWheel<T, const L: usize> = [[[T; L]; 2]; AXLES_MAX];

/// What the wheels leave on their wheelsets, and where the track moves them.
pub(super) struct WheelWork<const L: usize> {
    /// Force and moment on the wheelset, in wheel-local axes, by coordinate.
    wrenches: PerWheel<[f64; 5], L>,
    /// Irregularity of the rail: right, down (m).
    irregular_m: PerWheel<[f64; 2], L>,
}

impl<const L: usize> WheelWork<L> {
    pub(super) fn none() -> Self {
        Self {
            wrenches: [[[[0.0; 5]; L]; 2]; AXLES_MAX],
            irregular_m: [[[[0.0; 2]; L]; 2]; AXLES_MAX],
        }
    }
}

/// What wheels leave in the state for whoever looks at it after a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kept {
    /// Nothing: another substep follows.
    Nothing,
    /// Where each wheel is on its rail.
    Shifts,
    /// That, and what its force consists of.
    Forces,
}

/// Number of a side: the left one is first.
fn sign(side: usize) -> f64 {
    if side == 0 { -1.0 } else { 1.0 }
}

impl Vehicle {
    /// Whether all axles have the same wheels and rails, so that four wheels can be taken at once.
    pub(super) fn has_equal_axles(&self) -> bool {
        let mut axles = self.axles.iter();
        let first = axles.next();
        axles.all(|axle| {
            first.is_some_and(|first| axle.wheel == first.wheel && axle.rail == first.rail)
        })
    }

    #[inline(always)]
    fn seat<const L: usize>(&self, number: usize) -> Seat {
        let axle = number / (2 * L);
        Seat {
            axle: axle & (AXLES_MAX - 1),
            side: (number / L) & 1,
            lane: number % L,
            body: self.axles.get(axle).map_or(BodyId::GROUND, |axle| axle.body).index(),
            is_taken: axle < self.axles.len(),
        }
    }

    /// The forces of all wheels on their wheelsets and rails.
    #[inline(always)]
    pub(super) fn wheels<N: Number, const L: usize>(
        &self,
        state: &mut VehicleState<L>,
        running: &Running<'_, L>,
        velocity: &[Pose<L>; BODIES_MAX],
        places: Option<&Places<L>>,
        work: &mut WheelWork<L>,
        kept: Kept,
    ) {
        self.read_irregularity(state, running, work);
        let count = 2 * L * self.axles.len().min(AXLES_MAX);
        for group in 0..count.div_ceil(N::PLACES) {
            let first = group * N::PLACES;
            let seats = N::each(|place| self.seat::<L>(first + place));
            // One wheel has its own axle; four have equal ones.
            let Some(axle) = self.axles.get(first / (2 * L)) else { continue };
            Self::group::<N, L>(axle, &seats, state, running, velocity, places, work, kept);
        }
    }

    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "the body of one loop")]
    fn group<N: Number, const L: usize>(
        axle: &Axle,
        seats: &N::Each<Seat>,
        state: &mut VehicleState<L>,
        running: &Running<'_, L>,
        velocity: &[Pose<L>; BODIES_MAX],
        places: Option<&Places<L>>,
        work: &mut WheelWork<L>,
        kept: Kept,
    ) {
        let half = N::splat(0.5 * running.substep_s);
        let (here, moving) = (of_bodies(seats, &state.position), of_bodies(seats, velocity));
        let rail_place = of_rails::<N, L>(seats, &state.rail_position);
        let [right, down] = of_rails::<N, L>(seats, &state.rail_half_velocity);
        let [right_rate, down_rate] = of_rails::<N, L>(seats, &state.rail_acceleration);
        let rail_speed = [right + half * right_rate, down + half * down_rate];
        let irregular = |direction: usize| {
            N::gather(seats, |seat| {
                work.irregular_m[seat.axle][seat.side]
                    .get(seat.lane)
                    .map_or(0.0, |rail| rail[direction])
            })
        };
        let place = Place {
            side: N::gather(seats, |seat| sign(seat.side)),
            speed_m_per_s: N::gather(seats, |seat| running.speed_m_per_s.lane(seat.lane)),
            curvature_per_m: match places {
                None => N::splat(0.0),
                Some(places) => N::gather(seats, |seat| {
                    let at = places[seat.body & (BODIES_MAX - 1)].get(seat.lane);
                    at.map_or(0.0, |at| at.curvature_per_m)
                }),
            },
            irregular_m: [irregular(0), irregular(1)],
        };
        let motion = axle.wheel_motion(&here, &moving, [rail_place, rail_speed], &place);
        let force = axle.wheel.force(running.contact, &motion);
        if let Some(rail) = axle.rail {
            let right_n = place.side * force.lateral_n;
            let rates = rail.acceleration(rail_place, rail_speed, [right_n, force.vertical_n]);
            for (direction, rate) in rates.into_iter().enumerate() {
                rate.scatter(seats, |seat, rate| {
                    if seat.is_taken {
                        let kept = &mut state.rail_acceleration[seat.axle][seat.side];
                        kept[direction & 1].set_lane(seat.lane, rate);
                    }
                });
            }
        }
        let wrench =
            [force.lateral_n, force.vertical_n, force.roll_n_m, force.pitch_n_m, force.yaw_n_m];
        for (coordinate, value) in wrench.into_iter().enumerate() {
            value.scatter(seats, |seat, value| {
                if let Some(kept) = work.wrenches[seat.axle][seat.side].get_mut(seat.lane)
                    && let Some(kept) = kept.get_mut(coordinate)
                {
                    *kept = value;
                }
            });
        }
        if kept != Kept::Nothing {
            motion.shift_m.scatter(seats, |seat, shift_m| {
                if seat.is_taken {
                    state.shifts_m[seat.axle][seat.side].set_lane(seat.lane, shift_m);
                }
            });
        }
        if kept == Kept::Forces {
            N::for_each(seats, |place, seat| {
                if !seat.is_taken {
                    return;
                }
                if let Some(kept) = state.wheels[seat.axle][seat.side].get_mut(seat.lane) {
                    force.write_place(place, kept);
                }
            });
        }
    }

    /// Where the irregularity has both rails of each axle: once for both wheels.
    #[inline(always)]
    fn read_irregularity<const L: usize>(
        &self,
        state: &VehicleState<L>,
        running: &Running<'_, L>,
        work: &mut WheelWork<L>,
    ) {
        for (axle, irregular_m) in self.axles.iter().zip(&mut work.irregular_m) {
            let Some(body) = self.bodies.get(axle.body.index()) else { continue };
            for (lane, track) in running.tracks.iter().enumerate() {
                let distance = state.distance_m.lane(lane) + body.station_m;
                let sample = track.irregularity.at(distance);
                for (side, rails) in irregular_m.iter_mut().enumerate() {
                    let (right, down) = sample.rail(sign(side));
                    if let Some(rail) = rails.get_mut(lane) {
                        *rail = [right, down];
                    }
                }
            }
        }
    }

    /// Adds the forces of both wheels to their wheelset, as one sum, so that a mirrored vehicle
    /// gets the mirrored force to the last bit.
    #[inline(always)]
    pub(super) fn add_wheels<const L: usize>(&self, work: &WheelWork<L>, forces: &mut Forces<L>) {
        for (axle, [left, right]) in self.axles.iter().zip(&work.wrenches) {
            let force = &mut forces[axle.body.index()];
            for (lane, (left, right)) in left.iter().zip(right).enumerate() {
                force[LATERAL].add_lane(lane, right[LATERAL] - left[LATERAL]);
                force[VERTICAL].add_lane(lane, right[VERTICAL] + left[VERTICAL]);
                force[ROLL].add_lane(lane, right[ROLL] - left[ROLL]);
                force[PITCH].add_lane(lane, right[PITCH] + left[PITCH]);
                force[YAW].add_lane(lane, right[YAW] - left[YAW]);
            }
        }
    }
}

impl RailSupport {
    /// Acceleration of a rail mass: right, down. The wheel's force on the wheelset acts on it
    /// reversed.
    #[inline(always)]
    fn acceleration<N: Number>(
        &self,
        position: [N; 2],
        velocity: [N; 2],
        force_n: [N; 2],
    ) -> [N; 2] {
        let both = |[lateral, vertical]: [f64; 2]| [N::splat(lateral), N::splat(vertical)];
        let [lateral_kg, vertical_kg] = both(self.mass_kg);
        let [lateral_k, vertical_k] = both(self.stiffness_n_per_m);
        let [lateral_c, vertical_c] = both(self.damping_n_s_per_m);
        let [right_n, down_n] = force_n;
        [
            (-right_n - lateral_k * position[0] - lateral_c * velocity[0]) / lateral_kg,
            (-down_n - vertical_k * position[1] - vertical_c * velocity[1]) / vertical_kg,
        ]
    }
}

// Functions and no closures: without LTO a closure of this loop is called, not inlined.

/// All coordinates of the wheels' bodies.
#[inline(always)]
fn of_bodies<N: Number, const L: usize>(
    seats: &N::Each<Seat>,
    poses: &[Pose<L>; BODIES_MAX],
) -> [N; COORDINATES] {
    [
        of_body(seats, poses, LATERAL),
        of_body(seats, poses, VERTICAL),
        of_body(seats, poses, ROLL),
        of_body(seats, poses, PITCH),
        of_body(seats, poses, YAW),
    ]
}

#[inline(always)]
fn of_body<N: Number, const L: usize>(
    seats: &N::Each<Seat>,
    poses: &[Pose<L>; BODIES_MAX],
    coordinate: usize,
) -> N {
    N::gather(seats, |seat| poses[seat.body & (BODIES_MAX - 1)][coordinate].lane(seat.lane))
}

/// Both directions of the wheels' rails.
#[inline(always)]
fn of_rails<N: Number, const L: usize>(
    seats: &N::Each<Seat>,
    rails: &[[[Lanes<L>; 2]; 2]; AXLES_MAX],
) -> [N; 2] {
    [of_rail(seats, rails, 0), of_rail(seats, rails, 1)]
}

#[inline(always)]
fn of_rail<N: Number, const L: usize>(
    seats: &N::Each<Seat>,
    rails: &[[[Lanes<L>; 2]; 2]; AXLES_MAX],
    direction: usize,
) -> N {
    N::gather(seats, |seat| rails[seat.axle][seat.side][direction].lane(seat.lane))
}
