//! What comes to rest stays as fast as what moves: nothing decays into subnormal numbers.
//!
//! A number below 2.2e-308 has fewer digits and takes many processors a hundred times as long. A
//! force behind a spring and a dashpot halves every fraction of a second and would be there within
//! a minute or two, if it were not for the last digits of what it is added to.

use super::locomotive::{Modelled, dampers, scenario, table};
use firmware_core::damper::effects::CATALOGUE;
use firmware_core::damper::{Damper, DamperState, Effect, Motion, Nominal};
use firmware_core::lanes::Lanes;
use firmware_core::track::{Irregularity, Layout, Track};
use firmware_core::vehicle::{LATERAL, Running};
use scenario::equilibrium;
use std::fmt::Debug;

const SUBSTEP_S: f64 = 0.25e-3;
const SUBSTEPS_PER_CYCLE: u32 = 4;

#[test]
fn nothing_in_a_locomotive_becomes_subnormal_in_five_minutes() {
    comes_to_rest(160.0, 300_000);
}

#[test]
#[ignore = "minutes; `cargo xtask ci --full` runs it"]
fn nothing_in_a_locomotive_becomes_subnormal_in_ten_million_steps() {
    comes_to_rest(160.0, 10_000_000);
    // The slowest that four substeps allow.
    comes_to_rest(90.0, 10_000_000);
}

/// A locomotive that is pushed aside by 3 mm on perfect track.
fn comes_to_rest(speed_kmh: f64, cycles: u32) {
    const LOOK_CYCLES: u32 = 10_000;
    let run = scenario("ss9-160kmh.toml");
    let irregularity =
        Irregularity { samples: &[], before: 0, behind: 0, first_m: 0.0, step_m: 1.0 };
    let track = Track { layout: Layout::tangent(), irregularity };
    let speed_m_per_s = speed_kmh / 3.6;
    let found = equilibrium::running(&run.vehicle, Some(table(&run)), speed_m_per_s);
    let mut state = found.unwrap().state;
    for pose in state.position.iter_mut().take(run.vehicle.bodies.len()) {
        pose[LATERAL].0[0] += 3e-3;
    }
    let running = Running {
        speed_m_per_s: Lanes([speed_m_per_s]),
        tracks: [&track],
        contact: Some(table(&run)),
        substep_s: SUBSTEP_S,
    };
    let mounted = dampers(&run).into_iter().map(|damper| [damper.prepared(SUBSTEP_S)]);
    let mut mounted = Modelled::new(mounted.collect());
    run.vehicle.start(&mut state, &running);
    for look in 0..cycles / LOOK_CYCLES {
        let substeps = LOOK_CYCLES * SUBSTEPS_PER_CYCLE;
        run.vehicle.step(&mut state, &running, &mut mounted, substeps);
        let small = [subnormal(&state), subnormal(&mounted.states)].concat();
        let time_s = f64::from((look + 1) * LOOK_CYCLES) * 1e-3;
        assert!(small.is_empty(), "{speed_kmh} km/h, {time_s} s: {small:?}");
    }
    let aside = state.position.iter().map(|pose| pose[LATERAL].0[0].abs());
    assert!(aside.clone().all(|y| y < 1e-6), "it is not at rest: {:?}", aside.collect::<Vec<_>>());
}

#[test]
fn nothing_in_a_damper_becomes_subnormal_in_half_a_million_steps() {
    every_damper_comes_to_rest(500_000);
}

#[test]
#[ignore = "most of a minute; `cargo xtask ci --full` runs it"]
fn nothing_in_a_damper_becomes_subnormal_in_ten_million_steps() {
    every_damper_comes_to_rest(10_000_000);
}

/// A damper with each effect, whose ram is moved once and stands still from then on.
fn every_damper_comes_to_rest(steps: u32) {
    const STEP_S: f64 = 1e-3;
    const LOOK_STEPS: u32 = 100_000;
    let scale = Nominal::NEW.scale();
    let with = |effects: &[Effect]| Damper::new(Nominal::NEW, effects).unwrap().prepared(STEP_S);
    let mut rigs = vec![("none", with(&[]))];
    for info in CATALOGUE {
        let usual: Vec<f64> = info.parameters.iter().map(|row| row.usual(&scale)).collect();
        rigs.push((info.name, with(&[Effect::from_values(info.name, &usual).unwrap()])));
    }
    for (name, damper) in rigs {
        let mut state = DamperState::rest();
        for step in 1..=50 {
            let displacement_m = 1e-4 * f64::from(step);
            damper.advance(&mut state, Motion::new(displacement_m, 0.1), STEP_S);
        }
        for look in 0..steps / LOOK_STEPS {
            for _ in 0..LOOK_STEPS {
                damper.advance(&mut state, Motion::new(5e-3, 0.0), STEP_S);
            }
            let small = subnormal(&state);
            assert!(small.is_empty(), "{name}, after {look} looks: {small:?}");
        }
    }
}

/// The subnormal numbers of a state, as it shows itself.
fn subnormal(state: &impl Debug) -> Vec<f64> {
    let text = format!("{state:?}");
    let words = text.split(|letter: char| !(letter.is_ascii_digit() || "+-.e".contains(letter)));
    words.filter_map(|word| word.parse::<f64>().ok()).filter(|value| value.is_subnormal()).collect()
}

#[test]
fn a_subnormal_number_is_seen() {
    assert_eq!(subnormal(&[1.0, -3.0e-310, 0.0, 2.3e-308]), [-3.0e-310]);
}
