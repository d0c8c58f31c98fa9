//! The SS9 stands still, and runs steadily on perfect track, to the last few digits.
//!
//! The study accepted 7.568e-5 m/s2.

use super::locomotive::{carried_n, scenario, table};
use firmware_core::vehicle::{LATERAL, VERTICAL, VehicleState};
use scenario::equilibrium;
use scenario::run::Run;

const GRAVITY: f64 = 9.81;

#[test]
fn nothing_accelerates_at_rest_or_at_160_kmh() {
    let run = scenario("ss9-160kmh.toml");
    let rest = equilibrium::at_rest(&run.vehicle, Some(table(&run))).unwrap();
    println!("at rest {:.2e} m/s2", rest.residual_m_per_s2);
    println!("at 160 km/h {:.2e} m/s2", run.start.residual_m_per_s2);
    assert!(rest.residual_m_per_s2 < 1e-8, "{}", rest.residual_m_per_s2);
    assert!(run.start.residual_m_per_s2 < 1e-8, "{}", run.start.residual_m_per_s2);
    assert_eq!(run.vehicle.degrees_of_freedom(), 45);
    for state in [&rest.state, &run.start.state] {
        every_wheel_carries_a_twelfth(&run, state);
        left_and_right_are_alike(&run, state);
        springs_are_compressed_as_the_closed_form_says(&run, state);
    }
}

fn every_wheel_carries_a_twelfth(run: &Run, state: &VehicleState) {
    // 126 t on twelve wheels: 103.0 kN.
    let expected_n = 126.0e3 * GRAVITY / 12.0;
    for wheel in state.wheels.iter().take(6).flatten().flatten() {
        assert!((-wheel.vertical_n - expected_n).abs() < 20.0, "{wheel:?}");
    }
    assert!((carried_n(&run.vehicle, state) / (12.0 * expected_n) - 1.0).abs() < 1e-10);
}

fn left_and_right_are_alike(run: &Run, state: &VehicleState) {
    for [[left], [right]] in state.wheels.iter().take(6) {
        assert!((left.vertical_n - right.vertical_n).abs() < 1e-3, "{left:?} {right:?}");
        assert!((left.lateral_n - right.lateral_n).abs() < 1e-3, "{left:?} {right:?}");
    }
    for pose in state.position.iter().take(run.vehicle.bodies.len()) {
        assert!(pose[LATERAL].0[0].abs() < 1e-9, "{pose:?}");
    }
}

/// Weight above a stage of springs over their stiffness; numbers from the vehicle file.
fn springs_are_compressed_as_the_closed_form_says(_: &Run, state: &VehicleState) {
    let down = |body: usize| state.position[body][VERTICAL].0[0];
    let secondary_m = 65_440.0 * GRAVITY / (4.0 * 1.596e6);
    let primary_m = (65_440.0 + 2.0 * 20_563.0) * GRAVITY / (12.0 * 2.15e6);
    let rail_m = 126.0e3 * GRAVITY / 12.0 / 81.0e6;
    let bogies_m = 0.5 * (down(1) + down(2));
    let wheelsets_m = (3..9).map(down).sum::<f64>() / 6.0;
    let rail =
        state.rail_position.iter().take(6).flatten().map(|at| at[1].0[0]).sum::<f64>() / 12.0;
    println!("carbody sags {:.3} mm", down(0) * 1e3);
    assert!(
        (down(0) - bogies_m - secondary_m).abs() < 1e-9,
        "{} {secondary_m}",
        down(0) - bogies_m
    );
    assert!((bogies_m - wheelsets_m - primary_m).abs() < 1e-9, "{}", bogies_m - wheelsets_m);
    assert!((rail - rail_m).abs() < 1e-9, "{rail} {rail_m}");
}
