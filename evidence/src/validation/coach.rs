//! The Manchester coach (Vehicle 1 of the benchmark): how it stands, and its eigenfrequencies.
//!
//! At rest every stage of springs gives way by the weight above it over its stiffness. With the
//! wheelsets held, springs join carbody, bogies and ground only, and left and right, front and rear
//! separate: bounce is two masses on springs, pitch three coordinates, sway four. Their small
//! matrices are written out here from masses and springs, apart from the vehicle's code, which
//! differences its accelerations ([`vehicle_studies::modes`]).

use super::check::{Check, Reference};
use super::vehicles;
use crate::error::EvidenceError;
use firmware_core::vehicle::{VERTICAL, Vehicle, VehicleState};
use firmware_core::wheel_rail::table::ContactTable;
use nalgebra::{DMatrix, SymmetricEigen};
use scenario::equilibrium;
use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;
use vehicle_studies::modes::{Coordinate, Impedances, Jacobians};

const SPEED_M_PER_S: f64 = 160.0 / 3.6;
const GRAVITY: f64 = 9.81;
const CAR_KG: f64 = 32_000.0;
const BOGIE_KG: f64 = 2_615.0;
const WHEELSET_KG: f64 = 1_813.0;
/// Vertical stiffness per axle box and per side of a bogie (N/m).
const PRIMARY_N_PER_M: f64 = 1.220e6;
const SECONDARY_N_PER_M: f64 = 0.430e6;

/// The comparison.
///
/// # Errors
/// The vehicle's file does not fit, or it does not stand.
pub(super) fn reference(_stop: &AtomicBool) -> Result<Reference, EvidenceError> {
    let coach = vehicles::manchester_coach()?;
    let table = coach.table()?;
    let degrees = coach.vehicle.degrees_of_freedom() as f64;
    let mut checks =
        vec![Check::near("degrees of freedom", "vehicle's file", [35.0, degrees], 0.0)];
    checks.extend(standing(&coach.vehicle, table)?);
    checks.extend(held_wheelsets(&coach.vehicle, table));
    checks.extend(on_its_wheels(&coach.vehicle, table)?);
    Ok(Reference {
        name: "manchester-coach",
        title: "Manchester benchmark Vehicle 1: equilibrium and eigenfrequencies",
        what: "The coach of scenarios/vehicles/manchester-coach.toml at rest, running at 160 km/h, and in \
               small vibrations with held wheelsets and on its wheels."
            .to_owned(),
        source: "Parameters: Iwnicki, Vehicle System Dynamics 30 (1998) 295-313, from public copies. Known \
                 values: springs and masses by hand.",
        tolerance: "Equilibrium: 1e-8 m/s2 and forces to 1e-9, ten times what Newton's method is \
                    asked for. Frequencies: 1e-5 of their value, the error of differences of width \
                    1e-8. On its wheels the carbody bounces more slowly because rails and wheels \
                    deflect elastically, by half the ratio of the stiffnesses of springs and \
                    contacts: at most a thousandth."
            .to_owned(),
        limits: vec![
            "The benchmark's published results were not available; its parameters are, and the \
             known numbers are calculated by hand. Longitudinal traction rods are omitted, as \
             there is no longitudinal motion."
                .to_owned(),
        ],
        checks,
        plots: Vec::new(),
    })
}

/// Sum of the vertical forces on all wheels (N), up positive.
fn carried_n(vehicle: &Vehicle, state: &VehicleState) -> f64 {
    let wheels = state.wheels.iter().take(vehicle.axles.len()).flatten().flatten();
    wheels.map(|wheel| -wheel.vertical_n).sum()
}

fn standing(vehicle: &Vehicle, table: &ContactTable) -> Result<Vec<Check>, EvidenceError> {
    let rest = equilibrium::at_rest(vehicle, Some(table))?;
    let steady = equilibrium::running(vehicle, Some(table), SPEED_M_PER_S)?;
    let weight_n = (CAR_KG + 2.0 * BOGIE_KG + 4.0 * WHEELSET_KG) * GRAVITY;
    let mut checks = Vec::new();
    for (at, found) in [("at rest", &rest), ("at 160 km/h", &steady)] {
        let residual = found.residual_m_per_s2;
        checks.push(Check::at_most("residual acceleration", at, residual, 1e-8).unit("m/s2"));
        let values = [weight_n, carried_n(vehicle, &found.state)];
        checks.push(Check::within("force carried by the rails", at, values, 1e-9).unit("N"));
    }
    for (number, wheel) in rest.state.wheels.iter().take(4).flatten().flatten().enumerate() {
        let at = format!("wheel {} of 8, at rest", number + 1);
        let values = [weight_n / 8.0, -wheel.vertical_n];
        checks.push(Check::within("wheel load", &at, values, 1e-9).unit("N"));
    }
    let down = |body: usize| rest.state.position[body][VERTICAL].lane(0);
    let bogies_m = 0.5 * (down(1) + down(2));
    let wheelsets_m = (3..7).map(down).sum::<f64>() / 4.0;
    let secondary_m = CAR_KG * GRAVITY / (4.0 * SECONDARY_N_PER_M);
    let primary_m = (CAR_KG + 2.0 * BOGIE_KG) * GRAVITY / (8.0 * PRIMARY_N_PER_M);
    for (at, known_m, ours_m) in [
        ("secondary", secondary_m, down(0) - bogies_m),
        ("primary", primary_m, bogies_m - wheelsets_m),
    ] {
        checks.push(Check::within("spring compression", at, [known_m, ours_m], 1e-9).unit("m"));
    }
    Ok(checks)
}

/// Small motions about a state.
fn small_motions(vehicle: &Vehicle, table: &ContactTable, state: &VehicleState) -> Jacobians {
    let (dampers, bodies) = (Impedances::default(), Coordinate::of_bodies(vehicle));
    Jacobians::about(vehicle, Some(table), (state, SPEED_M_PER_S), dampers, &bodies)
}

/// Every frequency of the carbody, the bogies' highest ones, by hand and by the vehicle's code.
fn held_wheelsets(vehicle: &Vehicle, table: &ContactTable) -> Vec<Check> {
    let mut held = vehicle.clone();
    for body in &mut held.bodies {
        if body.rolling_radius_m.is_some() {
            body.free = [false; 5];
        }
    }
    let stiffness = small_motions(&held, table, &VehicleState::default()).stiffness;
    let found: Vec<f64> =
        stiffness.complex_eigenvalues().iter().map(|value| hertz(value.re)).collect();
    let check = |(at, known_hz): (&str, f64)| {
        let values = [known_hz, nearest(&found, known_hz)];
        Check::within("eigenfrequency, held wheelsets", at, values, 1e-5).unit("Hz")
    };
    let [bounce, bogie_bounce] = bounce_hz();
    let pitch = pitch_hz();
    let sway = sway_hz();
    [
        ("carbody bounce", bounce),
        ("carbody pitch", pitch[0]),
        ("lower sway", sway[0]),
        ("upper sway", sway[1]),
        ("bogie bounce", bogie_bounce),
        ("bogie pitch", pitch[2]),
        ("bogie roll", sway[2]),
        ("bogie sway", sway[3]),
    ]
    .map(check)
    .to_vec()
}

fn bounce_hz() -> [f64; 2] {
    two_masses([4.0 * SECONDARY_N_PER_M, 8.0 * PRIMARY_N_PER_M], [CAR_KG, 2.0 * BOGIE_KG])
}

/// Carbody pitch, the bogies up against each other, the bogies' pitch.
fn pitch_hz() -> Vec<f64> {
    let (reach_m, half_base_m) = (9.5, 1.28);
    let [above_m, below_m, axle_m] = ARMS_M;
    let (along_1, along_2, bend) = (8.0 * 31.391e6, 4.0 * 0.160e6, 2.0 * 21.0e3);
    modes_hz(
        &[1.97e6, 2.0 * BOGIE_KG, 2.0 * 1_476.0],
        &[
            (4.0 * SECONDARY_N_PER_M, vec![reach_m, 1.0, 0.0]),
            (along_2, vec![above_m, 0.0, below_m]),
            (bend, vec![1.0, 0.0, -1.0]),
            (8.0 * PRIMARY_N_PER_M, vec![0.0, 1.0, 0.0]),
            (8.0 * PRIMARY_N_PER_M * half_base_m * half_base_m, vec![0.0, 0.0, 1.0]),
            (along_1 * axle_m * axle_m, vec![0.0, 0.0, 1.0]),
        ],
    )
}

/// Carbody right and roll, both bogies right and roll. A point z below a centre moves right by `y -
/// z roll`.
fn sway_hz() -> Vec<f64> {
    let [above_m, below_m, axle_m] = ARMS_M;
    let (across_1, across_2, bar) = (8.0 * 3.884e6, 4.0 * 0.160e6, 2.0 * 961.0e3);
    modes_hz(
        &[CAR_KG, 56_800.0, 2.0 * BOGIE_KG, 2.0 * 1_722.0],
        &[
            (across_2, vec![1.0, -above_m, -1.0, -below_m]),
            // Springs and wheels stand 1 m from the middle.
            (4.0 * SECONDARY_N_PER_M + bar, vec![0.0, 1.0, 0.0, -1.0]),
            (across_1, vec![0.0, 0.0, 1.0, -axle_m]),
            (8.0 * PRIMARY_N_PER_M, vec![0.0, 0.0, 0.0, 1.0]),
        ],
    )
}

/// Secondary springs below the carbody's centre and above the bogie's; axles below the bogie's (m).
const ARMS_M: [f64; 3] = [1.8 - 0.8275, 0.8275 - 0.6, 0.6 - 0.46];

fn on_its_wheels(vehicle: &Vehicle, table: &ContactTable) -> Result<Vec<Check>, EvidenceError> {
    let start = equilibrium::running(vehicle, Some(table), SPEED_M_PER_S)?;
    let mut undamped = vehicle.clone();
    for element in &mut undamped.suspensions {
        element.damping_n_s_per_m = [0.0; 3];
    }
    let values = small_motions(&undamped, table, &start.state)
        .eigenvalues()
        .ok_or(EvidenceError::NotComputed("the eigenvalue solver did not settle"))?;
    let frequencies: Vec<f64> = values.iter().map(|value| value.im.abs() / TAU).collect();
    let [held_hz, _] = bounce_hz();
    let values = [held_hz, nearest(&frequencies, held_hz)];
    // A Hertz contact has k = 1.5 N / delta, above 0.5 GN/m under 55 kN; eight of them against
    // springs of 1.46 MN/m in series lower the frequency by less than 2e-4; a thousandth leaves
    // room for profiles.
    let bounds = [0.999 * held_hz, held_hz];
    let quantity = "eigenfrequency, on its wheels";
    Ok(vec![Check::between(quantity, "carbody bounce", values, bounds).unit("Hz")])
}

fn hertz(square: f64) -> f64 {
    square.max(0.0).sqrt() / TAU
}

fn nearest(values: &[f64], wanted: f64) -> f64 {
    let distance = |value: f64| (value - wanted).abs();
    let closer = |best: f64, value: f64| {
        if distance(value) < distance(best) { value } else { best }
    };
    values.iter().copied().fold(f64::INFINITY, closer)
}

/// Frequencies of a mass on a mass on the ground: springs and masses from the top.
fn two_masses([upper, lower]: [f64; 2], [top_kg, bottom_kg]: [f64; 2]) -> [f64; 2] {
    let sum = upper / top_kg + (upper + lower) / bottom_kg;
    let root = (sum * sum - 4.0 * upper * lower / (top_kg * bottom_kg)).sqrt();
    [hertz(0.5 * (sum - root)), hertz(0.5 * (sum + root))]
}

/// Frequencies of masses on springs, each spring given by its stiffness and the stretch that every
/// coordinate gives it.
fn modes_hz(masses: &[f64], springs: &[(f64, Vec<f64>)]) -> Vec<f64> {
    let scaled = DMatrix::from_fn(masses.len(), masses.len(), |row, column| {
        let sum: f64 = springs.iter().map(|(k, arms)| k * arms[row] * arms[column]).sum();
        sum / (masses[row] * masses[column]).sqrt()
    });
    let mut found: Vec<f64> =
        SymmetricEigen::new(scaled).eigenvalues.iter().map(|value| hertz(*value)).collect();
    found.sort_by(f64::total_cmp);
    found
}
