//! Directions: what is left, what is right, and what pushes where.
//!
//! x forward, y right, z down. Signs are easy to get wrong in pairs, so each is tested by what it
//! must do to a vehicle. Left against right as a whole: `evidence/src/validation/symmetry.rs`.

use super::contact_sweep::under_load;
use super::locomotive::{
    Modelled, axle_force_n, carried_n, dampers, scenario, scenario_from, table,
};
use firmware_core::lanes::Lanes;
use firmware_core::track::{Layout, Track};
use firmware_core::vehicle::{DamperForces, LATERAL, ROLL, Running, VERTICAL, YAW};
use firmware_core::wheel_rail::wheel::Wheel;
use scenario::run::Run;

const SUBSTEP_S: f64 = 0.25e-3;
const BOGIE_FRONT: usize = 1;
const WHEELSET_3: usize = 5;

fn running<'a>(run: &'a Run, track: &'a Track<'a>, speed_m_per_s: f64) -> Running<'a> {
    Running {
        speed_m_per_s: Lanes([speed_m_per_s]),
        tracks: [track],
        contact: Some(table(run)),
        substep_s: SUBSTEP_S,
    }
}

/// A transition from 40 m on into a curve; positive to the right.
fn curve(radius_m: f64, cant_rad: f64, transition_m: f64) -> Layout {
    let mut layout = Layout::tangent();
    layout.hold(40.0).unwrap();
    layout.ramp(transition_m, 1.0 / radius_m, cant_rad, 6.0).unwrap();
    layout
}

#[test]
fn cant_deficiency_loads_the_outer_rail_and_leans_the_body_outward() {
    let run = scenario("ss9-curve-400m.toml");
    let (radius_m, cant_m) = (400.0, 0.12);
    let track = Track { layout: curve(radius_m, cant_m / 1.5, 80.0), ..Track::default() };
    let running = running(&run, &track, run.speed_m_per_s);
    let mut modelled = Modelled::new(dampers(&run).into_iter().map(|damper| [damper]).collect());
    let mut state = run.start.state.clone();
    run.vehicle.start(&mut state, &running);
    let seconds = |s: f64| libm::round(s / SUBSTEP_S) as u32;
    run.vehicle.step(&mut state, &running, &mut modelled, seconds(25.0));
    // In the full curve the wheels carry m a to the right: a = v2/R - g h / 1.5.
    let excess = run.speed_m_per_s * run.speed_m_per_s / radius_m - 9.81 * cant_m / 1.5;
    let (mut lateral_n, mut load_n) = (0.0, [0.0; 2]);
    for axle in 0..6 {
        lateral_n += axle_force_n(&state, axle);
        for (sum, [wheel]) in load_n.iter_mut().zip(&state.wheels[axle]) {
            *sum -= wheel.vertical_n;
        }
    }
    let mass_kg = run.vehicle.mass_kg();
    println!("a {excess:.4} m/s2; sum Y {lateral_n:.1} N, m a {:.1} N", mass_kg * excess);
    println!("left {:.1} kN, right {:.1} kN", load_n[0] / 1e3, load_n[1] / 1e3);
    assert!((lateral_n / (mass_kg * excess) - 1.0).abs() < 0.01, "{lateral_n}");
    // The left rail is the outer one of a right-hand curve.
    assert!(load_n[0] > 1.03 * load_n[1], "{load_n:?}");
    // Moments about the track centre: what the excess puts on the outer rail; that the outer wheels
    // touch nearer to the middle, at their flanges, adds to it.
    let moment: f64 =
        run.vehicle.bodies.iter().map(|b| b.mass_kg * b.height_m).sum::<f64>() * excess;
    let expected_n = moment / 0.7465;
    let transfer_n = load_n[0] - load_n[1];
    println!("load transfer {transfer_n:.0} N, rigid {expected_n:.0} N");
    assert!(transfer_n > 0.95 * expected_n && transfer_n < 1.4 * expected_n);
    // Outward is left. The body hangs over its bogies: their chord lies inside the arc by l2/2R,
    // and the secondary springs give way to the left by m a / k, more by what the body rolls.
    let right = |body: usize| state.position[body][LATERAL].0[0];
    let chord_m = 5.39 * 5.39 / (2.0 * radius_m);
    let bogies_m = 0.5 * (right(1) + right(2)) + chord_m;
    let lean_m = bogies_m - right(0);
    let springs_m = 65_440.0 * excess / (4.0 * 0.426e6);
    println!(
        "carbody {:.2} mm left of its bogies, springs {:.2} mm",
        lean_m * 1e3,
        springs_m * 1e3
    );
    assert!(lean_m > springs_m && lean_m < 2.0 * springs_m, "{lean_m} {springs_m}");
    assert!(state.position[0][ROLL].0[0] < 0.0, "it rolls to the left");
    // The vertical share of centripetal force on canted track is all that the rails carry beyond
    // the weight.
    assert!((carried_n(&run.vehicle, &state) / (mass_kg * 9.81) - 1.0).abs() < 0.02);
}

#[test]
fn gravity_pushes_a_shifted_wheelset_back() {
    let run = scenario("ss9-160kmh.toml");
    let smooth = Wheel { friction: 0.0, ..run.vehicle.axles[0].wheel };
    let mut last_n = 0.0;
    for shift_mm in 1..=8 {
        // To the right, both wheels under their load: the right wheel outward, the left one inward.
        let shift_m = 1e-3 * f64::from(shift_mm);
        let [left, right] =
            [-shift_m, shift_m].map(|shift| under_load(&smooth, table(&run), shift).lateral_n);
        let force_n = right - left;
        println!("{shift_mm} mm right: {force_n:.0} N");
        assert!(force_n < last_n, "{shift_mm} mm: {force_n} N");
        last_n = force_n;
    }
}

/// A dashpot in every slot.
struct Dashpots(f64);

impl DamperForces for Dashpots {
    fn force_n(&mut self, _: usize, _: usize, _: f64, rate_m_per_s: f64, _: f64) -> f64 {
        self.0 * rate_m_per_s
    }
}

#[test]
fn a_yaw_damper_opposes_yaw_between_bogie_and_body() {
    let run = scenario("ss9-160kmh.toml");
    let track = Track::default();
    let running = running(&run, &track, 40.0);
    let (rate, damping) = (0.05, 1.0e6);
    let yaw_accelerations = |dashpots: Dashpots| {
        let mut state = run.start.state.clone();
        state.half_velocity[BOGIE_FRONT][YAW] = Lanes([rate]);
        let mut dashpots = dashpots;
        run.vehicle.evaluate(&mut state, &running, &mut dashpots);
        let of = |body: usize| state.acceleration[body][YAW].0[0];
        (of(BOGIE_FRONT), of(0), state.extension_m_per_s.map(|r| r.0[0]))
    };
    let (bogie, body, extension) = yaw_accelerations(Dashpots(damping));
    let (free_bogie, free_body, _) = yaw_accelerations(Dashpots(0.0));
    // Two dampers 1.40 m from the middle: moment 2 c b2 psi'.
    let moment_n_m = 2.0 * damping * 1.4 * 1.4 * rate;
    let close = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-9;
    assert!(close(bogie - free_bogie, -moment_n_m / 78_243.0), "{}", bogie - free_bogie);
    assert!(close(body - free_body, moment_n_m / 1.773e6), "{}", body - free_body);
    // A bogie that turns right pushes its left eye forward, away from that on the body: extension.
    println!("extension rates {extension:?}");
    assert!(close(extension[0], 1.4 * rate) && close(extension[1], -1.4 * rate));
    assert!(extension[2].abs() < 1e-12 && extension[3].abs() < 1e-12, "{extension:?}");
}

#[test]
fn a_lifted_wheel_carries_nothing_and_comes_down_again() {
    let run = scenario_from(
        "title = \"hop\"\nvehicle = \"vehicles/ss9.toml\"\nspeed_kmh = 120.0\nduration_s = 1.0\n",
    );
    let track = Track::default();
    let running = running(&run, &track, run.speed_m_per_s);
    let mut state = run.start.state.clone();
    state.position[WHEELSET_3][VERTICAL] = Lanes([-10e-3]);
    let mut lifted = state.clone();
    run.vehicle.evaluate(&mut lifted, &running, &mut ());
    for [wheel] in &lifted.wheels[2] {
        assert_eq!(*wheel, firmware_core::wheel_rail::wheel::WheelForce::default());
    }
    run.vehicle.start(&mut state, &running);
    let (mut in_the_air, mut landed_n) = (0, 0.0);
    for _ in 0..12_000 {
        run.vehicle.step(&mut state, &running, &mut (), 1);
        assert!(state.is_finite());
        let load_n = -state.wheels[2][0][0].vertical_n;
        in_the_air += u32::from(load_n == 0.0);
        landed_n = load_n;
    }
    println!("in the air for {:.1} ms", f64::from(in_the_air) * SUBSTEP_S * 1e3);
    assert!(in_the_air > 0);
    assert!((landed_n / 103.0e3 - 1.0).abs() < 0.05, "{landed_n}");
}
