//! Energy stays where nothing takes it away, and goes where dampers take it.
//!
//! Potential energy is built here from the data of the elements, apart from the code of the step:
//! ```text
//! U = sum of k d^2/2 (springs, torsions, rails) + bump stops - m g z + sum of 2/5 k delta^2.5 (contacts)
//! ```

use crate::locomotive::{Modelled, dampers, scenario};
use firmware_core::lanes::Lanes;
use firmware_core::track::Track;
use firmware_core::vehicle::{
    Anchor, Axle, BumpStop, COORDINATES, DAMPER_SLOTS, DamperForces, LATERAL, PITCH, ROLL, Running,
    Suspension, VERTICAL, Vehicle, VehicleState, YAW,
};
use firmware_core::wheel_rail::table::{ContactTable, ZoneTable};

const SUBSTEP_S: f64 = 0.25e-3;

/// Coordinates of every body.
type Poses = Vec<[f64; COORDINATES]>;

fn poses(vehicle: &Vehicle, of: &[[Lanes<1>; COORDINATES]]) -> Poses {
    of.iter().take(vehicle.bodies.len()).map(|pose| pose.map(|value| value.0[0])).collect()
}

/// Displacement of a point by the small rotations of its body; zero on the ground.
fn point(poses: &Poses, at: &Anchor) -> [f64; 3] {
    let Some(pose) = poses.get(at.body.index()) else { return [0.0; 3] };
    let (p, turn) = (at.point_m, nalgebra::Vector3::new(pose[ROLL], pose[PITCH], pose[YAW]));
    let moved = turn.cross(&p);
    [moved.x, pose[LATERAL] + moved.y, pose[VERTICAL] + moved.z]
}

fn stretch(poses: &Poses, first: &Anchor, second: &Anchor) -> [f64; 3] {
    let (a, b) = (point(poses, first), point(poses, second));
    [b[0] - a[0], b[1] - a[1], b[2] - a[2]]
}

fn of_suspension(element: &Suspension, poses: &Poses) -> f64 {
    let d = stretch(poses, &element.first, &element.second);
    (0..3)
        .map(|axis| {
            let beyond = (d[axis].abs() - 0.5 * element.play_m[axis]).max(0.0);
            0.5 * element.stiffness_n_per_m[axis] * beyond * beyond
        })
        .sum()
}

/// Area under the characteristic.
fn of_bump_stop(stop: &BumpStop, poses: &Poses) -> f64 {
    let reach = stretch(poses, &stop.first, &stop.second)[1].abs();
    let steps = 200;
    let width = reach / f64::from(steps);
    (0..steps).map(|n| stop.force_n((f64::from(n) + 0.5) * width) * width).sum()
}

fn of_zone(zone: &ZoneTable, shift_m: f64, drop_m: f64, roll_rad: f64) -> f64 {
    let shape = zone.at(shift_m - roll_rad * zone.rail_radius_m(shift_m));
    let slope = shape.slope - roll_rad;
    let touch_m = shape.touch_m - roll_rad * shape.rail_centre_m;
    let approach_m = (drop_m - touch_m) / (1.0 + slope * slope).sqrt();
    if approach_m > 0.0 { 0.4 * shape.hertz_n_per_m15 * libm::pow(approach_m, 2.5) } else { 0.0 }
}

fn of_axle(
    axle: &Axle,
    table: &ContactTable,
    pose: &[f64; COORDINATES],
    rails: [[f64; 2]; 2],
) -> f64 {
    let mut sum = 0.0;
    for (side, rail) in [-1.0, 1.0].into_iter().zip(rails) {
        let roll = side * pose[ROLL];
        let shift_m = side * (pose[LATERAL] - rail[0]) - roll * axle.wheel.radius_m;
        let drop_m = pose[VERTICAL] - rail[1] + roll * axle.wheel.tape_m;
        sum += of_zone(&table.tread, shift_m, drop_m, roll);
        sum += of_zone(&table.flange, shift_m, drop_m, roll);
        if let Some(support) = axle.rail {
            sum += (0..2)
                .map(|way| 0.5 * support.stiffness_n_per_m[way] * rail[way] * rail[way])
                .sum::<f64>();
        }
    }
    sum
}

/// Potential and kinetic energy at the time of the positions (J).
fn energy_j(vehicle: &Vehicle, table: &ContactTable, state: &VehicleState) -> f64 {
    let q = poses(vehicle, &state.position);
    let velocity = |half: f64, rate: f64| half + 0.5 * SUBSTEP_S * rate;
    let mut sum = 0.0;
    for (index, body) in vehicle.bodies.iter().enumerate() {
        sum -= body.mass_kg * 9.81 * q[index][VERTICAL];
        for c in 0..COORDINATES {
            let v = velocity(state.half_velocity[index][c].0[0], state.acceleration[index][c].0[0]);
            sum += 0.5 * body.inertia(c) * v * v;
        }
    }
    sum += vehicle.suspensions.iter().map(|element| of_suspension(element, &q)).sum::<f64>();
    sum += vehicle.bump_stops.iter().map(|stop| of_bump_stop(stop, &q)).sum::<f64>();
    for (number, axle) in vehicle.axles.iter().enumerate() {
        let rails = state.rail_position[number].map(|rail| rail.map(|value| value.0[0]));
        sum += of_axle(axle, table, &q[axle.body.index()], rails);
        let Some(support) = axle.rail else { continue };
        for side in 0..2 {
            for way in 0..2 {
                let v = velocity(
                    state.rail_half_velocity[number][side][way].0[0],
                    state.rail_acceleration[number][side][way].0[0],
                );
                sum += 0.5 * support.mass_kg[way] * v * v;
            }
        }
    }
    sum
}

/// An SS9 whose wheels slide without friction; with or without its dampers.
fn frictionless(damped: bool) -> (Vehicle, Box<ContactTable>, VehicleState) {
    let run = scenario("ss9-160kmh.toml");
    let mut vehicle = run.vehicle.clone();
    for axle in &mut vehicle.axles {
        axle.wheel.friction = 0.0;
        if let Some(rail) = axle.rail.as_mut().filter(|_| !damped) {
            rail.damping_n_s_per_m = [0.0; 2];
        }
    }
    for element in &mut vehicle.suspensions {
        if !damped {
            element.damping_n_s_per_m = [0.0; 3];
        }
    }
    let mut state = run.start.state.clone();
    // Everything gets a push; a wheelset swings by some millimetres on its gravity stiffness.
    state.half_velocity[0] = [0.05, 0.1, 0.02, 0.01, 0.01].map(|v| Lanes([v]));
    state.half_velocity[1] = [0.05, -0.1, 0.05, 0.02, -0.02].map(|v| Lanes([v]));
    state.half_velocity[5][LATERAL] = Lanes([-0.03]);
    state.half_velocity[5][YAW] = Lanes([0.02]);
    (vehicle, run.contact.unwrap().table, state)
}

/// Modelled dampers that sum up the work done on each (J).
#[derive(Clone)]
struct Metered {
    dampers: Modelled<1>,
    last: [(f64, f64); DAMPER_SLOTS],
    work_j: f64,
}

impl DamperForces for Metered {
    fn force_n(&mut self, slot: usize, lane: usize, x_m: f64, rate: f64, substep_s: f64) -> f64 {
        let force_n = self.dampers.force_n(slot, lane, x_m, rate, substep_s);
        let (last_m, last_n) = self.last[slot];
        self.work_j += 0.5 * (force_n + last_n) * (x_m - last_m);
        self.last[slot] = (x_m, force_n);
        force_n
    }
}

impl Metered {
    /// Elastic energy in the series springs.
    fn stored_j(&self) -> f64 {
        let stiffness = |slot: usize| self.dampers.dampers[slot][0].nominal().ke_n_per_m;
        let stored =
            |(slot, (_, force_n)): (usize, &(f64, f64))| 0.5 * force_n * force_n / stiffness(slot);
        self.last.iter().enumerate().map(stored).sum()
    }
}

/// Power that the linear dampers of suspension and rails take (W).
fn linear_dampers_w(vehicle: &Vehicle, state: &VehicleState) -> f64 {
    let velocity = |half: f64, rate: f64| half + 0.5 * SUBSTEP_S * rate;
    let rates: Poses = poses(vehicle, &state.half_velocity)
        .iter()
        .zip(poses(vehicle, &state.acceleration))
        .map(|(half, rate)| std::array::from_fn(|c| velocity(half[c], rate[c])))
        .collect();
    let mut sum = 0.0;
    for element in &vehicle.suspensions {
        let v = stretch(&rates, &element.first, &element.second);
        sum += (0..3).map(|axis| element.damping_n_s_per_m[axis] * v[axis] * v[axis]).sum::<f64>();
    }
    for (number, axle) in vehicle.axles.iter().enumerate() {
        let Some(support) = axle.rail else { continue };
        for side in 0..2 {
            for way in 0..2 {
                let v = velocity(
                    state.rail_half_velocity[number][side][way].0[0],
                    state.rail_acceleration[number][side][way].0[0],
                );
                sum += support.damping_n_s_per_m[way] * v * v;
            }
        }
    }
    sum
}

/// One look at a run.
struct Look {
    /// Energy of vehicle and rails (J).
    energy_j: f64,
    /// Work done on the yaw dampers so far (J).
    yaw_work_j: f64,
    /// What their springs hold of it (J).
    yaw_stored_j: f64,
    /// Energy taken by the linear dampers so far (J).
    linear_j: f64,
    /// Largest lateral shift of a wheel (m).
    shift_m: f64,
}

/// Looks every 10 ms.
fn looks(vehicle: &Vehicle, table: &ContactTable, start: VehicleState, seconds: f64) -> Vec<Look> {
    let damped = vehicle.suspensions.iter().any(|e| e.damping_n_s_per_m != [0.0; 3]);
    let run = scenario("ss9-160kmh.toml");
    let mut vehicle = vehicle.clone();
    if !damped {
        vehicle.dampers.clear();
    }
    let track = Track::default();
    let running = Running {
        speed_m_per_s: Lanes([run.speed_m_per_s]),
        track: &track,
        contact: Some(table),
        substep_s: SUBSTEP_S,
    };
    let mut state = start;
    vehicle.start(&mut state, &running);
    let dampers = Modelled::new(dampers(&run).into_iter().map(|damper| [damper]).collect());
    let mut metered = Metered { dampers, last: [(0.0, 0.0); DAMPER_SLOTS], work_j: 0.0 };
    let (mut linear_j, mut last_w) = (0.0, 0.0);
    let mut found = Vec::new();
    for step in 0..libm::round(seconds / SUBSTEP_S) as u32 {
        // What a step sees at the time of its positions, on copies: the run itself is not touched.
        let looks = step % 40 == 0;
        if damped || looks {
            let (mut seen, mut meter) = (state.clone(), metered.clone());
            vehicle.evaluate(&mut seen, &running, &mut meter);
            let power_w = linear_dampers_w(&vehicle, &seen);
            if step > 0 {
                linear_j += 0.5 * (power_w + last_w) * SUBSTEP_S;
            }
            last_w = power_w;
            if looks {
                let shifts = seen.shifts_m.iter().flatten().map(|shift| shift.0[0].abs());
                found.push(Look {
                    energy_j: energy_j(&vehicle, table, &seen),
                    yaw_work_j: meter.work_j,
                    yaw_stored_j: meter.stored_j(),
                    linear_j,
                    shift_m: shifts.fold(0.0, f64::max),
                });
            }
        }
        vehicle.step(&mut state, &running, &mut metered, 1);
    }
    found
}

/// Kinetic energy of the push (J).
fn push_j(vehicle: &Vehicle, start: &VehicleState) -> f64 {
    let mut pushed = start.clone();
    for pose in &mut pushed.half_velocity[3..] {
        pose[PITCH] = Lanes([0.0]);
    }
    pushed.kinetic_energy_j(&vehicle.bodies, 0)
}

#[test]
fn without_dampers_and_creep_energy_stays() {
    let (vehicle, table, start) = frictionless(false);
    let push_j = push_j(&vehicle, &start);
    let found = looks(&vehicle, &table, start, 20.0);
    let change = |look: &Look| look.energy_j - found[0].energy_j;
    let most = found.iter().map(|look| change(look).abs()).fold(0.0, f64::max);
    let mean = |part: &[Look]| part.iter().map(change).sum::<f64>() / part.len() as f64;
    let drift = mean(&found[1500..]) - mean(&found[..500]);
    let shift_m = found.iter().map(|look| look.shift_m).fold(0.0, f64::max);
    println!("pushed by {push_j:.1} J: energy within {most:.3} J, drift {drift:.4} J in 15 s");
    println!("largest shift {:.2} mm", shift_m * 1e3);
    assert!(shift_m > 2e-3, "the wheels hardly move: {shift_m}");
    assert!(most < 4e-3 * push_j, "{most} of {push_j} J");
    assert!(drift.abs() < 5e-4 * push_j, "{drift} of {push_j} J");
}

#[test]
fn with_dampers_energy_falls_by_what_they_take() {
    let (vehicle, table, start) = frictionless(true);
    let push_j = push_j(&vehicle, &start);
    let found = looks(&vehicle, &table, start, 5.0);
    let total = |look: &Look| look.energy_j + look.yaw_stored_j;
    let rises = found.windows(2).map(|two| total(&two[1]) - total(&two[0]));
    let highest = rises.fold(f64::MIN, f64::max);
    let (first, last) = (&found[0], found.last().unwrap());
    let left = first.energy_j - last.energy_j;
    let taken = last.yaw_work_j + last.linear_j;
    println!("pushed by {push_j:.1} J: {left:.2} J left, {taken:.2} J taken");
    println!("yaw dampers {:.2} J, others {:.2} J", last.yaw_work_j, last.linear_j);
    println!("largest rise in 10 ms: {highest:.4} J");
    assert!(left > 0.5 * push_j, "{left} of {push_j} J");
    assert!((taken / left - 1.0).abs() < 5e-3, "{taken} J taken, {left} J left");
    assert!(last.yaw_work_j > 0.02 * push_j, "{}", last.yaw_work_j);
    // No rise beyond what the undamped run swings by.
    assert!(highest < 1e-3 * push_j, "{highest} J");
}
