//! The Manchester coach from its data file: another vehicle without code of its own.
//!
//! It runs over irregular track; how it stands and vibrates is in
//! `evidence/src/validation/coach.rs`.

use firmware_core::lanes::Lanes;
use firmware_core::track::{Layout, Track};
use firmware_core::vehicle::{Running, Vehicle, VehicleState};
use firmware_core::wheel_rail::table::ContactTable;
use scenario::equilibrium;
use scenario::irregularity::{Band, aar6};
use scenario::source::Source;
use scenario::vehicle::VehicleFile;
use std::path::Path;
use std::sync::Arc;

const SPEED_M_PER_S: f64 = 160.0 / 3.6;

fn coach() -> (Vehicle, Arc<ContactTable>) {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/vehicles/manchester-coach.toml");
    let source = Source::read(&path).unwrap();
    let file: VehicleFile = source.parse().unwrap();
    let contact = file.wheel_rail.contact(&source).unwrap().unwrap();
    (file.build(&source).unwrap(), contact.table)
}

/// Sum of the vertical forces on all wheels (N), up positive.
fn carried_n(vehicle: &Vehicle, state: &VehicleState) -> f64 {
    let wheels = state.wheels.iter().take(vehicle.axles.len()).flatten().flatten();
    wheels.map(|wheel| -wheel.vertical_n).sum()
}

#[test]
fn it_runs_over_irregular_track() {
    let (vehicle, table) = coach();
    let mut state = equilibrium::running(&vehicle, Some(&table), SPEED_M_PER_S).unwrap().state;
    let band = Band { seed: 1, shortest: 1.0, longest: 100.0, scale: 1.0 };
    let samples = aar6(&band, 0.0, 20.0 + SPEED_M_PER_S * 5.0 + 20.0);
    let track = Track { layout: Layout::tangent(), irregularity: samples.view() };
    let running = Running {
        speed_m_per_s: Lanes([SPEED_M_PER_S]),
        tracks: [&track],
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
