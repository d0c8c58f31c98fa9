//! The locomotive as a node: the run of an image is the run of the host, bit for bit.

use crate::support::locomotive::{NODE, scenario, session};
use can_protocol::arming::{Patience, Refusal};
use can_protocol::{ArmItem, Fault, FaultCode, Pace as WirePace, Profile, RunState};
use firmware_core::damper::Damper;
use firmware_core::line::{Line, LineState};
use firmware_core::supervision::{Checks, Signal, State};
use hil_host::Draw;
use hil_host::bus::MemoryBus;
use hil_host::control::{Arming, Buses, Course, End, Pace, Requests};
use hil_host::record::Queues;
use hil_host::rig::{Condition, Emulator, RigNode};
use nodes::locomotive::{End as NodeEnd, Locomotive, NotArmed, SILENCE_TICKS, STOP_CYCLES, Terms};
use nodes::loopback::{End as BusEnd, Loopback};
use nodes::rig::{ModelRig, ModelSetup, Plant, RigNode as Node, SUBSTEPS};
use nodes::timed::{TimedLocomotive, TimedRig};
use scenario::run::{CYCLE_S, Run};
use std::num::NonZeroU8;
use std::time::Duration;

/// Cycles of RUN.
const CYCLES: u64 = 2000;

/// Ticks after which a bench that has not ended hangs.
const MOST_TICKS: u32 = 10_000;

/// The scenario with an ideal rig: a rigid fixture, and sensors without noise.
fn with_an_ideal_rig() -> Run {
    let mut run = scenario();
    (run.rig.fixture_m_per_n, run.rig.force_noise_n, run.rig.displacement_noise_m) =
        (0.0, 0.0, 0.0);
    run
}

pub(crate) fn terms(run: &Run, pace: WirePace) -> Terms {
    let Arming { number, boot, requirements, .. } = Arming::in_memory().requiring(&run.readiness);
    let profile = Profile::Classical;
    Terms {
        node: NODE,
        slot: 0,
        profile,
        pace,
        slow_down: NonZeroU8::MIN,
        number,
        boot,
        requirements,
        checks: Checks::usual(profile.counter_modulus(), CYCLE_S, 100e3),
        patience: Patience::default(),
        silence_ticks: SILENCE_TICKS,
        cycles: CYCLES,
    }
}

/// The damper on the rig, as its image prepares it.
pub(crate) fn specimen(run: &Run) -> Damper {
    run.rig.damper.clone().prepared(CYCLE_S / f64::from(SUBSTEPS))
}

fn model_rig<'a>(run: &Run, damper: &'a Damper) -> Node<ModelRig<'a>, Draw> {
    let (stroke_m, rate_m_per_s) = (run.rig.stroke_m, run.rig.rate_m_per_s);
    let setup = ModelSetup { damper, stroke_m, rate_m_per_s, lag_s: run.rig.lag_s, seed: 1 };
    Node::new(&setup, NODE, Profile::Classical)
}

fn emulated_rig(run: &Run) -> Node<Emulator, Draw> {
    RigNode::new(&run.rig, NODE, Profile::Classical)
}

/// What a session of two nodes has come to.
pub(crate) struct Found<P: Plant> {
    pub(crate) hash: u64,
    pub(crate) end: NodeEnd,
    pub(crate) stop: Option<(u64, Signal)>,
    pub(crate) cycles: u64,
    state: State,
    pub(crate) rig: RunState,
    pub(crate) physics: P::State,
}

/// Both nodes on a loopback, tick by tick, until the locomotive ends.
pub(crate) fn together<P: Plant>(
    line: &Line<'_>,
    mut state: LineState,
    terms: Terms,
    rig: Node<P, Draw>,
    mut disturb: impl FnMut(u32, &mut Locomotive<'_>, &mut BusEnd<'_>) -> bool,
) -> Found<P> {
    let wire = Loopback::default();
    let [mut at_locomotive, at_rig] = wire.ends();
    let locomotive = Locomotive::new(line, &mut state, terms).unwrap();
    let mut locomotive = TimedLocomotive::new(locomotive);
    let rig = TimedRig::new(rig, SILENCE_TICKS);
    until_end(&mut locomotive, (rig, at_rig), MOST_TICKS, |tick, locomotive, at_rig| {
        let is_rig_there = disturb(tick, locomotive.locomotive_mut(), at_rig);
        locomotive.tick(&mut at_locomotive, 0);
        is_rig_there
    })
}

/// Ticks a locomotive as it is told, which says whether the rig is there in that tick, until it
/// ends.
pub(crate) fn until_end<P: Plant>(
    locomotive: &mut TimedLocomotive<'_>,
    (mut rig, mut at_rig): (TimedRig<P, Draw>, BusEnd<'_>),
    most_ticks: u32,
    mut tick_locomotive: impl FnMut(u32, &mut TimedLocomotive<'_>, &mut BusEnd<'_>) -> bool,
) -> Found<P> {
    for tick in 0..most_ticks {
        if tick_locomotive(tick, locomotive, &mut at_rig) {
            rig.tick(&mut at_rig);
        }
        let node = locomotive.locomotive();
        if let Some(end) = node.end() {
            rig.tick(&mut at_rig);
            return Found {
                hash: node.hash(),
                end,
                stop: node.stop().map(|stop| (stop.cycle, stop.cause.signal)),
                cycles: node.state().cycle,
                state: node.state().state,
                rig: rig.rig().run_state(),
                physics: rig.rig().physics().clone(),
            };
        }
    }
    panic!("no end after {most_ticks} ticks, in cycle {}", locomotive.locomotive().state().cycle)
}

/// The host's run of the same scenario on the memory bus.
fn on_the_host(run: &Run, pace: &mut Pace) -> (u64, End, u64) {
    let track = run.track.view();
    let session = session(run, &track, pace.on_the_wire());
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let mut bus = MemoryBus::new(Some(emulated_rig(run)));
    let buses = std::slice::from_mut(&mut bus);
    session.greet(&mut state, buses, Duration::from_secs(1), &Requests::armed()).unwrap();
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let mut course = Course::new(run, &track);
    let mut buses = Buses::new(buses, &mut recorder);
    let requests = Requests::armed();
    let end = session.run(&mut course, &mut state, &mut buses, pace, CYCLES, &requests);
    (state.hash, end, state.line.cycle)
}

#[test]
fn two_nodes_have_the_trajectory_hash_of_the_host() {
    for run in [scenario as fn() -> Run, with_an_ideal_rig] {
        let run = run();
        let (hash, end, cycles) = on_the_host(&run, &mut Pace::LockStep);
        assert_eq!(end, End::Completed);
        let track = run.track.view();
        let line = hil_host::run::line(&run, &track);
        for pace in [WirePace::LockStep, WirePace::Clock] {
            let state = line.start(run.start.state.clone());
            let rig = emulated_rig(&run);
            let found = together(&line, state, terms(&run, pace), rig, |_, _, _| true);
            assert_eq!(
                (found.hash, found.end, found.cycles),
                (hash, NodeEnd::Completed, cycles),
                "{pace:?}"
            );
            assert_eq!((found.state, found.rig), (State::Standby, RunState::Standby));
        }
    }
}

#[test]
fn a_rig_that_is_a_model_has_the_bits_of_the_ideal_rig() {
    let run = with_an_ideal_rig();
    let (hash, _, cycles) = on_the_host(&run, &mut Pace::LockStep);
    let track = run.track.view();
    let line = hil_host::run::line(&run, &track);
    let damper = specimen(&run);
    let state = line.start(run.start.state.clone());
    let rig = model_rig(&run, &damper);
    let found = together(&line, state, terms(&run, WirePace::LockStep), rig, |_, _, _| true);
    assert_eq!((found.hash, found.cycles), (hash, cycles));
}

#[test]
fn a_silent_rig_stops_the_locomotive_in_the_fifth_cycle_and_ends_it_after_the_stop() {
    let run = scenario();
    let track = run.track.view();
    let line = hil_host::run::line(&run, &track);
    for (pace, signal, silent) in [
        (WirePace::Clock, Signal::LostMeasurements, 5),
        // The next command waits for its answer, for a second.
        (WirePace::LockStep, Signal::SilentRig, 1),
    ] {
        let state = line.start(run.start.state.clone());
        let mut last = 0;
        let found = together(&line, state, terms(&run, pace), emulated_rig(&run), |_, node, _| {
            let is_there = node.state().cycle < 700;
            if is_there {
                last = node.state().cycle + 1;
            }
            is_there
        });
        assert_eq!((found.end, found.state), (NodeEnd::Safe, State::Safe), "{pace:?}");
        // The last answer came to the last command that the rig has heard.
        assert_eq!(found.stop, Some((last + silent, signal)), "{pace:?}");
        assert_eq!(found.cycles, last + silent + 1 + STOP_CYCLES, "{pace:?}");
        // It hears of the end when it is back.
        assert_eq!(found.rig, RunState::Safe, "{pace:?}");
    }
}

#[test]
fn an_operator_ends_a_run_in_order() {
    let run = scenario();
    let track = run.track.view();
    let line = hil_host::run::line(&run, &track);
    let state = line.start(run.start.state.clone());
    let rig = emulated_rig(&run);
    let found = together(&line, state, terms(&run, WirePace::Clock), rig, |tick, node, _| {
        if tick == 1500 {
            node.ask_to_end();
        }
        true
    });
    assert_eq!((found.end, found.stop), (NodeEnd::Stopped, None));
    assert_eq!((found.state, found.rig), (State::Standby, RunState::Standby));
}

#[test]
fn a_rig_whose_key_switch_is_off_is_not_armed() {
    let run = scenario();
    let track = run.track.view();
    let line = hil_host::run::line(&run, &track);
    let state = line.start(run.start.state.clone());
    let rig = emulated_rig(&run);
    let off = Condition { enabled: false, ..rig.condition() };
    let rig = rig.with_condition(off);
    let found = together(&line, state, terms(&run, WirePace::Clock), rig, |_, _, _| true);
    let refusal = Refusal::ByRig(ArmItem::Enabled);
    assert_eq!(found.end, NodeEnd::NotArmed(NotArmed::Refused(refusal)));
    assert_eq!((found.cycles, found.rig), (0, RunState::Standby));
}

#[test]
fn a_rig_whose_lock_step_host_is_gone_goes_safe_and_rests() {
    let run = scenario();
    let track = run.track.view();
    let line = hil_host::run::line(&run, &track);
    let mut state = line.start(run.start.state.clone());
    let wire = Loopback::default();
    let [mut at_locomotive, mut at_rig] = wire.ends();
    let terms = terms(&run, WirePace::LockStep);
    let locomotive = Locomotive::new(&line, &mut state, terms).unwrap();
    let mut locomotive = TimedLocomotive::new(locomotive);
    let mut rig = TimedRig::new(emulated_rig(&run), SILENCE_TICKS);
    let mut ticks = 0;
    while locomotive.locomotive().state().state != State::Run {
        locomotive.tick(&mut at_locomotive, 0);
        rig.tick(&mut at_rig);
        ticks += 1;
        assert!(ticks < MOST_TICKS);
    }
    let mut faults = 0;
    for tick in 0..SILENCE_TICKS + 100 {
        let is_safe = rig.rig().run_state() == RunState::Safe;
        assert_eq!(is_safe, tick >= SILENCE_TICKS, "{tick}");
        rig.tick(&mut at_rig);
        while let Some(frame) = nodes::can::receive(&mut at_locomotive) {
            let fault = Fault::decode(frame.id(), frame.data());
            faults += u32::from(fault.is_ok_and(|fault| fault.code == FaultCode::PeerSilent));
        }
    }
    assert!(rig.rig().is_at_rest());
    assert_eq!(faults, 1);
}
