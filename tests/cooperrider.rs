//! Cooperrider's bogie from its data file meets the numbers of the literature.
//!
//! The eigenvalues of the seven-degree-of-freedom bogie, its Hopf point and its limit cycle are among
//! the best known numbers of railway dynamics. They pass through the very elements, creep law and
//! time step that the locomotive uses.

#![expect(clippy::unwrap_used, reason = "a test stops where it fails")]

use firmware_core::lanes::Lanes;
use firmware_core::track::Track;
use firmware_core::vehicle::{LATERAL, Running, Vehicle, VehicleState};
use scenario::source::Source;
use scenario::vehicle::VehicleFile;
use std::path::Path;
use studies::critical_speed::fold::{Fold, Point};
use studies::critical_speed::{Critical, Procedure};
use studies::modes::{Coordinate, Impedances, Jacobians};
use studies::statistics;
use studies::trip::Equipped;

fn bogie() -> Vehicle {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/vehicles/cooperrider-bogie.toml");
    let source = Source::read(&path).unwrap();
    source.parse::<VehicleFile>().unwrap().build(&source).unwrap()
}

/// Real and imaginary part of the least damped eigenvalue (1/s).
fn least_damped(vehicle: &Vehicle, speed_m_per_s: f64) -> (f64, f64) {
    let (state, bodies) = (VehicleState::default(), Coordinate::of_bodies(vehicle));
    let at = (&state, speed_m_per_s);
    let values = Jacobians::about(vehicle, None, at, Impedances::default(), &bodies);
    let values = values.eigenvalues().unwrap();
    (values[0].re, values[0].im.abs())
}

#[test]
fn the_file_describes_seven_degrees_of_freedom() {
    assert_eq!(bogie().degrees_of_freedom(), 7);
}

#[test]
fn the_least_damped_eigenvalues_meet_an_independent_solution() {
    // Written out by hand from Kaas-Petersen's equations and solved apart from this code.
    let anchors = [
        (20.0, -1.254_563_37, 7.567_418_13),
        (40.0, -1.813_920_27, 15.116_590_07),
        (60.0, -0.964_091_81, 22.332_837_59),
        (80.0, 1.682_577_31, 27.923_351_89),
    ];
    let vehicle = bogie();
    for (speed, real, imaginary) in anchors {
        let (re, im) = least_damped(&vehicle, speed);
        println!("{speed} m/s: {re:.8} +- {im:.8} i");
        assert!((re - real).abs() < 1e-5, "{speed} m/s: {re}");
        assert!((im - imaginary).abs() < 1e-5, "{speed} m/s: {im}");
    }
}

#[test]
fn the_hopf_point_is_the_published_one() {
    // Published: 68.66 m/s.
    let vehicle = bogie();
    let (mut stable, mut unstable) = (60.0, 80.0);
    while unstable - stable > 1e-4 {
        let middle = 0.5 * (stable + unstable);
        if least_damped(&vehicle, middle).0 < 0.0 {
            stable = middle;
        } else {
            unstable = middle;
        }
    }
    let (_, im) = least_damped(&vehicle, stable);
    println!("Hopf point {stable:.4} m/s, {:.4} Hz", im / std::f64::consts::TAU);
    assert!((stable - 68.666).abs() < 1e-3, "{stable}");
    assert!((stable - 68.66).abs() < 0.01, "{stable}");
}

/// Amplitude of the first wheelset (m) and frequency (Hz) of the limit cycle, by time steps.
fn limit_cycle(vehicle: &Vehicle, speed_m_per_s: f64, substep_s: f64) -> (f64, f64) {
    let track = Track::default();
    let running =
        Running { speed_m_per_s: Lanes([speed_m_per_s]), track: &track, contact: None, substep_s };
    let mut state = VehicleState::<1>::default();
    state.position[1][LATERAL] = Lanes([0.010]);
    vehicle.start(&mut state, &running);
    let steps = |seconds: f64| libm::round(seconds / substep_s) as u32;
    for _ in 0..steps(60.0) {
        vehicle.step(&mut state, &running, &mut (), 1);
    }
    let mut shift_m = Vec::new();
    for _ in 0..steps(5.0) {
        vehicle.step(&mut state, &running, &mut (), 1);
        shift_m.push(state.position[1][LATERAL].0[0]);
    }
    let amplitude_m = statistics::mean_peak(&shift_m, 1e-3).unwrap();
    let frequency_hz = statistics::zero_crossing_hz(&shift_m, 1.0 / substep_s, 1e-3).unwrap();
    (amplitude_m, frequency_hz)
}

#[test]
fn the_limit_cycle_has_the_known_amplitude_and_frequency() {
    // At 70 m/s, by Runge-Kutta steps of 20 us apart from this code: 10.187 mm, 3.983 Hz.
    let vehicle = bogie();
    let (fine_m, fine_hz) = limit_cycle(&vehicle, 70.0, 0.25e-3);
    let (coarse_m, coarse_hz) = limit_cycle(&vehicle, 70.0, 0.5e-3);
    println!("0.25 ms: {:.4} mm, {fine_hz:.4} Hz", fine_m * 1e3);
    println!("0.5 ms: {:.4} mm, {coarse_hz:.4} Hz", coarse_m * 1e3);
    // Halving the step moves the amplitude by 0.8 um: a third of that is left in the finer run.
    assert!((fine_m - coarse_m).abs() < 2e-6, "{fine_m} {coarse_m}");
    assert!((fine_m - 10.187e-3).abs() < 3e-6, "{fine_m}");
    assert!((fine_hz - 3.983).abs() < 1e-3, "{fine_hz}");
}

#[test]
fn its_limit_cycle_dies_at_the_known_fold() {
    // By an independent integration, 60 s at each speed: between 66.68 and 66.70 m/s.
    let bogie = Equipped { vehicle: bogie(), contact: None, dampers: Vec::new() };
    let procedure = Procedure {
        from_kmh: 230.0,
        to_kmh: 252.0,
        step_kmh: 2.0,
        resolution_kmh: 0.02,
        hold_s: 60.0,
        ..Procedure::default()
    };
    let fold = Fold::of(&bogie, &procedure).unwrap();
    let Critical::At(dies_kmh) = fold.dies else { panic!("{}", fold.dies) };
    let last = fold.cycle.last().unwrap().motion;
    let (speed, amplitude_mm) = (dies_kmh / 3.6, 1e3 * last.amplitude_m.unwrap());
    println!("dies at {speed:.4} m/s with {amplitude_mm:.3} mm, {:?} Hz", last.frequency_hz);
    // A descent in steps of 0.02 km/h ends up to that far above the fold.
    assert!((66.68..66.71).contains(&speed), "{speed}");
    // At 67 m/s the cycle has 9.478 mm, growing by 0.258 mm per m/s.
    let off = |point: &&Point| (point.kmh / 3.6 - 67.0).abs();
    let near = fold.cycle.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
    let amplitude_mm = 1e3 * near.motion.amplitude_m.unwrap();
    let expected_mm = 9.478 + 0.258 * (near.kmh / 3.6 - 67.0);
    println!("{:.3} m/s: {amplitude_mm:.3} mm, expected {expected_mm:.3}", near.kmh / 3.6);
    assert!((amplitude_mm - expected_mm).abs() < 0.01, "{amplitude_mm} {expected_mm}");
}
