//! Rigs that speak their own messages, in virtual time: coupled, refused, and found out.

use crate::support::locomotive::{lasting, session};
use crate::support::own_messages::{Habits, OwnRig, gateway, plan, planned, planned_with};
use can_protocol::arming::Refusal;
use can_protocol::{ArmItem, Pace as WirePace, RunState};
use hil_host::bus::Bus;
use hil_host::clock::Pacer;
use hil_host::control::{Buses, Course, End, NoAnswer, Pace, Requests, Session, SessionState};
use hil_host::gateway::{Gateway, GatewayError, GatewayPlan, Loss, Unready};
use hil_host::record::Queues;
use scenario::run::Run;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// A run of so many cycles of RUN; none where the rig was not armed.
struct Ran {
    end: Result<End, NoAnswer>,
    state: SessionState,
    bus: Gateway<OwnRig>,
    lost: u64,
    cause: Option<String>,
}

/// Ends the thread that empties the queues, after a panic too.
struct Done<'a>(&'a AtomicBool);

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

fn sound() -> Habits {
    Habits { time_out_cycles: Some(100), ..Habits::default() }
}

fn run_with(plan: GatewayPlan, name: &str, habits: Habits, pace: WirePace, cycles: u64) -> Ran {
    let run: Run = lasting(cycles as f64 * 1e-3, "");
    let track = run.track.view();
    let session: Session<'_> = session(&run, &track, pace);
    let mut queues = Queues::default();
    let (mut recorder, drain) = queues.split();
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let mut bus = gateway(plan, OwnRig::new(name, &run.rig, habits));
    let (patience, requests) = (Duration::from_secs(10), Requests::armed());
    let greeted = session.greet(&mut state, std::slice::from_mut(&mut bus), patience, &requests);
    let done = AtomicBool::new(false);
    let end = std::thread::scope(|scope| {
        // Rows and frames are taken out, or a run without a clock would wait for room.
        scope.spawn(|| drain.discard(&done));
        let _done = Done(&done);
        greeted.map(|()| {
            let mut buses = Buses::new(std::slice::from_mut(&mut bus), &mut recorder);
            let mut pace = match pace {
                WirePace::Clock => Pace::Realtime(Pacer::virtual_time(1_000_000)),
                WirePace::LockStep => Pace::LockStep,
            };
            let mut course = Course::new(&run, &track);
            session.run(&mut course, &mut state, &mut buses, &mut pace, cycles, &requests)
        })
    });
    let counts = session.ports[0].counts(&state.ports[0]);
    // The first cycle of a run has sent nothing yet that could be answered.
    let unanswered = counts.no_new_data.saturating_sub(1);
    let lost = counts.lost_frames + counts.wrong_crc + counts.wrong_sequence + unanswered;
    let cause = state.stop.map(|stop| stop.cause.signal.key().to_owned());
    Ran { end, state, bus, lost, cause }
}

#[test]
fn both_examples_of_messages_are_coupled_and_run_to_the_end() {
    for (name, pace) in [
        ("servo", WirePace::LockStep),
        ("servo", WirePace::Clock),
        ("plain", WirePace::LockStep),
        ("plain", WirePace::Clock),
    ] {
        let ran = run_with(plan(name, |map| map), name, sound(), pace, 20_000);
        assert_eq!(ran.end, Ok(End::Completed), "{name} {pace:?}: {:?}", ran.cause);
        assert_eq!((ran.lost, ran.bus.repeated()), (0, 0), "{name} {pace:?}");
        // The damper has worked: this is no rig that stands.
        let ram_m = ran.bus.wire().set_points_m.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        assert!(ram_m > 3e-3, "{name} {pace:?}: at most {ram_m} m");
        assert!(ran.state.ports[0].used.unwrap().force_n.is_some());
    }
}

#[test]
fn a_long_run_of_own_messages_loses_no_frame() {
    let asked = std::env::var("OWN_MESSAGES_CYCLES").ok();
    let cycles = asked.map_or(5000, |text| text.parse().unwrap());
    let ran = run_with(plan("servo", |map| map), "servo", sound(), WirePace::LockStep, cycles);
    assert_eq!((ran.end, ran.lost, ran.bus.repeated()), (Ok(End::Completed), 0, 0));
    let counters = ran.bus.counters();
    println!("{cycles} cycles: {} frames sent, {} received", counters.sent, counters.received);
    assert!(counters.sent > cycles && counters.received > cycles);
    assert_eq!(counters.send_dropped + counters.receive_dropped, 0);
}

#[test]
fn both_examples_measure_the_same_damper() {
    let force_n = |name: &str, change: fn(String) -> String| {
        let ran = run_with(plan(name, change), name, sound(), WirePace::LockStep, 500);
        assert_eq!(ran.end, Ok(End::Completed));
        let used = ran.state.ports[0].used.unwrap();
        (used.force_n.unwrap(), used.displacement_m.unwrap())
    };
    // Without velocities, in both byte orders: the same ram, and signs that fit.
    let servo = force_n("servo", |map| map.replace("velocity = \"SetVelocity\"\n", ""));
    let plain = force_n("plain", |map| map);
    assert!((servo.0 - plain.0).abs() < 200.0, "{servo:?} {plain:?}");
    assert!((servo.1 - plain.1).abs() < 20e-6, "{servo:?} {plain:?}");
}

#[test]
fn a_rig_that_starts_after_the_host_was_refused_for_an_unknown_force() {
    let late = Habits { starts_at: 100, ..sound() };
    let ran = run_with(plan("servo", |map| map), "servo", late, WirePace::LockStep, 100);
    assert_eq!(ran.end, Ok(End::Completed), "{:?}", ran.bus.unready());
}

#[test]
fn the_end_of_a_run_reaches_the_rig() {
    let ran = run_with(plan("servo", |map| map), "servo", sound(), WirePace::LockStep, 100);
    assert_eq!((ran.end, ran.bus.run_state()), (Ok(End::Completed), RunState::Standby));
    let modes = &ran.bus.wire().modes;
    assert_eq!(modes.last(), Some(&0.0));
    assert!(modes.iter().filter(|mode| **mode == 1.0).count() > 2000);
}

#[test]
fn losses_have_to_be_accepted_by_name() {
    let plain =
        |change: fn(String) -> String, accepted: &[Loss]| planned("plain", change, accepted);
    let Err(GatewayError::Unaccepted { all, missing, .. }) = plain(|map| map, &[Loss::NoEcho])
    else {
        panic!("losses were not named");
    };
    assert!(all.contains(&Loss::NoEcho) && !missing.contains(&Loss::NoEcho));
    assert_eq!(all.len(), missing.len() + 1);
    let said = plain(|map| map, &[]).unwrap_err().to_string();
    assert!(!said.contains('\n') && said.ends_with(&format!("--accept {}", names(&all))), "{said}");
    assert!(plain(|map| map, &all).is_ok());
    // Everything that a DBC can describe leaves these.
    let servo = planned("servo", |map| map, Loss::ALL).unwrap().losses();
    assert_eq!(names(&servo), "no-session,no-crc,no-readiness,no-pressure-off");
}

fn names(losses: &[Loss]) -> String {
    losses.iter().map(|loss| loss.name()).collect::<Vec<_>>().join(",")
}

#[test]
fn a_rig_that_neither_counts_nor_stops_is_not_coupled() {
    let uncounted = |map: String| map.replace("counter = \"Life\"\n", "");
    let refused = planned("plain", uncounted, Loss::ALL).unwrap_err();
    assert!(matches!(refused, GatewayError::OpenLoopOnly { .. }), "{refused}");
    assert!(refused.is_bad_input() && refused.to_string().contains("OPEN_LOOP"), "{refused}");
    // One that stops by itself may do without a counter.
    let timed = |map: String| uncounted(map) + "[status]\ntimeout_s = 0.1\n";
    let ran = run_with(plan("plain", timed), "plain", sound(), WirePace::LockStep, 1000);
    assert_eq!(ran.end, Ok(End::Completed), "{:?}", ran.bus.unready());
}

#[test]
fn a_rig_whose_declared_time_out_does_not_stop_it_is_not_armed() {
    let ran = run_with(plan("servo", |map| map), "servo", Habits::default(), WirePace::Clock, 1000);
    let refusal = Refusal::ByRig(ArmItem::Enabled);
    assert_eq!(ran.end, Err(NoAnswer::Refused { node: 1, refusal }));
    let Some(Unready::RunsOn(moved_m)) = ran.bus.unready() else {
        panic!("{:?}", ran.bus.unready());
    };
    // 5 mm/s for the 100 cycles between the two halves.
    assert!((0.4e-3..0.6e-3).contains(&moved_m), "{moved_m} m");
    // And it was stopped.
    assert_eq!(ran.bus.wire().modes.last(), Some(&0.0));
}

#[test]
fn a_time_out_that_is_declared_too_short_is_found_out() {
    let late = Habits { time_out_cycles: Some(400), ..Habits::default() };
    let ran = run_with(plan("servo", |map| map), "servo", late, WirePace::Clock, 1000);
    assert!(matches!(ran.bus.unready(), Some(Unready::RunsOn(_))), "{:?}", ran.bus.unready());
}

#[test]
fn a_rig_that_repeats_its_last_measurement_is_found_out() {
    let frozen = Habits { freezes_at: Some(4000), ..sound() };
    let ran = run_with(plan("servo", |map| map), "servo", frozen, WirePace::Clock, 20_000);
    assert_eq!(ran.end, Ok(End::Safe));
    assert_eq!(ran.cause.as_deref(), Some("lost_measurements"));
    assert!(ran.bus.repeated() > 0);
    assert_eq!(ran.bus.wire().modes.last(), Some(&0.0));
}

#[test]
fn a_fault_of_the_rig_ends_the_run_in_safe_and_the_command_is_brought_to_rest() {
    let failing = Habits { fails_at: Some(4000), ..sound() };
    let ran = run_with(plan("servo", |map| map), "servo", failing, WirePace::Clock, 20_000);
    assert_eq!((ran.end, ran.bus.run_state()), (Ok(End::Safe), RunState::Fault));
    let x_m = &ran.bus.wire().set_points_m;
    let [.., before, last] = x_m[..] else { panic!("{} set points", x_m.len()) };
    assert_eq!(before, last);
    for pair in x_m.windows(2).skip(2000) {
        assert!((pair[1] - pair[0]).abs() < 0.5e-3, "a step of the command: {pair:?}");
    }
}

#[test]
fn a_command_of_another_node_ends_the_run_and_keeps_a_rig_from_being_armed() {
    let run = |at| {
        let habits = Habits { foreign_at: Some(at), ..sound() };
        run_with(plan("servo", |map| map), "servo", habits, WirePace::Clock, 20_000)
    };
    let ran = run(4000);
    assert_eq!((ran.end, ran.bus.run_state()), (Ok(End::Safe), RunState::Safe));
    assert_eq!(ran.cause.as_deref(), Some("rig_fault"));
    assert_eq!(ran.bus.wire().modes.last(), Some(&0.0));
    let ran = run(800);
    assert!(ran.end.is_err(), "{:?}", ran.end);
    assert_eq!(ran.bus.unready(), Some(Unready::SecondSender));
    assert_eq!(ran.bus.wire().modes.last(), Some(&0.0));
}

#[test]
fn a_force_that_is_no_number_is_not_believed() {
    for name in ["servo", "plain"] {
        let blind = Habits { blind_from: Some(4000), ..sound() };
        let ran = run_with(plan(name, |map| map), name, blind, WirePace::Clock, 20_000);
        assert!(matches!(ran.end, Ok(End::Safe | End::RampedOut)), "{name}: {:?}", ran.end);
        assert!(ran.cause.is_some(), "{name}");
    }
}

#[test]
fn a_rig_that_gives_no_displacement_is_not_armed() {
    // The signal of another message, which never comes.
    let dbc = |dbc: String| {
        let ram = "BO_ 5 Ram: 8 SERVO\n SG_ Ram : 0|24@1- (0.0001,0) [0|0] \"mm\" BENCH\n\nCM_ \"";
        dbc.replacen("CM_ \"", ram, 1)
    };
    let map = |map: String| map.replace("\"Position\"", "\"Ram.Ram\"");
    let plan = planned_with("servo", dbc, map, Loss::ALL).unwrap();
    let ran = run_with(plan, "servo", sound(), WirePace::Clock, 1000);
    assert!(matches!(ran.end, Err(NoAnswer::Refused { .. })), "{:?}", ran.end);
}
