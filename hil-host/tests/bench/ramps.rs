//! Ramps: a rig is coupled from wherever its ram stands, and brought back to rest there.

use crate::support::locomotive::{NODE, scenario, session};
use can_protocol::{Pace as WirePace, Profile};
use firmware_core::command::Command;
use firmware_core::compensation::{Compensator, Feedforward, Series};
use firmware_core::supervision::{Action, Cause, Event, Signal, State};
use hil_host::bus::MemoryBus;
use hil_host::clock::{Pacer, Tick};
use hil_host::control::{
    Buses, Course, End, NoAnswer, Pace, Requests, Session, SessionState, Stop,
};
use hil_host::record::Queues;
use hil_host::rig::RigNode;
use proptest::prelude::*;
use scenario::run::{Overrides, Run, SlotForce};
use std::path::Path;
use std::time::Duration;

const CYCLE_S: f64 = 1e-3;

fn bus_with_ram_at(run: &Run, ram_m: f64) -> MemoryBus {
    MemoryBus::new(Some(RigNode::new(&run.rig, NODE, Profile::Classical).with_ram_at(ram_m)))
}

fn greet(session: &Session<'_>, run: &Run, bus: &mut MemoryBus) -> Result<SessionState, NoAnswer> {
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let stop = Requests::armed();
    session.greet(&mut state, std::slice::from_mut(bus), Duration::from_secs(1), &stop)?;
    Ok(state)
}

/// Cycles through a run; gives the command of each.
fn commands(
    session: &Session<'_>,
    state: &mut SessionState,
    bus: &mut MemoryBus,
    cycles: u64,
) -> Vec<Command> {
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let mut buses = Buses::new(std::slice::from_mut(bus), &mut recorder);
    let of_a_cycle = |_| {
        session.cycle(state, &mut buses, Tick::default());
        state.line.slots[0].command
    };
    (0..cycles).map(of_a_cycle).collect()
}

/// Runs to the end of so many cycles of RUN, on a clock that waits for nothing.
fn run_through(
    run: &Run,
    session: &Session<'_>,
    state: &mut SessionState,
    bus: &mut MemoryBus,
    cycles: u64,
) -> End {
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let mut buses = Buses::new(std::slice::from_mut(bus), &mut recorder);
    let mut pace = Pace::Realtime(Pacer::virtual_time(1_000_000));
    let mut course = Course::new(run, session.line.track);
    session.run(&mut course, state, &mut buses, &mut pace, cycles, &Requests::armed())
}

#[test]
fn a_run_begins_where_the_ram_stands_and_ends_there_at_rest() {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::Clock);
    let mut bus = bus_with_ram_at(&run, 2.5232e-3);
    let mut state = greet(&session, &run, &mut bus).unwrap();
    assert_eq!(state.line.state, State::RampIn);
    let start_m = state.line.slots[0].command.displacement_m;
    assert!((start_m - 2.5232e-3).abs() < 1e-6, "{start_m}");

    let end = run_through(&run, &session, &mut state, &mut bus, 3000);
    assert_eq!((end, state.line.state), (End::Completed, State::Standby));
    // Twice 0.5 s before RUN, twice after it.
    assert_eq!(state.line.cycle, 1000 + 3000 + 1000);
    let rest = state.line.slots[0].command;
    assert_eq!((rest.displacement_m, rest.velocity_m_per_s), (start_m, 0.0));
    let ram = bus.rigs()[0].physics().ram();
    assert!((ram.displacement_m - start_m).abs() < 1e-6 && ram.velocity_m_per_s.abs() < 1e-6);
}

#[test]
fn the_time_is_zero_in_the_first_cycle_of_run() {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let mut bus = bus_with_ram_at(&run, 0.0);
    let mut state = greet(&session, &run, &mut bus).unwrap();
    commands(&session, &mut state, &mut bus, 1000);
    assert_eq!((state.line.state, state.line.time_s(CYCLE_S)), (State::RampIn, -CYCLE_S));
    commands(&session, &mut state, &mut bus, 1);
    assert_eq!((state.line.state, state.line.time_s(CYCLE_S)), (State::Run, 0.0));
}

#[test]
fn a_ram_far_away_takes_longer_and_one_too_far_is_refused() {
    let mut run = scenario();
    run.motion.velocity_m_per_s = 0.2;
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let state = greet(&session, &run, &mut bus_with_ram_at(&run, 80e-3)).unwrap();
    // pi x / v = 1.26 s.
    assert!((1750..1770).contains(&state.line.ramp_in_cycles), "{}", state.line.ramp_in_cycles);
    run.motion.velocity_m_per_s = 0.02;
    let track = run.track.view();
    let session = crate::support::locomotive::session(&run, &track, WirePace::LockStep);
    let refused = greet(&session, &run, &mut bus_with_ram_at(&run, 80e-3));
    assert!(matches!(refused, Err(NoAnswer::TooFar { node: 1, .. })), "{refused:?}");
}

#[test]
fn the_plant_of_a_rig_stays_from_session_to_session() {
    // The emulator put ram and damper back to the middle in every session, so that a start jump of
    // 2.5 mm was never seen.
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let mut bus = bus_with_ram_at(&run, 0.0);
    let mut state = greet(&session, &run, &mut bus).unwrap();
    commands(&session, &mut state, &mut bus, 4060);
    state.line.on(Event::Stop);
    commands(&session, &mut state, &mut bus, 200);
    let stands_m = bus.rigs()[0].physics().ram().displacement_m;
    assert!(stands_m.abs() > 1e-4, "{stands_m}");
    // It went safe, and its key resets it.
    assert!(matches!(greet(&session, &run, &mut bus), Err(NoAnswer::Latched { node: 1, .. })));
    assert!(bus.rigs_mut()[0].reset());
    let again = greet(&session, &run, &mut bus).unwrap();
    let begins_m = again.line.slots[0].command.displacement_m;
    assert!((begins_m - stands_m).abs() < 2e-6, "{begins_m} {stands_m}");
}

#[test]
fn a_force_that_is_not_believed_leaves_the_vehicle_within_20_ms_and_without_a_step() {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let mut bus = bus_with_ram_at(&run, 0.0);
    let mut state = greet(&session, &run, &mut bus).unwrap();
    commands(&session, &mut state, &mut bus, 3000);
    let memory = &mut state.line.slots[0];
    memory.is_force_believed = false;
    state.line.on(Event::End);
    for _ in 0..20 {
        assert!(!state.line.slots[0].coupling.is_empty());
        let before_n = state.line.vehicle.damper_n[0].lane(0);
        commands(&session, &mut state, &mut bus, 1);
        let change_n = state.line.vehicle.damper_n[0].lane(0) - before_n;
        assert!(change_n.abs() < 4000.0, "{change_n}");
    }
    assert!(state.line.slots[0].coupling.is_empty() && state.line.slots[0].motion.is_full());
}

#[test]
fn a_cause_that_asks_to_ramp_out_ends_at_rest_and_not_in_the_safe_state() {
    let mut run = scenario();
    run.duration_s = 20.0;
    let track = run.track.view();
    let session = session(&run, &track, WirePace::Clock);
    let mut bus = bus_with_ram_at(&run, 0.0);
    let mut state = greet(&session, &run, &mut bus).unwrap();
    let stop = Cause { signal: Signal::BusQueue, value: 2.0, limit: 2.0, action: Action::RampOut };
    commands(&session, &mut state, &mut bus, 2000);
    state.line.on(Event::End);
    state.stop = Some(Stop { cycle: 2000, time_s: 1.0, node: None, cause: stop, skipped: 0 });
    let end = run_through(&run, &session, &mut state, &mut bus, 20_000);
    assert_eq!((end, state.line.state, state.line.cycle), (End::RampedOut, State::Standby, 3000));
}

#[test]
fn hunting_that_grows_towards_the_end_of_the_stroke_is_ramped_out() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-worn-2a-4mm.toml");
    let overrides =
        Overrides { duration_s: Some(20.0), speed_kmh: Some(320.0), ..Overrides::default() };
    let mut run = Run::load(&path, overrides).unwrap();
    // It settles at 16 mm.
    for (stroke_m, is_found) in [(13e-3, true), (30e-3, false)] {
        run.motion.stroke_m = stroke_m;
        let track = run.track.view();
        let session = session(&run, &track, WirePace::Clock);
        let mut bus = bus_with_ram_at(&run, 0.0);
        let mut state = greet(&session, &run, &mut bus).unwrap();
        let end = run_through(&run, &session, &mut state, &mut bus, 20_000);
        let signal = state.stop.map(|stop| stop.cause.signal);
        let expected =
            if is_found { (End::RampedOut, Some(Signal::Growth)) } else { (End::Completed, None) };
        assert_eq!((end, signal), expected, "{stroke_m}");
        assert_eq!(state.line.state, State::Standby);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Wherever the ram stands and whenever the run is ended, in order or at once: no command is
    /// further than `v_max T` from the last, the first one from the ram, and none changes its speed
    /// by more than `a_max T`.
    #[test]
    fn no_command_steps_further_than_the_limits(
        ram_m in -90e-3..90e-3_f64,
        ends_at in 0_u64..3000,
        at_once in any::<bool>(),
        ramp_cycles in prop_oneof![Just(0_u32), 1_u32..700],
        delay_ms in prop_oneof![Just(0.0), -5.0..20.0_f64],
        gain in 0.9..1.1_f64,
        virtual_clearance_m in prop_oneof![Just(0.0), 1e-3..8e-3_f64],
    ) {
        let mut run = scenario();
        run.motion.ramp_cycles = ramp_cycles;
        for slot in &mut run.slots {
            if let SlotForce::Rig { virtual_clearance_2a_m, compensator, .. } = &mut slot.force {
                *virtual_clearance_2a_m = virtual_clearance_m;
                if delay_ms != 0.0 {
                    let Series([_, a1, a2, a3]) = Series::IDENTITY.with_delay(delay_ms * 1e-3);
                    let inverse = Feedforward::inverse([gain, a1, a2, a3]);
                    *compensator = Compensator::Feedforward(inverse);
                }
            }
        }
        let motion = run.motion;
        let track = run.track.view();
        let session = session(&run, &track, WirePace::LockStep);
        let mut bus = bus_with_ram_at(&run, ram_m);
        let mut state = greet(&session, &run, &mut bus).unwrap();
        let mut last = state.line.slots[0].command;
        prop_assert!((last.displacement_m - ram_m).abs() < 2e-6);
        let mut all = commands(&session, &mut state, &mut bus, ends_at);
        let event = Event::End;
        state.line.on(if at_once { Event::Stop } else { event });
        all.extend(commands(&session, &mut state, &mut bus, 1500));
        for (n, command) in all.into_iter().enumerate() {
            let step_m = (command.displacement_m - last.displacement_m).abs();
            let change = (command.velocity_m_per_s - last.velocity_m_per_s).abs();
            prop_assert!(step_m <= motion.velocity_m_per_s * CYCLE_S * (1.0 + 1e-9), "{n} {step_m}");
            prop_assert!(
                change <= motion.acceleration_m_per_s2 * CYCLE_S * (1.0 + 1e-9),
                "{n} {change}"
            );
            last = command;
        }
        prop_assert_eq!(last.velocity_m_per_s, 0.0);
    }
}
