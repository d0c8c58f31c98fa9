//! The gate before RUN: a rig that is six cycles late is refused, accepted or compensated.

use crate::support::locomotive::{NODE, scenario_with, session};
use can_protocol::{Pace as WirePace, Profile};
use firmware_core::damper::{Damper, Nominal};
use firmware_core::line::{Sensitivity, Slot};
use firmware_core::supervision::{Action, Signal, State};
use hil_host::bus::MemoryBus;
use hil_host::clock::Pacer;
use hil_host::control::{Buses, Course, DelayGate, End, Pace, Requests, SessionState};
use hil_host::record::Queues;
use hil_host::rig::RigNode;
use scenario::run::{CYCLE_S, MEASURING_S, Run};
use std::time::Duration;

/// Cycles between the fades.
const MEASURING_CYCLES: u32 = (MEASURING_S * 1e3) as u32;

const HUNTING_HZ: f64 = 3.5;

/// Five seconds with a rig of six cycles of pure delay and 0.5 ms of lag, and further lines of its
/// slot.
fn late_rig(slot: &str) -> Run {
    let mut run = scenario_with(slot);
    run.rig.delay_cycles = 6;
    run
}

/// Runs through a scenario as on a real bus; the end, the state, and what the delay costs at most.
fn gated(run: &Run) -> (End, SessionState, f64) {
    let track = run.track.view();
    let mut session = session(run, &track, WirePace::Clock);
    let accepted = run.slots.iter().map(|slot| {
        matches!(slot.force, scenario::run::SlotForce::Rig { accept_delay_error: true, .. })
    });
    let mut gate = DelayGate { hunting_hz: HUNTING_HZ, accepted: [false; 4] };
    gate.accepted.iter_mut().zip(accepted).for_each(|(to, from)| *to = from);
    session.delay_gate = Some(gate);
    session.line.fade.measuring_cycles = MEASURING_CYCLES;
    let mut bus = MemoryBus::new(Some(RigNode::new(&run.rig, NODE, Profile::Classical)));
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let requests = Requests::armed();
    let buses = std::slice::from_mut(&mut bus);
    session.greet(&mut state, buses, Duration::from_secs(1), &requests).unwrap();
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let mut buses = Buses::new(buses, &mut recorder);
    let mut pace = Pace::Realtime(Pacer::virtual_time(1_000_000));
    let mut course = Course::new(run, session.line.track);
    let end = session.run(&mut course, &mut state, &mut buses, &mut pace, 1000, &requests);
    let Slot::Rig(rig) = &session.line.slots[0] else { panic!("no rig") };
    let sensitivity = Sensitivity::of(&rig.model, HUNTING_HZ);
    let delay = state.gate.delays[0].residual(CYCLE_S);
    let cost = delay.map_or(f64::NAN, |delay| delay.worst_cost(sensitivity));
    (end, state, cost)
}

#[test]
fn six_cycles_of_delay_are_refused_before_the_force_acts() {
    let run = late_rig("");
    let (end, state, cost) = gated(&run);
    assert_eq!((end, state.line.state), (End::RampedOut, State::Standby));
    let stop = state.stop.unwrap();
    assert_eq!((stop.node, stop.cause.signal), (Some(1), Signal::Delay));
    assert_eq!(stop.cause.action, Action::RampOut);
    // Six cycles and the lag, less half a cycle; 5 % is lost at 1.28 ms.
    assert!((stop.cause.value - 6e-3).abs() < 0.3e-3, "{stop}");
    assert!((stop.cause.limit - 1.282e-3).abs() < 1e-6, "{stop}");
    assert!((0.20..0.28).contains(&cost), "{cost}");
    // Found in the last cycle of the measurement: the coupling had not begun.
    assert_eq!(stop.cycle, u64::from(run.motion.ramp_cycles + MEASURING_CYCLES));
}

#[test]
fn a_slot_that_accepts_the_cost_runs_and_the_number_is_kept() {
    let (end, state, cost) = gated(&late_rig("accept_delay_error = true"));
    assert_eq!((end, state.stop), (End::Completed, None));
    assert!(cost > 0.2, "{cost}");
}

#[test]
fn a_delay_that_is_compensated_costs_less_than_two_per_cent() {
    for compensation in [
        "kind = \"polynomial\"\norder = 2\ndelay_s = 6.5e-3",
        "kind = \"inverse\"\ncoefficients = [1.0, 6.5e-3, 2.1e-5, 0.0]",
        // A millisecond and a half too few to begin with.
        "kind = \"adaptive\"\ndelay_s = 5e-3\ngain_check_hz = 60.0",
    ] {
        let (end, state, cost) = gated(&late_rig(&format!("[slot.compensation]\n{compensation}")));
        assert_eq!((end, state.stop), (End::Completed, None), "{compensation}: {cost}");
        assert!(cost < 0.02, "{compensation}: {cost}");
    }
}

#[test]
fn an_estimate_that_runs_away_ramps_out_before_the_force_acts() {
    // Half the delay to begin with: the second order is out of its reach for a second.
    let slot = "[slot.compensation]\nkind = \"adaptive\"\ndelay_s = 3.5e-3\ngain_check_hz = 60.0";
    let run = late_rig(slot);
    let (end, state, _) = gated(&run);
    let stop = state.stop.unwrap();
    assert_eq!((end, stop.cause.signal), (End::RampedOut, Signal::Compensation));
    assert!(stop.cycle < u64::from(run.motion.ramp_cycles + MEASURING_CYCLES), "{stop}");
}

#[test]
fn the_default_rig_needs_no_compensation() {
    let run = scenario_with("");
    let (end, state, cost) = gated(&run);
    assert_eq!(end, End::Completed);
    let delay = state.gate.delays[0].residual(CYCLE_S).unwrap();
    assert!(cost < 0.005 && delay.mean_s.abs() < 0.05e-3, "{cost} {delay:?}");
}

/// Wear before the damper of a rig whose delay is compensated.
const WORN: &str = "virtual_wear = { clearance_2a_m = 2e-3, stiffness_n_per_m = 8e6 }\n\
    [slot.compensation]\nkind = \"polynomial\"\norder = 2\ndelay_s = 6.5e-3";

#[test]
fn wear_before_a_damper_that_is_known_runs_and_its_numbers_are_kept() {
    let (end, state, cost) = gated(&late_rig(WORN));
    let found = state.gate.wear[0].unwrap();
    assert_eq!((end, state.stop), (End::Completed, None), "{found:?}");
    assert!(found.loop_gain < 0.05 && found.force_error < 0.02, "{found:?}");
    assert!(cost < 0.02, "{cost}");
}

#[test]
fn wear_before_a_damper_that_is_half_as_stiff_is_refused_before_the_force_acts() {
    let mut run = late_rig(WORN);
    let known = *run.rig.damper.nominal();
    let soft = Nominal { ke_n_per_m: 0.5 * known.ke_n_per_m, ..known };
    run.rig.damper = Damper::new(soft, run.rig.damper.effects()).unwrap();
    let (end, state, _) = gated(&run);
    let stop = state.stop.unwrap();
    assert_eq!((end, stop.cause.signal), (End::RampedOut, Signal::WearForceError), "{stop}");
    assert_eq!(stop.cause.limit, 0.025);
    assert_eq!(stop.cycle, u64::from(run.motion.ramp_cycles + MEASURING_CYCLES));
}
