//! Vehicles side by side in lanes are the very same vehicles.

use super::locomotive::{Modelled, scenario, table};
use firmware_core::damper::{Damper, Nominal};
use firmware_core::lanes::Lanes;
use firmware_core::vehicle::{DAMPER_SLOTS, Running, VehicleState};
use scenario::equilibrium;
use scenario::run::Run;

const SUBSTEP_S: f64 = 0.25e-3;
const SPEEDS_M_PER_S: [f64; 2] = [160.0 / 3.6, 201.0 / 3.6];

fn damper(lane: usize) -> Damper {
    let nominal = match lane {
        0 => Nominal::NEW,
        _ => Nominal { clearance_2a_m: 4.0e-3, ke_n_per_m: 6.0e6, ..Nominal::NEW },
    };
    Damper::new(nominal, &[]).unwrap().prepared(SUBSTEP_S)
}

fn start(run: &Run, speed_m_per_s: f64) -> VehicleState {
    let mut state =
        equilibrium::running(&run.vehicle, Some(table(run)), speed_m_per_s).unwrap().state;
    state.distance_m = run.start.state.distance_m;
    state
}

fn advance<const L: usize>(
    run: &Run,
    state: &mut VehicleState<L>,
    speed_m_per_s: [f64; L],
    dampers: [Damper; L],
) {
    let track = run.track.view();
    let running = Running {
        speed_m_per_s: Lanes(speed_m_per_s),
        tracks: [&track; L],
        contact: Some(table(run)),
        substep_s: SUBSTEP_S,
    };
    let mut modelled = Modelled::new(vec![dampers; DAMPER_SLOTS]);
    run.vehicle.start(state, &running);
    run.vehicle.step(state, &running, &mut modelled, 8000);
}

/// Puts two states side by side.
fn side_by_side(first: &VehicleState, second: &VehicleState) -> VehicleState<2> {
    let mut both = VehicleState::<2>::default();
    let pair = |a: &Lanes<1>, b: &Lanes<1>| Lanes([a.0[0], b.0[0]]);
    both.distance_m = pair(&first.distance_m, &second.distance_m);
    for body in 0..both.position.len() {
        for c in 0..5 {
            both.position[body][c] = pair(&first.position[body][c], &second.position[body][c]);
            both.half_velocity[body][c] =
                pair(&first.half_velocity[body][c], &second.half_velocity[body][c]);
        }
    }
    for axle in 0..both.rail_position.len() {
        for side in 0..2 {
            for c in 0..2 {
                both.rail_position[axle][side][c] =
                    pair(&first.rail_position[axle][side][c], &second.rail_position[axle][side][c]);
            }
        }
    }
    both
}

#[test]
#[expect(clippy::large_stack_arrays, reason = "two dampers side by side, once")]
fn two_lanes_give_the_bits_of_two_runs() {
    let run = scenario("ss9-160kmh.toml");
    let starts = SPEEDS_M_PER_S.map(|speed| start(&run, speed));
    let mut both = side_by_side(&starts[0], &starts[1]);
    advance(&run, &mut both, SPEEDS_M_PER_S, [damper(0), damper(1)]);
    for (lane, mut single) in starts.into_iter().enumerate() {
        let speed = [SPEEDS_M_PER_S[lane]];
        advance(&run, &mut single, speed, [damper(lane)]);
        let same = |a: &Lanes<1>, b: &Lanes<2>| a.0[0].to_bits() == b.0[lane].to_bits();
        assert!(same(&single.distance_m, &both.distance_m));
        let moving = |state: &VehicleState| state.position[0][0].0[0];
        assert!(moving(&single).abs() > 1e-5, "lane {lane} stands still");
        for (a, b) in single.position.iter().flatten().zip(both.position.iter().flatten()) {
            assert!(same(a, b), "lane {lane}: {a:?} {b:?}");
        }
        for (a, b) in single.half_velocity.iter().flatten().zip(both.half_velocity.iter().flatten())
        {
            assert!(same(a, b), "lane {lane}: {a:?} {b:?}");
        }
        for (a, b) in single.damper_n.iter().zip(&both.damper_n) {
            assert!(same(a, b), "lane {lane}: {a:?} {b:?}");
        }
        for (a, b) in single.wheels.iter().flatten().zip(both.wheels.iter().flatten()) {
            assert_eq!(a[0], b[lane], "lane {lane}");
        }
    }
}
