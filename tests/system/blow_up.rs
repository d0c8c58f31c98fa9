//! A model that blows up ends in the safe state, with the rig's last sound command held.

use crate::support::session::scenario;
use firmware_core::guard::ForceInput;
use firmware_core::supervision::Event;

#[test]
fn a_vehicle_that_is_no_number_stops_the_rig_from_its_last_command() {
    let run = scenario("ss9-160kmh.toml", 5.0);
    let track = run.track.view();
    let line = hil_host::run::line(&run, &track);
    let mut state = line.start(run.start.state.clone());
    state.on(Event::Agreed);
    state.on(Event::Arm);
    line.couple(&mut state, [0.0; 4]).unwrap();
    let force = [ForceInput::Fresh(0.0); 4];
    for _ in 0..2500 {
        line.step(&mut state, &force);
    }
    let sound = state.slots[0].command;
    assert!(sound.velocity_m_per_s != 0.0 && !state.is_safe());
    state.vehicle.position[2][0].0[0] = f64::NAN;
    line.step(&mut state, &force);
    assert!(state.is_safe());
    for _ in 0..100 {
        line.step(&mut state, &force);
    }
    let held = state.slots[0].command;
    assert_eq!(held.velocity_m_per_s, 0.0);
    assert!((held.displacement_m - sound.displacement_m).abs() < 1e-3, "{sound:?} {held:?}");
}
