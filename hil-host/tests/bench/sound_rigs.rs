//! Sound rigs: every alarm is a false one. `cargo xtask ci --full` listens to each for ten minutes.

use hil_host::faults::{SoundScenarios, listen_to_sound_rigs, sound_cases};
use std::path::Path;
use std::sync::atomic::AtomicBool;

#[test]
fn no_detector_raises_an_alarm_in_20_seconds_of_each_sound_rig() {
    const SEED: u64 = 20_261_129;
    println!("seed {SEED}");
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let (straight, curve) =
        (scenarios.join("ss9-160kmh.toml"), scenarios.join("ss9-curve-400m.toml"));
    let scenarios = SoundScenarios { straight: &straight, curve: &curve };
    let cases = sound_cases();
    let stop = AtomicBool::new(false);
    let heard = listen_to_sound_rigs(scenarios, &cases, 20.0, SEED, &stop, &|_| {}).unwrap();
    let alarms: Vec<_> = heard.iter().filter(|heard| !heard.alarms.is_empty()).collect();
    assert!(alarms.is_empty(), "{alarms:?}");
    assert!(heard.len() == 48 && heard.iter().all(|heard| heard.cycles >= 20_000));
}
