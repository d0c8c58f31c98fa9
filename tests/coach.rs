//! The Manchester coach from its data file: another vehicle without code of its own.
//!
//! Its equilibrium, its rigid-body frequencies against a calculation by hand, and a run over
//! irregular track.

#![expect(clippy::unwrap_used, reason = "a test stops where it fails")]

use firmware_core::lanes::Lanes;
use firmware_core::track::{Irregularity, Layout, Track};
use firmware_core::vehicle::{Running, Vehicle, VehicleState};
use firmware_core::wheel_rail::table::ContactTable;
use nalgebra::{DMatrix, SymmetricEigen};
use scenario::equilibrium;
use scenario::irregularity::{Band, aar6};
use scenario::source::Source;
use scenario::vehicle::VehicleFile;
use std::path::Path;
use studies::modes::{Coordinate, Impedances, Jacobians};

const SPEED_M_PER_S: f64 = 160.0 / 3.6;

fn coach() -> (Vehicle, Box<ContactTable>) {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/vehicles/manchester-coach.toml");
    let source = Source::read(&path).unwrap();
    let file: VehicleFile = source.parse().unwrap();
    let contact = file.wheel_rail.contact(&source).unwrap().unwrap();
    (file.build(&source).unwrap(), contact.table)
}

/// Small motions about a state, on rails that do not give way.
fn small_motions(vehicle: &Vehicle, table: &ContactTable, state: &VehicleState) -> Jacobians {
    let (dampers, bodies) = (Impedances::default(), Coordinate::of_bodies(vehicle));
    Jacobians::about(vehicle, Some(table), (state, SPEED_M_PER_S), dampers, &bodies)
}

/// Sum of the vertical forces on all wheels (N), up positive.
fn carried_n(vehicle: &Vehicle, state: &VehicleState) -> f64 {
    let wheels = state.wheels.iter().take(vehicle.axles.len()).flatten().flatten();
    wheels.map(|wheel| -wheel.vertical_n).sum()
}

#[test]
fn it_stands_and_runs_in_equilibrium_and_the_rails_carry_its_weight() {
    let (vehicle, table) = coach();
    assert_eq!(vehicle.degrees_of_freedom(), 35);
    let rest = equilibrium::at_rest(&vehicle, Some(&table)).unwrap();
    let steady = equilibrium::running(&vehicle, Some(&table), SPEED_M_PER_S).unwrap();
    let weight_n = vehicle.mass_kg() * 9.81;
    for (name, found) in [("at rest", &rest), ("at 160 km/h", &steady)] {
        let carried_n = carried_n(&vehicle, &found.state);
        println!("{name}: {:.1e} m/s2 left, {carried_n:.3} N carried", found.residual_m_per_s2);
        assert!(found.residual_m_per_s2 < 1e-8, "{name}: {}", found.residual_m_per_s2);
        assert!((carried_n / weight_n - 1.0).abs() < 1e-9, "{name}: {carried_n} {weight_n}");
    }
}

/// The carbody on two bogies on held wheelsets, per symmetric half: springs by hand.
///
/// With the wheelsets held, every spring joins carbody, bogies and ground. Vertical (front and
/// rear bogie alike) and pitch (opposite) are pairs of masses; sway is four coordinates.
#[test]
fn its_rigid_body_frequencies_are_those_of_a_calculation_by_hand() {
    let (mut vehicle, table) = coach();
    for body in &mut vehicle.bodies {
        if body.rolling_radius_m.is_some() {
            body.free = [false; 5];
        }
    }
    let state = VehicleState::default();
    let stiffness = small_motions(&vehicle, &table, &state).stiffness;
    let mut found: Vec<f64> =
        stiffness.complex_eigenvalues().iter().map(|value| hertz(value.re)).collect();
    found.sort_by(f64::total_cmp);
    println!("all: {found:.4?} Hz");

    let (car_kg, bogie_kg) = (32_000.0, 2_615.0);
    let (car_roll, car_pitch) = (56_800.0, 1.97e6);
    let (bogie_roll, bogie_pitch) = (1_722.0, 1_476.0);
    let (reach_m, half_base_m, half_width_m) = (9.5, 1.28, 1.0);
    let (k1y, k1z) = (4.0 * 3.884e6, 4.0 * 1.220e6); // per bogie
    let (k2x, k2y, k2z) = (2.0 * 0.160e6, 2.0 * 0.160e6, 2.0 * 0.430e6);
    let (bar, bend) = (961.0e3, 21.0e3);
    // Arms of the secondary springs about the carbody and the bogie, of the primary about the bogie.
    let (above, below, axle) = (1.8 - 0.8275, 0.8275 - 0.6, 0.6 - 0.46);

    let bounce = two_masses([2.0 * k2z, 2.0 * k1z], [car_kg, 2.0 * bogie_kg]);
    // Coordinates: carbody pitch, both bogies up or down against each other, both bogies' pitch.
    let k1x = 4.0 * 31.391e6;
    let pitch = modes_hz(
        &[car_pitch, 2.0 * bogie_kg, 2.0 * bogie_pitch],
        &[
            (2.0 * k2z, vec![reach_m, 1.0, 0.0]),
            (2.0 * k2x, vec![above, 0.0, below]),
            (2.0 * bend, vec![1.0, 0.0, -1.0]),
            (2.0 * k1z, vec![0.0, 1.0, 0.0]),
            (2.0 * k1z * half_base_m * half_base_m, vec![0.0, 0.0, 1.0]),
            (2.0 * k1x * axle * axle, vec![0.0, 0.0, 1.0]),
        ],
    );
    // Carbody right and roll, both bogies right and roll. A point z below a centre moves right by
    // y - z roll.
    let sway = modes_hz(
        &[car_kg, car_roll, 2.0 * bogie_kg, 2.0 * bogie_roll],
        &[
            (2.0 * k2y, vec![1.0, -above, -1.0, -below]),
            (2.0 * k2z * half_width_m * half_width_m + 2.0 * bar, vec![0.0, 1.0, 0.0, -1.0]),
            (2.0 * k1y, vec![0.0, 0.0, 1.0, -axle]),
            (2.0 * k1z * half_width_m * half_width_m, vec![0.0, 0.0, 0.0, 1.0]),
        ],
    );
    for (name, by_hand) in [
        ("bounce", bounce[0]),
        ("pitch", pitch[0]),
        ("lower sway", sway[0]),
        ("upper sway", sway[1]),
    ] {
        let nearest = nearest(&found, by_hand);
        println!("{name}: by hand {by_hand:.5} Hz, vehicle {nearest:.5} Hz");
        assert!((nearest / by_hand - 1.0).abs() < 1e-5, "{name}: {by_hand} {nearest}");
    }
}

/// On its wheels, carbody bounce is lower by what the Hertz springs give way: a thousandth.
#[test]
fn on_its_wheels_the_carbody_bounces_as_on_held_wheelsets() {
    let (vehicle, table) = coach();
    let start = equilibrium::running(&vehicle, Some(&table), SPEED_M_PER_S).unwrap();
    let mut undamped = vehicle.clone();
    for element in &mut undamped.suspensions {
        element.damping_n_s_per_m = [0.0; 3];
    }
    let values = small_motions(&undamped, &table, &start.state).eigenvalues().unwrap();
    let frequencies: Vec<f64> =
        values.iter().map(|value| value.im.abs() / std::f64::consts::TAU).collect();
    let bounce = two_masses([4.0 * 0.430e6, 8.0 * 1.220e6], [32_000.0, 2.0 * 2_615.0])[0];
    let found = nearest(&frequencies, bounce);
    println!("bounce: by hand {bounce:.4} Hz, on wheels {found:.4} Hz");
    assert!(found < bounce && found > 0.998 * bounce, "{found} {bounce}");
}

#[test]
fn it_runs_over_irregular_track() {
    let (vehicle, table) = coach();
    let mut state = equilibrium::running(&vehicle, Some(&table), SPEED_M_PER_S).unwrap().state;
    let band = Band { seed: 1, shortest: 1.0, longest: 100.0, scale: 1.0 };
    let samples = aar6(&band, 0.0, 20.0 + SPEED_M_PER_S * 5.0 + 20.0);
    let irregularity = Irregularity {
        samples: &samples.samples,
        first_m: samples.first_m,
        step_m: samples.step_m,
    };
    let track = Track { layout: Layout::tangent(), irregularity };
    let running = Running {
        speed_m_per_s: Lanes([SPEED_M_PER_S]),
        track: &track,
        contact: Some(&table),
        substep_s: 0.25e-3,
    };
    state.distance_m = Lanes([15.0]);
    vehicle.start(&mut state, &running);
    let weight_n = vehicle.mass_kg() * 9.81;
    let (mut mean_n, mut lateral_m) = (0.0, 0.0f64);
    for _ in 0..5000 {
        vehicle.step(&mut state, &running, &mut (), 4);
        mean_n += carried_n(&vehicle, &state) / 5000.0;
        lateral_m = lateral_m.max(state.position[0][0].0[0].abs());
    }
    println!(
        "mean load {:.4} of the weight, carbody moves {:.1} mm",
        mean_n / weight_n,
        lateral_m * 1e3
    );
    assert!(state.is_finite());
    assert!((mean_n / weight_n - 1.0).abs() < 0.01, "{}", mean_n / weight_n);
    // The track deviates by about 10 mm; the carbody follows it and stays off its stops' end.
    assert!(lateral_m > 1e-3 && lateral_m < 0.06, "{lateral_m}");
}

fn hertz(square: f64) -> f64 {
    square.max(0.0).sqrt() / std::f64::consts::TAU
}

fn nearest(values: &[f64], wanted: f64) -> f64 {
    let distance = |value: &&f64| (**value - wanted).abs();
    *values.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap()
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
