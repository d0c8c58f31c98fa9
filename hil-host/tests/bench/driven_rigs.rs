//! Rigs whose ram is moved by a controller: SAFE, rest and reset, and the temperature they send.

use crate::support::host::{Host, setup};
use crate::support::rig::{answers, armed, give, quiet};
use can_protocol::{Message, Pace, Profile, RunState};
use hil_host::rig::WATCHDOG_CYCLES;
use scenario::rig::{RigFile, RigSetup};
use std::path::Path;

fn file(name: &str) -> RigSetup {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/rigs");
    RigFile::load(&folder.join(name)).unwrap()
}

/// Cycles from SAFE until the ram stands still, after a host fell silent at 76 mm/s.
fn cycles_to_rest(setup: &RigSetup) -> u32 {
    let mut host = Host::new(Profile::Classical);
    let mut rig = armed(setup, &mut host, Pace::Clock);
    // Two periods at 3.5 Hz end at mid-stroke, at the highest speed.
    for _ in 0..571 {
        give(&mut rig, &host.run());
        rig.cycle();
        answers(&mut rig);
    }
    assert_eq!(rig.run_state(), RunState::Run);
    for _ in 0..WATCHDOG_CYCLES {
        rig.cycle();
        answers(&mut rig);
    }
    assert_eq!(rig.run_state(), RunState::Safe);
    assert!(!rig.is_at_rest() && !rig.reset(), "a ram in motion is not reset");
    let mut cycles = 0;
    let mut still = 0;
    while still < 200 && cycles < 2000 {
        rig.cycle();
        answers(&mut rig);
        still = if rig.is_at_rest() { still + 1 } else { 0 };
        cycles += 1;
    }
    assert!(rig.reset(), "at rest after {cycles} cycles: {:?}", rig.physics().ram());
    cycles - still
}

#[test]
fn a_silent_host_brings_every_kind_of_rig_to_rest_and_a_reset_waits_for_that() {
    let ideal = cycles_to_rest(&setup());
    let servo = cycles_to_rest(&file("servo-hydraulic-rig.toml"));
    let benchmark = cycles_to_rest(&file("rths-benchmark-rig.toml"));
    println!("at rest for good after {ideal}, {servo} and {benchmark} cycles");
    // The ideal ram needs 7.6 ms for 76 mm/s. Under the servo rig the damper relaxes with Ce/Ke, 80
    // ms. The benchmark's plant rings with poles at -8 +- 422i 1/s: ln(76 / 0.1) / 8 s at most.
    assert!(ideal <= 9 && servo <= 200 && benchmark <= 830);
    assert!(servo > ideal && benchmark > ideal);
}

#[test]
fn only_a_rig_that_knows_its_oil_sends_a_temperature() {
    let sent = |setup: &RigSetup| {
        let mut host = Host::new(Profile::Classical);
        let mut rig = armed(setup, &mut host, Pace::Clock);
        let mut last = None;
        for _ in 0..3000 {
            give(&mut rig, &host.run());
            rig.cycle();
            for message in answers(&mut rig) {
                if let Message::Telemetry(telemetry) = message {
                    last = Some(telemetry.temperature_degc);
                }
            }
        }
        last.expect("telemetry in three seconds")
    };
    assert_eq!(sent(&quiet()), None);
    assert_eq!(sent(&file("rths-benchmark-rig.toml")), None);
    // Some 500 W into 21 kJ/K for three seconds.
    let degc = sent(&file("servo-hydraulic-rig.toml")).expect("a temperature");
    assert!((20.02..20.2).contains(&degc), "{degc} degrees Celsius");
}
