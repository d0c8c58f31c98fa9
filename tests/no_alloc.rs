//! Between receive and send nothing allocates.

#[path = "support/session.rs"]
mod session;

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use dbc::{CanId, Database};
use firmware_core::supervision::{Action, Checks, Rule, Signal};
use hil_host::Draw;
use hil_host::bus::{BusCounters, MemoryBus, RawFrame, Sent};
use hil_host::clock::Tick;
use hil_host::control::{Buses, Course, Notice, Notices, Requests, Session, SessionState};
use hil_host::gateway::{Gateway, GatewayPlan, Loss, Wire};
use hil_host::record::{Queues, Recorder};
use scenario::irregularity::Stretches;
use scenario::run::BeyondLimits;
use scenario::source::Source;
use session::{cycles, ready, scenario, session};
use std::collections::VecDeque;
use std::path::Path;
use std::time::Duration;

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
fn nor_does_one_with_a_servo_hydraulic_or_an_adaptively_compensated_rig() {
    for name in ["ss9-160kmh-servo-rig.toml", "ss9-slow-rig.toml"] {
        let run = scenario(name, 5.0);
        let track = run.track.view();
        let session = session(&run, &track);
        let (mut state, mut buses) = ready(&run, &session);
        let mut queues = Queues::default();
        let (mut recorder, _drain) = queues.split();
        assert_no_alloc(|| cycles(&session, &mut state, &mut buses, &mut recorder, 3000));
        assert!(state.line.cycle == 3000 && !state.line.is_safe(), "{name}");
    }
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
        Notice::Cause(_) | Notice::DroppedOut { .. } => false,
    };
    assert_eq!(found.iter().filter(noted).count(), session.ports.len());
    let cause = found.iter().filter(|notice| matches!(notice, Notice::Cause(_)));
    assert_eq!(cause.collect::<Vec<_>>(), [&Notice::Cause(state.stop.unwrap())]);
}

#[test]
fn a_rig_that_drops_out_does_not_touch_the_heap() {
    let run = scenario("ss9-two-rigs-partner.toml", 5.0);
    let track = run.track.view();
    let mut session = session(&run, &track);
    let usual = Checks::usual(session.profile.counter_modulus(), session.line.cycle_s, 100e3);
    let residual = Rule { limit: 10.0, action: Action::RampOut, ..usual.residual };
    let first = session.ports[0].clone().dropping_out();
    session.ports[0] = first.checked(Checks { residual, ..usual }, BeyondLimits::Saturate);
    let (mut state, mut buses) = ready(&run, &session);
    let mut queues = Queues::default();
    let (mut recorder, drain) = queues.split();
    assert_no_alloc(|| noticed(&session, &mut state, &mut buses, &mut recorder));
    let found: Vec<Notice> = std::iter::from_fn(|| drain.notices.next()).collect();
    let why = state.ports[0].dropped_out.unwrap();
    assert_eq!(found, [Notice::DroppedOut { slot: 0, why }]);
    assert!(state.stop.is_none() && !state.ports[1].has_dropped_out());
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

/// A servo with the messages of `scenarios/rigs/own-messages/servo.dbc`: it is where it is told to
/// be, at once, and its force follows the velocity.
struct Servo {
    told: u64,
    alive: u64,
    out: VecDeque<RawFrame>,
}

impl Servo {
    fn measure(&mut self) {
        self.alive += 1;
        let (position, velocity) = (self.told & 0xFF_FFFF, self.told >> 24 & 0xFFFF);
        let force = (velocity as u16 as i16 as u64) & 0xF_FFFF;
        let sequence = self.told >> 48 & 0xFF;
        let data = force | position << 20 | 1 << 44 | (self.alive & 0xFF) << 48 | sequence << 56;
        let frame =
            |id, data: &[u8]| RawFrame::new(CanId::Extended(id), false, data).expect("a frame");
        self.out.push_back(frame(0x18FF_0201, &data.to_le_bytes()));
        self.out.push_back(frame(0x18FF_0301, &[2, 75]));
    }
}

impl Wire for Servo {
    fn send(&mut self, frame: &RawFrame) -> Sent {
        self.told = u64::from_le_bytes(frame.data().try_into().expect("8 bytes"));
        self.measure();
        Sent::Away
    }

    fn receive(&mut self) -> Option<RawFrame> {
        self.out.pop_front()
    }

    fn wait(&mut self, _timeout: Duration) -> bool {
        self.measure();
        true
    }

    fn counters(&self) -> BusCounters {
        BusCounters::default()
    }

    fn time(&self) -> Duration {
        Duration::from_millis(self.alive)
    }
}

#[test]
fn a_control_cycle_with_own_messages_does_not_touch_the_heap() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/rigs/own-messages");
    let map = std::fs::read_to_string(folder.join("servo-map.toml")).unwrap();
    let map = Source::from_text(Path::new("map.toml"), &map.replace("timeout_s = 0.1\n", ""));
    let database = Database::read(&folder.join("servo.dbc")).unwrap();
    let plan = GatewayPlan::new(&database, &map, Loss::ALL).unwrap();
    let run = scenario("ss9-160kmh.toml", 5.0);
    let track = run.track.view();
    let session = session(&run, &track);
    let servo = Servo { told: 0, alive: 0, out: VecDeque::with_capacity(64) };
    let (node, draw) = (session.ports[0].node, Draw::seeded(7, 1));
    let mut buses = [Gateway::new(plan, servo, node, session.profile, draw)];
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let greeted =
        session.greet(&mut state, &mut buses, Duration::from_secs(10), &Requests::armed());
    greeted.unwrap_or_else(|why| panic!("{why:?}"));
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let mut buses = Buses::new(&mut buses, &mut recorder);
    assert_no_alloc(|| {
        for _ in 0..3000 {
            session.cycle(&mut state, &mut buses, Tick::default());
        }
    });
    // Every command was answered, whatever the host believes of such a damper.
    assert!(session.ports[0].counts(&state.ports[0]).ok > 2900);
}
