//! Between receive and send nothing allocates.

#[path = "support/session.rs"]
mod session;

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use firmware_core::supervision::{Action, Checks, Rule, Signal};
use hil_host::bus::MemoryBus;
use hil_host::clock::Tick;
use hil_host::control::{Buses, Course, Notice, Notices, Session, SessionState};
use hil_host::record::{Queues, Recorder};
use scenario::irregularity::Stretches;
use scenario::run::BeyondLimits;
use session::{cycles, ready, scenario, session};

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

#[test]
fn a_control_cycle_with_a_rig_does_not_touch_the_heap() {
    let run = scenario("ss9-one-worn-of-four.toml", 5.0);
    let track = run.track.view();
    let session = session(&run, &track);
    let (mut state, mut buses) = ready(&run, &session);
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    assert_no_alloc(|| cycles(&session, &mut state, &mut buses, &mut recorder, 3000));
    assert_eq!(state.line.cycle, 3000);
    assert!(!state.line.is_safe());
    // The watch over the rig ran along.
    assert!(state.ports[0].watch.view.residual_n.is_some());
    // The check itself works: an allocation inside would abort, one outside is free.
    drop(vec![0_u8; 64]);
}

#[test]
fn nor_does_one_with_a_servo_hydraulic_rig() {
    let run = scenario("ss9-160kmh-servo-rig.toml", 5.0);
    let track = run.track.view();
    let session = session(&run, &track);
    let (mut state, mut buses) = ready(&run, &session);
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    assert_no_alloc(|| cycles(&session, &mut state, &mut buses, &mut recorder, 3000));
    assert!(state.line.cycle == 3000 && !state.line.is_safe());
}

#[test]
fn what_the_loop_finds_leaves_it_without_touching_the_heap() {
    let run = scenario("ss9-one-worn-of-four.toml", 5.0);
    let track = run.track.view();
    let mut session = session(&run, &track);
    // Any force is noted, and a residual ends the run.
    let usual = Checks::usual(session.profile.counter_modulus(), session.line.cycle_s, 100e3);
    let checks = Checks {
        force: Rule { limit: 1.0, action: Action::Log, ..usual.force },
        residual: Rule { limit: 10.0, action: Action::RampOut, ..usual.residual },
        ..usual
    };
    for port in &mut session.ports {
        *port = port.clone().checked(checks, BeyondLimits::Saturate);
    }
    let (mut state, mut buses) = ready(&run, &session);
    let mut queues = Queues::default();
    let (mut recorder, drain) = queues.split();
    assert_no_alloc(|| noticed(&session, &mut state, &mut buses, &mut recorder));
    let found: Vec<Notice> = std::iter::from_fn(|| drain.notices.next()).collect();
    let noted = |notice: &&Notice| match notice {
        Notice::Noted(first) => first.cause.signal == Signal::Force,
        Notice::Cause(_) => false,
    };
    assert_eq!(found.iter().filter(noted).count(), session.ports.len());
    let cause = found.iter().filter(|notice| matches!(notice, Notice::Cause(_)));
    assert_eq!(cause.collect::<Vec<_>>(), [&Notice::Cause(state.stop.unwrap())]);
}

/// Runs 3000 cycles and hands over what they find.
fn noticed(
    session: &Session<'_>,
    state: &mut SessionState,
    buses: &mut [MemoryBus],
    recorder: &mut Recorder<'_>,
) {
    let mut buses = Buses::new(buses, recorder);
    let mut notices = Notices::default();
    for _ in 0..3000 {
        session.cycle(state, &mut buses, Tick::default());
        session.notify(state, &mut notices, buses.recorder());
    }
}

#[test]
fn a_change_of_the_stretch_of_track_does_not_touch_the_heap() {
    let run = scenario("ss9-one-worn-of-four.toml", 5.0).in_stretches_of(1024);
    let stretches = run.stretches.as_ref().map_or(0, Stretches::count);
    let track = run.track.view();
    let session = session(&run, &track);
    let (mut state, mut buses) = ready(&run, &session);
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let mut buses = Buses::new(&mut buses, &mut recorder);
    let mut course = Course::new(&run, &track);
    // The fourth change is the second after a buffer has gone back.
    for change in 1..=4 {
        assert!(change < stretches, "{stretches} stretches");
        while !course.is_ready() {
            std::thread::yield_now();
        }
        assert_no_alloc(|| {
            let track = course.track();
            while !course.is_passed(&state.line) {
                session.cycle_on(&track, &mut state, &mut buses, Tick::default());
            }
            assert_eq!(course.change(), Ok(()));
        });
    }
    assert!(!state.line.is_safe());
    assert!(course.track().irregularity.before > 3 * 512);
}
