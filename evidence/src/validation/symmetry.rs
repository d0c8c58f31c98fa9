//! A mirrored run is the mirror image.
//!
//! Left and right of a vehicle are alike, so a run with everything on the other side (curve, cant,
//! alignment, cross level, a push at the start, the points of springs and dampers) has to be the
//! mirror image: lateral, roll and yaw change their sign, left and right wheels change places, and
//! nothing else differs, not even the last bit.

use super::check::{Check, Reference};
use super::locomotive::{Locomotive, SUBSTEP_S};
use super::steps::stepped;
use crate::error::EvidenceError;
use firmware_core::lanes::Lanes;
use firmware_core::track::{IrregularitySample, Layout, Track};
use firmware_core::vehicle::{LATERAL, ROLL, Running, Vehicle, VehicleState, YAW};
use nalgebra::Vector3;
use scenario::irregularity::{Band, Samples, aar6};
use std::sync::atomic::AtomicBool;

/// Time (s) and speed (m/s) of the runs.
const DURATION_S: f64 = 6.0;
const SPEED_M_PER_S: f64 = 25.0;
const BOGIE_FRONT: usize = 1;
const WHEELSET_3: usize = 5;

/// The comparison.
///
/// # Errors
/// The vehicle's file does not fit, or it does not stand.
pub(super) fn reference(stop: &AtomicBool) -> Result<Reference, EvidenceError> {
    let locomotive = Locomotive::new()?;
    let band = Band { seed: 1, shortest: 1.0, longest: 100.0, scale: 1.0 };
    let track = aar6(&band, 0.0, DURATION_S * SPEED_M_PER_S + 50.0);
    let mut other_track = track.clone();
    for sample in &mut other_track.samples {
        let IrregularitySample { alignment_m, cross_level_m, .. } = *sample;
        (sample.alignment_m, sample.cross_level_m) = (-alignment_m, -cross_level_m);
    }
    let other_vehicle = mirrored_vehicle(&locomotive.vehicle);
    let seen = bumpy_run(&locomotive, &locomotive.vehicle, 1.0, &track, stop)?;
    let image = bumpy_run(&locomotive, &other_vehicle, -1.0, &other_track, stop)?;
    let expected = mirrored_state(&seen);
    let moved_mm = 1e3 * seen.position[0][LATERAL].lane(0).abs();
    let at = "after 6 s";
    let same =
        |quantity: &str, off: bool| Check::at_most(quantity, at, f64::from(u8::from(off)), 0.0);
    let checks = vec![
        Check::at_least("shift of the carbody", at, moved_mm, 1.0).unit("mm"),
        same("positions differ", image.position != expected.position),
        same("velocities differ", image.half_velocity != expected.half_velocity),
        same("rails differ", image.rail_position != expected.rail_position),
        same("wheel forces differ", image.wheels != expected.wheels),
        same("damper forces differ", image.damper_n != expected.damper_n),
    ];
    Ok(Reference {
        name: "mirror",
        title: "Mirror symmetry",
        what: "An SS9 at 90 km/h into a curve of 400 m with cant over class-6 track, carbody, a bogie and a \
               wheelset pushed aside, four yaw dampers; and the same on the other side. 1 where any bit differs."
            .to_owned(),
        source: "Symmetry of the vehicle.",
        tolerance: "None: the mirror image must match to the last bit.".to_owned(),
        limits: vec![
            "Other rigid motions of the whole are not tested: gravity, speed and track have fixed \
             directions."
                .to_owned(),
        ],
        checks,
        plots: Vec::new(),
    })
}

/// The vehicle seen in a mirror: every point on the other side.
fn mirrored_vehicle(vehicle: &Vehicle) -> Vehicle {
    let mut mirrored = vehicle.clone();
    let flip = |point: &mut Vector3<f64>| point.y = -point.y;
    for element in &mut mirrored.suspensions {
        flip(&mut element.first.point_m);
        flip(&mut element.second.point_m);
    }
    for mount in &mut mirrored.dampers {
        flip(&mut mount.first.point_m);
        flip(&mut mount.second.point_m);
        flip(&mut mount.direction);
    }
    mirrored
}

fn mirrored_state(state: &VehicleState) -> VehicleState {
    let mut mirrored = state.clone();
    for pose in mirrored
        .position
        .iter_mut()
        .chain(&mut mirrored.half_velocity)
        .chain(&mut mirrored.acceleration)
    {
        for coordinate in [LATERAL, ROLL, YAW] {
            pose[coordinate] = -pose[coordinate];
        }
    }
    for sides in mirrored
        .rail_position
        .iter_mut()
        .chain(&mut mirrored.rail_half_velocity)
        .chain(&mut mirrored.rail_acceleration)
    {
        sides.swap(0, 1);
        for rail in sides {
            rail[0] = -rail[0];
        }
    }
    for sides in &mut mirrored.wheels {
        sides.swap(0, 1);
    }
    for sides in &mut mirrored.shifts_m {
        sides.swap(0, 1);
    }
    mirrored
}

/// A transition from 40 m on into a curve of 400 m; a positive sign turns right.
fn curve(sign: f64) -> Result<Layout, EvidenceError> {
    let mut layout = Layout::tangent();
    let full = |_| EvidenceError::NotComputed("a layout that does not fit");
    layout.hold(40.0).map_err(full)?;
    layout.ramp(60.0, sign / 400.0, sign * 0.08, 6.0).map_err(full)?;
    Ok(layout)
}

fn bumpy_run(
    locomotive: &Locomotive,
    vehicle: &Vehicle,
    sign: f64,
    samples: &Samples,
    stop: &AtomicBool,
) -> Result<VehicleState, EvidenceError> {
    let track = Track { layout: curve(sign)?, irregularity: samples.view() };
    let running = Running {
        speed_m_per_s: Lanes([SPEED_M_PER_S]),
        tracks: [&track],
        contact: Some(&locomotive.contact.table),
        substep_s: SUBSTEP_S,
    };
    let mut dampers = locomotive.dampers.clone();
    let mut state = locomotive.start.clone();
    state.position[0][LATERAL] = Lanes([5e-3]);
    state.position[WHEELSET_3][YAW] = Lanes([1e-3]);
    state.half_velocity[BOGIE_FRONT][ROLL] = Lanes([0.02]);
    if sign < 0.0 {
        state = mirrored_state(&state);
    }
    vehicle.start(&mut state, &running);
    let steps = libm::round(DURATION_S / SUBSTEP_S) as u32;
    stepped(steps, stop, |steps| vehicle.step(&mut state, &running, &mut dampers, steps))?;
    Ok(state)
}
