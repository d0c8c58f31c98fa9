//! Energy is conserved without dissipation, and lost only to the dampers.
//!
//! An SS9 on wheels without friction is pushed. Its potential energy is built here from the data of
//! the elements, apart from the code of the step:
//! ```text
//! U = sum of k d^2/2 (springs, torsions, rails) + bump stops - m g z
//!   + sum of 2/5 k delta^2.5 (contacts)
//! ```
//! Without dampers it must be conserved; with dampers it only falls, and the loss is the work done
//! on them.

use super::check::{Check, Reference};
use super::locomotive::{Dampers, Locomotive, SPEED_M_PER_S, SUBSTEP_S};
use crate::error::EvidenceError;
use firmware_core::lanes::Lanes;
use firmware_core::track::Track;
use firmware_core::vehicle::{
    Anchor, Axle, BumpStop, COORDINATES, DAMPER_SLOTS, DamperForces, LATERAL, PITCH, ROLL, Running,
    Suspension, VERTICAL, Vehicle, VehicleState, YAW,
};
use firmware_core::wheel_rail::table::{ContactTable, ZoneTable};
use report::Plot;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The comparison.
///
/// # Errors
/// The vehicle's file does not fit, or it does not stand.
pub(super) fn reference(stop: &AtomicBool) -> Result<Reference, EvidenceError> {
    let (without, with) = rayon::join(|| Pushed::new(false), || Pushed::new(true));
    let (without, with) = (without?, with?);
    let (kept, taken) = rayon::join(|| without.looks(20.0, stop), || with.looks(5.0, stop));
    let (kept, taken) = (kept?, taken?);
    let push_j = without.push_j;
    let change = |look: &Look| look.energy_j - kept[0].energy_j;
    let most_j = kept.iter().map(|look| change(look).abs()).fold(0.0, f64::max);
    let mean = |part: &[Look]| part.iter().map(change).sum::<f64>() / part.len() as f64;
    let third = kept.len() / 4;
    let drift_j = mean(&kept[kept.len() - third..]) - mean(&kept[..third]);
    let shift_m = kept.iter().map(|look| look.shift_m).fold(0.0, f64::max);

    let total = |look: &Look| look.energy_j + look.yaw_stored_j;
    let rises = taken.windows(2).map(|two| total(&two[1]) - total(&two[0]));
    let highest_j = rises.fold(f64::MIN, f64::max);
    let last = taken.last().ok_or(EvidenceError::NotComputed("a run without an end"))?;
    let left_j = total(&taken[0]) - total(last);
    // What went into the yaw dampers is lost but for what their springs hold.
    let dampers_j = last.yaw_work_j - last.yaw_stored_j + last.linear_j;
    let undamped = "20 s without dampers";
    let damped = "5 s with dampers";
    let rail_hz = without.rail_hz();
    // The leapfrog's energy swings about the true one by (w h / 2)^2 of what is in a mode of
    // frequency w.
    let swing = rail_hz * std::f64::consts::TAU * SUBSTEP_S / 2.0;
    let swing_j = swing * swing * push_j;
    let checks = vec![
        Check::at_most("energy swings", undamped, most_j, swing_j).unit("J"),
        Check::near("energy drifts", undamped, [0.0, drift_j], 1e-3 * left_j).unit("J"),
        Check::at_least("shift of the wheels by the push", undamped, 1e3 * shift_m, 2.0).unit("mm"),
        Check::within("energy loss, and work of the dampers", damped, [left_j, dampers_j], 5e-3)
            .unit("J"),
        Check::at_most("energy rises within 10 ms", damped, highest_j, swing_j).unit("J"),
        Check::at_least("share of the push that is dissipated", damped, left_j / push_j, 0.5),
        Check::at_least("yaw dampers' share", damped, last.yaw_work_j / push_j, 0.02),
    ];
    Ok(Reference {
        name: "energy",
        title: "Energy",
        what: format!(
            "An SS9 at 160 km/h on frictionless wheels, carbody, bogie and a wheelset pushed with {push_j:.0} J: \
             without any damper, and with all of them, four yaw dampers with clearance and relief among \
             them."
        ),
        source: "Conservation of energy; the energy is computed from the elements' data, \
                 independently of the step.",
        tolerance: format!(
            "The leapfrog is symplectic: its energy swings about the true one by (w h / 2)^2 of \
             what a mode of angular frequency w holds, and does not drift. The fastest modes that \
             the push excites are the rails on their springs, {rail_hz:.0} Hz: {:.2} % of the \
             push. Drift in 15 s: a thousandth of the work of the dampers. Work and energy: 0.5 %, \
             both by the trapezoidal rule over steps in which dampers go from clearance to \
             relief.",
            100.0 * swing * swing
        ),
        limits: vec![
            "Creep is off here: it exchanges energy with the vehicle's own speed, which is \
             held."
                .to_owned(),
        ],
        checks,
        plots: vec![plot(&kept, &taken)],
    })
}

/// Steps between two looks: 10 ms.
const STEPS_PER_LOOK: u32 = 40;

fn plot(kept: &[Look], taken: &[Look]) -> Plot {
    let time = |looks: &[Look]| -> Vec<f64> { (0..looks.len()).map(|n| n as f64 * 0.01).collect() };
    let lost =
        |looks: &[Look], of: &dyn Fn(&Look) -> f64| -> Vec<f64> { looks.iter().map(of).collect() };
    let begin = taken[0].energy_j;
    let energy = lost(taken, &|look| begin - look.energy_j - look.yaw_stored_j);
    let work = lost(taken, &|look| look.yaw_work_j - look.yaw_stored_j + look.linear_j);
    let first = kept[0].energy_j;
    let change = lost(kept, &|look| look.energy_j - first);
    let shown = taken.len().min(kept.len());
    Plot::new("Energy")
        .x("time", "s")
        .y("lost", "J")
        .line("energy loss, with dampers", &time(taken), &energy)
        .dashed("work of the dampers", &time(taken), &work)
        .panel_below("change, without dampers", "J")
        .line("change, without dampers", &time(&kept[..shown]), &change[..shown])
}

/// An SS9 whose wheels slide without friction, pushed; with or without its dampers.
struct Pushed {
    vehicle: Vehicle,
    table: Arc<ContactTable>,
    start: VehicleState,
    dampers: Dampers,
    damped: bool,
    /// Kinetic energy of the push (J).
    push_j: f64,
}

impl Pushed {
    fn new(damped: bool) -> Result<Self, EvidenceError> {
        let Locomotive { mut vehicle, contact, start, dampers } = Locomotive::new()?;
        for axle in &mut vehicle.axles {
            axle.wheel.friction = 0.0;
            if let Some(rail) = axle.rail.as_mut().filter(|_| !damped) {
                rail.damping_n_s_per_m = [0.0; 2];
            }
        }
        if !damped {
            vehicle.suspensions.iter_mut().for_each(|e| e.damping_n_s_per_m = [0.0; 3]);
            vehicle.dampers.clear();
        }
        let mut start = start;
        // Everything gets a push; a wheelset swings by some millimetres on its gravity stiffness.
        start.half_velocity[0] = [0.05, 0.1, 0.02, 0.01, 0.01].map(|v| Lanes([v]));
        start.half_velocity[1] = [0.05, -0.1, 0.05, 0.02, -0.02].map(|v| Lanes([v]));
        start.half_velocity[5][LATERAL] = Lanes([-0.03]);
        start.half_velocity[5][YAW] = Lanes([0.02]);
        // What the wheelsets' spin deviates from rolling is no part of the push.
        let mut pushed = start.clone();
        for pose in &mut pushed.half_velocity[3..] {
            pose[PITCH] = Lanes([0.0]);
        }
        let push_j = pushed.kinetic_energy_j(&vehicle.bodies, 0);
        Ok(Self { vehicle, table: contact.table, start, dampers, damped, push_j })
    }

    /// Frequency of a rail on its stiffer spring (Hz).
    fn rail_hz(&self) -> f64 {
        let supports = self.vehicle.axles.iter().filter_map(|axle| axle.rail);
        let squares = supports
            .flat_map(|rail| [0, 1].map(|way| rail.stiffness_n_per_m[way] / rail.mass_kg[way]));
        squares.fold(0.0, f64::max).sqrt() / std::f64::consts::TAU
    }

    /// Looks every 10 ms.
    fn looks(&self, seconds: f64, stop: &AtomicBool) -> Result<Vec<Look>, EvidenceError> {
        let Self { vehicle, table, .. } = self;
        let track = Track::default();
        let running = Running {
            speed_m_per_s: Lanes([SPEED_M_PER_S]),
            tracks: [&track],
            contact: Some(table),
            substep_s: SUBSTEP_S,
        };
        let mut state = self.start.clone();
        vehicle.start(&mut state, &running);
        let dampers = self.dampers.clone();
        let mut metered = Metered { dampers, last: [(0.0, 0.0); DAMPER_SLOTS], work_j: 0.0 };
        let (mut linear_j, mut last_w) = (0.0, 0.0);
        let mut found = Vec::new();
        for step in 0..libm::round(seconds / SUBSTEP_S) as u32 {
            // What a step sees at the time of its positions, on copies: the run itself is not
            // touched.
            let looks = step % STEPS_PER_LOOK == 0;
            if looks {
                EvidenceError::check(stop)?;
            }
            if self.damped || looks {
                let (mut seen, mut meter) = (state.clone(), metered.clone());
                vehicle.evaluate(&mut seen, &running, &mut meter);
                let power_w = linear_dampers_w(vehicle, &seen);
                if step > 0 {
                    linear_j += 0.5 * (power_w + last_w) * SUBSTEP_S;
                }
                last_w = power_w;
                if looks {
                    let shifts = seen.shifts_m.iter().flatten().map(|shift| shift.lane(0).abs());
                    found.push(Look {
                        energy_j: energy_j(vehicle, table, &seen),
                        yaw_work_j: meter.work_j,
                        yaw_stored_j: meter.stored_j(),
                        linear_j,
                        shift_m: shifts.fold(0.0, f64::max),
                    });
                }
            }
            vehicle.step(&mut state, &running, &mut metered, 1);
        }
        Ok(found)
    }
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

/// Dampers that sum up the work done on each (J).
#[derive(Clone)]
struct Metered {
    dampers: Dampers,
    last: [(f64, f64); DAMPER_SLOTS],
    work_j: f64,
}

impl DamperForces for Metered {
    fn force_n(&mut self, slot: usize, lane: usize, x_m: f64, rate: f64, substep_s: f64) -> f64 {
        let force_n = self.dampers.force_n(slot, lane, x_m, rate, substep_s);
        if let Some(last) = self.last.get_mut(slot) {
            self.work_j += 0.5 * (force_n + last.1) * (x_m - last.0);
            *last = (x_m, force_n);
        }
        force_n
    }
}

impl Metered {
    /// Elastic energy in the series springs.
    fn stored_j(&self) -> f64 {
        let stored =
            |(_, force_n): &(f64, f64)| 0.5 * force_n * force_n / self.dampers.stiffness_n_per_m();
        self.last.iter().map(stored).sum()
    }
}

/// Coordinates of every body.
type Poses = Vec<[f64; COORDINATES]>;

fn poses(vehicle: &Vehicle, of: &[[Lanes<1>; COORDINATES]]) -> Poses {
    of.iter().take(vehicle.bodies.len()).map(|pose| pose.map(|value| value.lane(0))).collect()
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
            let v = velocity(
                state.half_velocity[index][c].lane(0),
                state.acceleration[index][c].lane(0),
            );
            sum += 0.5 * body.inertia(c) * v * v;
        }
    }
    sum += vehicle.suspensions.iter().map(|element| of_suspension(element, &q)).sum::<f64>();
    sum += vehicle.bump_stops.iter().map(|stop| of_bump_stop(stop, &q)).sum::<f64>();
    for (number, axle) in vehicle.axles.iter().enumerate() {
        let rails = state.rail_position[number].map(|rail| rail.map(|value| value.lane(0)));
        sum += of_axle(axle, table, &q[axle.body.index()], rails);
        let Some(support) = axle.rail else { continue };
        for side in 0..2 {
            for way in 0..2 {
                let v = velocity(
                    state.rail_half_velocity[number][side][way].lane(0),
                    state.rail_acceleration[number][side][way].lane(0),
                );
                sum += 0.5 * support.mass_kg[way] * v * v;
            }
        }
    }
    sum
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
                    state.rail_half_velocity[number][side][way].lane(0),
                    state.rail_acceleration[number][side][way].lane(0),
                );
                sum += support.damping_n_s_per_m[way] * v * v;
            }
        }
    }
    sum
}
