use super::valve::{Chamber, Throttle};
use super::*;
use scenario::source::Source;
use signal::statistics::rms;
use std::f64::consts::TAU;
use std::path::Path;

fn shipped(name: &str) -> HydraulicDamper {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/dampers");
    HydraulicDamper::from_source(&Source::read(&folder.join(name)).unwrap()).unwrap()
}

/// The damper moved along x(t); every state at the end of its step.
fn moved(
    damper: &HydraulicDamper,
    x: &dyn Fn(f64) -> f64,
    step_s: f64,
    steps: usize,
) -> Vec<State> {
    let mut state = damper.at_rest(x(0.0), 0.0, 23.0);
    let mut states = vec![state];
    for step in 0..steps {
        damper.advance(&mut state, x, step as f64 * step_s, step_s, 23.0);
        states.push(state);
    }
    assert_eq!(state.unsolved, 0);
    states
}

fn sine(amplitude_m: f64, frequency_hz: f64) -> impl Fn(f64) -> f64 {
    move |t| amplitude_m * libm::sin(TAU * frequency_hz * t)
}

/// The shipped damper without dry friction, rigid, tight, without air, its gas at the pressure
/// around.
fn bare(name: &str) -> HydraulicDamper {
    let mut damper = shipped(name);
    damper.friction =
        Friction { coulomb_n: 0.0, breakaway_n: 0.0, pressed_m2: 0.0, ..damper.friction };
    damper.attachment.clearance_2a_m = 0.0;
    damper.attachment.rubber_n_per_m = 1e11;
    damper.attachment.seat_n_per_m = 1e11;
    damper.oil.air_share = 0.0;
    damper.reservoir = Reservoir { gas_m3: 1.0, gas_pa: AMBIENT_PA, exponent: 1.0 };
    damper
}

const BOTH: [&str; 2] = ["hydraulic-yaw-damper.toml", "hydraulic-yaw-damper-unidirectional.toml"];

#[test]
fn shut_off_it_is_the_spring_of_its_oil() {
    // K = beta (A1^2/V1 + A2^2/V2), at 50 bar and with air.
    let mut damper = bare(BOTH[0]);
    damper.valves.clear();
    damper.leakage.gap_m = 0.0;
    damper.oil.air_share = 0.01;
    damper.reservoir.gas_pa = 5e6;
    for at_m in [-0.05, 0.0, 0.08] {
        let states = moved(&damper, &|t| at_m + 1e-3 * t, 100e-6, 100);
        let force = states[100].force_n - states[0].force_n;
        let beta = damper.oil.at(23.0).modulus_pa(5e6);
        let [v1, v2] = damper.volumes_m3(at_m);
        let oil = beta * (damper.ring_m2().powi(2) / v1 + damper.cap_m2().powi(2) / v2);
        // Two metal springs of 1e11 N/m in series.
        let expected = 1e-5 / (1.0 / oil + 2.0 / 1e11);
        assert!((force / expected - 1.0).abs() < 0.005, "{at_m}: {force} and {expected}");
    }
}

#[test]
fn at_constant_speed_the_force_is_that_of_the_orifice() {
    // Unidirectional flow through one hole: dp = rho/2 (A v/(Cd A_0))^2, on the ring out, on the
    // rod in.
    let mut damper = bare(BOTH[1]);
    damper.leakage.gap_m = 0.0;
    damper.valves.retain(|valve| {
        matches!(valve.throttle, Throttle::Orifice { .. } | Throttle::Check { .. })
    });
    let density = damper.oil.at(23.0).density_kg_per_m3;
    for (v, area) in [(0.012, damper.ring_m2()), (-0.012, damper.rod_m2())] {
        let last = *moved(&damper, &|t| v * t, 200e-6, 25_000).last().unwrap();
        let dp = 0.5 * density * (area * v / (0.7 * 0.26e-6)).powi(2);
        let expected = libm::copysign(area * dp, v);
        let ratio = last.force_n / expected;
        // Checks and the density under pressure take a percent.
        assert!((ratio - 1.0).abs() < 0.012, "{v}: {} and {expected}", last.force_n);
    }
}

#[test]
fn beyond_relief_the_force_is_the_set_pressure_and_little_more() {
    let damper = bare(BOTH[0]);
    for (v, set_n) in [(0.03, 5.4e6 * damper.ring_m2()), (-0.03, 4.2e6 * damper.cap_m2())] {
        let last = *moved(&damper, &|t| v * t, 200e-6, 15_000).last().unwrap();
        let over = last.force_n.abs() / set_n;
        assert!((1.0..1.08).contains(&over), "{v}: {} over {set_n}", last.force_n);
    }
}

#[test]
fn at_rest_the_gas_pushes_the_rod_out_along_its_polytrope() {
    let damper = shipped(BOTH[0]);
    for at_m in [-0.04, 0.0, 0.04] {
        let state = damper.at_rest(at_m, 0.0, 23.0);
        let gas_m3 = damper.reservoir.gas_m3 + damper.rod_m2() * state.piston_m;
        let pressure = 300e3 * libm::pow(damper.reservoir.gas_m3 / gas_m3, 1.2);
        let expected = -damper.rod_m2() * (pressure - AMBIENT_PA);
        assert!((state.force_n - expected).abs() < 0.1, "{at_m}: {} {expected}", state.force_n);
        // And there it stays.
        let held = *moved(&damper, &|_| at_m, 100e-6, 20_000).last().unwrap();
        assert!((held.force_n - expected).abs() < 2.0, "{at_m}: {} {expected}", held.force_n);
    }
}

#[test]
fn oil_is_kept_and_the_work_of_a_cycle_becomes_heat() {
    for name in BOTH {
        let damper = shipped(name);
        let (x, step_s, period) = (sine(3.46e-3, 3.5), 1.0 / 3.5 / 5000.0, 5000);
        let states = moved(&damper, &x, step_s, 8 * period);
        let oil = |s: &State| s.rod_oil_m3 + s.cap_oil_m3 - s.gas_m3;
        let (first, last) = (oil(&states[0]), oil(&states[8 * period]));
        assert!((last - first).abs() < 1e-14, "{name}: {first} {last}");
        // The eye feels the rod's inertia on top of the body's force.
        let work: f64 = (7 * period..8 * period)
            .map(|n| {
                let way = x((n + 1) as f64 * step_s) - x(n as f64 * step_s);
                let gained = states[n + 1].piston_m_per_s - states[n].piston_m_per_s;
                let mean_n = 0.5 * (states[n].force_n + states[n + 1].force_n);
                (mean_n + damper.moving_kg * gained / step_s) * way
            })
            .sum();
        let heat = states[8 * period].heat_j - states[7 * period].heat_j;
        println!("{name}: work {work:.3} J, heat {heat:.3} J");
        assert!((work / heat - 1.0).abs() < 0.01, "{name}: work {work} heat {heat}");
        // It warms the oil by what is not cooled away.
        let warmed = (states[8 * period].oil_degc - 23.0) * 21e3;
        assert!((warmed / states[8 * period].heat_j - 1.0).abs() < 1e-3, "{name}");
    }
}

#[test]
fn without_refill_a_chamber_boils_and_its_void_must_close_first() {
    let mut damper = bare(BOTH[0]);
    damper.valves.retain(|valve| !matches!(valve.throttle, Throttle::Check { .. }));
    damper.valves.retain(|valve| valve.to != Chamber::Reservoir);
    let states = moved(&damper, &sine(10e-3, 1.0), 100e-6, 10_000);
    let least = states.iter().map(|s| s.pressures_pa[1]).fold(f64::MAX, f64::min);
    assert_eq!(least, damper.oil.vapour_pa);
    let empty = &states[2_500];
    // The cap side has grown by A2 x, the piston let A1 x through; the rod's A_r x is void, and
    // what the pressure has pressed together on the rod side.
    let void_m3 = empty.voids[1] * damper.volumes_m3(empty.piston_m)[1];
    let squeezed_m3 = damper.volumes_m3(empty.piston_m)[0] - empty.rod_oil_m3;
    let expected = damper.rod_m2() * empty.piston_m - squeezed_m3;
    assert!((void_m3 / expected - 1.0).abs() < 0.01, "{void_m3} and {expected}");
    // On the way back there is no pressure until the void has closed.
    for state in &states[2_600..5_000] {
        assert!(state.voids[1] == 0.0 || state.pressures_pa[1] == damper.oil.vapour_pa);
        assert!(state.voids[1] == 0.0 || state.force_n > -1.5e3, "{}", state.force_n);
    }
}

#[test]
fn equal_areas_give_equal_forces_both_ways_but_not_equal_stiffness() {
    let damper = shipped(BOTH[1]);
    assert!((damper.ring_m2() / damper.rod_m2() - 1.0).abs() < 1e-9);
    for v in [0.005, 0.03, 0.1] {
        let steps = (0.05 / v / 200e-6) as usize;
        let out = moved(&damper, &|t| v * t, 200e-6, steps).last().unwrap().force_n;
        let back = moved(&damper, &|t| -v * t, 200e-6, steps).last().unwrap().force_n;
        // The gas pushes the same way in both.
        let preload = damper.at_rest(0.0, 0.0, 23.0).force_n;
        let ratio = (out - preload) / (preload - back);
        assert!((ratio - 1.0).abs() < 0.06, "{v}: {out} {back}");
    }
    let stiffness = |sign: f64| {
        let states = moved(&bare(BOTH[1]), &|t| sign * 0.5 * t, 20e-6, 100);
        (states[100].force_n - states[0].force_n).abs() / 1e-3
    };
    let ratio = stiffness(1.0) / stiffness(-1.0);
    assert!((1.8..3.5).contains(&ratio), "extension over compression: {ratio}");
}

#[test]
fn smaller_steps_converge() {
    for name in BOTH {
        let damper = shipped(name);
        let x = sine(3.46e-3, 3.5);
        let force = |step_s: f64, every: usize| -> Vec<f64> {
            let states = moved(&damper, &x, step_s, 4000 * every);
            states.iter().step_by(every).map(|state| state.force_n).collect()
        };
        let reference = force(12.5e-6, 16);
        let mut shares = Vec::new();
        for (step_s, every) in [(200e-6, 1), (100e-6, 2), (50e-6, 4)] {
            let difference: Vec<f64> =
                force(step_s, every).iter().zip(&reference).map(|(a, b)| a - b).collect();
            shares.push(rms(&difference) / rms(&reference));
        }
        println!("{name}: 200, 100, 50 us off by {shares:?} of rms force");
        assert!(shares[2] < 1e-3 && shares[2] < 0.4 * shares[0], "{name}: {shares:?}");
    }
}

#[test]
fn reduced_it_is_a_yaw_damper_of_its_class() {
    for name in BOTH {
        let damper = shipped(name);
        // Relief: where the steady force leaves its steep rise; both directions.
        for sign in [1.0, -1.0] {
            let steady = |v: f64| {
                let steps = (0.05 / v / 200e-6) as usize;
                moved(&damper, &|t| sign * v * t, 200e-6, steps).last().unwrap().force_n.abs()
            };
            let (low, high) = (steady(0.04), steady(0.08));
            let slope = (high - low) / 0.04;
            let relief_n = low - 0.04 * slope;
            println!(
                "{name} {sign}: relief {relief_n:.0} N, C2 {slope:.0} N s/m, 15 mm/s {:.0} N",
                steady(0.015)
            );
            assert!((14e3..18e3).contains(&relief_n), "{name} {sign}: {relief_n}");
        }
        // Stiffness: the in-phase part of the first harmonic at 1 mm and 8 Hz.
        let (x, step_s, period) = (sine(1e-3, 8.0), 1.0 / 8.0 / 2500.0, 2500);
        let states = moved(&damper, &x, step_s, 12 * period);
        let in_phase: f64 = (11 * period..12 * period)
            .map(|n| 2.0 * states[n].force_n * x(n as f64 * step_s) / (1e-6 * period as f64))
            .sum();
        println!("{name}: K' {:.2} MN/m", in_phase * 1e-6);
        assert!((6e6..13e6).contains(&in_phase), "{name}: {in_phase}");
    }
}

#[test]
fn motions_far_beyond_any_use_are_solved_too() {
    for name in BOTH {
        let mut damper = shipped(name);
        for (air_share, viscosity_pa_s) in [(0.005, 0.019), (0.0, 2.0), (0.05, 1e-3)] {
            damper.oil.air_share = air_share;
            damper.oil.viscosity_pa_s = viscosity_pa_s;
            for (amplitude_m, frequency_hz) in
                [(20e-3, 20.0), (2e-6, 20.0), (0.109, 1.0), (1e-3, 150.0)]
            {
                let states = moved(&damper, &sine(amplitude_m, frequency_hz), 50e-6, 4_000);
                assert!(states.iter().all(|state| state.force_n.is_finite()));
            }
        }
    }
}
