//! Who may command, in virtual time: foreign frames, old logs, a second host, a rig that rebooted.
//! The rows are those that moved a ram, or passed unnoticed, before rigs were armed.

use crate::support::host::{Host, setup};
use crate::support::locomotive::{NODE, scenario, session};
use crate::support::rig::{FedRig, answers, arm, armed, give, measured, quiet};
use can_protocol::arming::Refusal;
use can_protocol::{
    ArmItem, Command, FaultCode, Frame, Heartbeat, Measurement, Message, MessageId, Mode, Node,
    Pace as WirePace, Pressure, PressureOff, Profile, RunState, Seal, Sender,
};
use firmware_core::supervision::{Action, Signal};
use hil_host::bus::{Bus, BusCounters, MemoryBus, Sent, WireFrame};
use hil_host::clock::Tick;
use hil_host::control::{Buses, NoAnswer, Requests, Session, SessionState, Stop};
use hil_host::faults::{Fault, FaultyBus, Injection, Opener, inject};
use hil_host::record::Queues;
use hil_host::rig::{Condition, RigNode};
use hil_host::{Draw, reset_over};
use std::collections::VecDeque;
use std::time::Duration;

/// Cycle in which somebody else begins to send.
const BEGIN: u64 = 2000;

/// What else arrives in a cycle, given the rig's measurement and its seal: before it, and after it.
type Others = Box<dyn FnMut(u64, &WireFrame, Seal) -> [Vec<WireFrame>; 2]>;

/// A bus on which somebody else sends too.
struct Shared {
    bus: MemoryBus,
    cycle: u64,
    others: Others,
    /// What the host has sent.
    commands: Vec<WireFrame>,
    pending: VecDeque<WireFrame>,
    opener: Opener,
}

impl Shared {
    fn new(rig: RigNode, others: Others) -> Self {
        Self {
            bus: MemoryBus::new(Some(rig)),
            cycle: 0,
            others,
            commands: Vec::new(),
            pending: VecDeque::new(),
            opener: Opener::default(),
        }
    }
}

impl Bus for Shared {
    fn send(&mut self, frame: &Frame) -> Sent {
        let frame_on_wire = WireFrame::from(frame);
        self.opener.hear(NODE, &frame_on_wire);
        if frame.id() == MessageId::Command(Profile::Classical, NODE).raw() {
            self.cycle += 1;
            self.commands.push(frame_on_wire);
        }
        self.bus.send(frame)
    }

    fn receive(&mut self) -> Option<WireFrame> {
        if self.pending.is_empty() {
            let frame = self.bus.receive()?;
            let seal = self.opener.hear(NODE, &frame);
            match (self.cycle.checked_sub(BEGIN), seal) {
                (Some(since), Some(seal)) => {
                    let [before, after] = (self.others)(since, &frame, seal);
                    self.pending.extend(before);
                    self.pending.push_back(frame);
                    self.pending.extend(after);
                }
                _ => self.pending.push_back(frame),
            }
        }
        self.pending.pop_front()
    }

    fn wait(&mut self, timeout: Duration) -> bool {
        !self.pending.is_empty() || self.bus.wait(timeout)
    }

    fn counters(&self) -> BusCounters {
        self.bus.counters()
    }
}

fn laboratory_rig() -> RigNode {
    RigNode::new(&setup(), NODE, Profile::Classical)
}

fn cycles(session: &Session<'_>, state: &mut SessionState, bus: &mut Shared, count: u64) {
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let until = state.line.cycle + count;
    while state.line.cycle < until && state.stop.is_none() {
        let buses = std::slice::from_mut(bus);
        session.cycle(state, &mut Buses::new(buses, &mut recorder), Tick::default());
    }
}

/// What stops a run of 3000 cycles while somebody else sends, and how many cycles after `BEGIN`.
fn stopped_by(
    others: impl FnMut(u64, &WireFrame, Seal) -> [Vec<WireFrame>; 2] + 'static,
) -> Option<(Stop, u64)> {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let mut bus = Shared::new(RigNode::new(&run.rig, NODE, Profile::Classical), Box::new(others));
    let buses = std::slice::from_mut(&mut bus);
    session.greet(&mut state, buses, Duration::from_secs(1), &Requests::armed()).unwrap();
    bus.cycle = 0;
    cycles(&session, &mut state, &mut bus, BEGIN + 1000);
    let stop = state.stop?;
    if stop.cause.signal == Signal::SecondSender {
        assert_eq!(stop.cause.action, Action::Stop);
        assert!(state.line.is_safe());
    }
    Some((stop, stop.cycle - BEGIN))
}

/// The id that the cause names, and the cycles.
fn second_sender(found: Option<(Stop, u64)>) -> Option<(u16, u64)> {
    let (stop, cycles) = found?;
    assert_eq!(stop.cause.signal, Signal::SecondSender, "{stop}");
    Some((stop.cause.value as u16, cycles))
}

fn spoilt(frame: &WireFrame) -> WireFrame {
    let mut data = frame.data().to_vec();
    data[3] ^= 0x10;
    WireFrame::new(frame.id(), false, &data).unwrap()
}

/// The same measurement with another force.
fn liar(frame: &WireFrame, seal: Seal) -> Measurement {
    let sound = Measurement::decode_sealed(frame.id(), frame.data(), seal).unwrap();
    Measurement { force_n: Some(30e3), ..sound }
}

#[test]
fn one_frame_of_the_dbc_moved_an_idle_ram_by_3_mm() {
    // 101#184328870050E222, the worked example, before and after the handshake.
    let example = Command {
        node: NODE,
        counter: 3,
        state: RunState::Run,
        mode: Mode::FollowWithVelocity,
        echo: Some(2),
        displacement_m: Some(3.46e-3),
        velocity_m_per_s: Some(-0.076),
        time_us: None,
    };
    let (frame, _) = example.encode(Profile::Classical);
    assert_eq!(frame.to_string(), "101#184328870050E222");
    for pace in [WirePace::LockStep, WirePace::Clock] {
        let mut rig = FedRig::from(RigNode::new(&quiet(), NODE, Profile::Classical));
        let mut host = Host::new(Profile::Classical);
        for state in [RunState::Init, RunState::Standby, RunState::Armed] {
            for _ in 0..20 {
                give(&mut rig, &frame);
                rig.cycle();
            }
            assert_eq!((rig.run_state(), rig.runs()), (state, 0));
            assert_eq!(rig.physics().ram().displacement_m, 0.0);
            let sync = host.sync_message(pace);
            if state == RunState::Init {
                give(&mut rig, &sync.encode());
            } else if state == RunState::Standby {
                answers(&mut rig);
                arm(&mut rig, &mut host, &sync);
            }
        }
        assert_eq!(rig.frames().unarmed, 40);
        assert_eq!((rig.frames().received, rig.frames().crc_errors), (0, 20));
    }
}

#[test]
fn a_replayed_log_drove_a_ram_without_a_host() {
    // Everything that a host sent in a session, handshake and all.
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let nobody = |_: u64, _: &WireFrame, _: Seal| [vec![], vec![]];
    let mut bus = Logged { bus: Shared::new(laboratory_rig(), Box::new(nobody)), log: vec![] };
    let buses = std::slice::from_mut(&mut bus);
    session.greet(&mut state, buses, Duration::from_secs(1), &Requests::armed()).unwrap();
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    for _ in 0..2001 {
        let buses = std::slice::from_mut(&mut bus);
        session.cycle(&mut state, &mut Buses::new(buses, &mut recorder), Tick::default());
    }
    assert_eq!(bus.bus.bus.rigs()[0].runs(), 1);
    // The same rig, started again: its number is another one.
    let rebooted = laboratory_rig().with_draw(Draw::seeded(99, 0));
    let mut other = MemoryBus::new(Some(rebooted));
    for frame in &bus.log {
        other.inject(frame);
        other.wait(Duration::ZERO);
    }
    let rig = &other.rigs()[0];
    assert_eq!((rig.runs(), rig.frames().received), (0, 0));
    assert!(rig.frames().unarmed > 2000);
    assert_eq!(rig.physics().ram().displacement_m, 0.0);
    assert!(!rig.is_armed() && !rig.is_latched());
}

/// A bus that keeps what the host sends.
struct Logged {
    bus: Shared,
    log: Vec<WireFrame>,
}

impl Bus for Logged {
    fn send(&mut self, frame: &Frame) -> Sent {
        self.log.push(WireFrame::from(frame));
        self.bus.send(frame)
    }
    fn receive(&mut self) -> Option<WireFrame> {
        self.bus.receive()
    }
    fn wait(&mut self, timeout: Duration) -> bool {
        self.bus.wait(timeout)
    }
    fn counters(&self) -> BusCounters {
        self.bus.counters()
    }
}

#[test]
fn foreign_frames_moved_the_ram_to_50_mm() {
    let mut host = Host::new(Profile::Classical);
    let mut rig = armed(&quiet(), &mut host, WirePace::LockStep);
    let mut stranger = Host::new(Profile::Classical);
    let mut heard = Vec::new();
    for _ in 0..300 {
        give(&mut rig, &host.run());
        let mode = Mode::Follow;
        give(&mut rig, &stranger.say(RunState::Run, mode, Some(50e-3), Some(0.0)));
        heard.extend(answers(&mut rig));
    }
    assert_eq!(rig.frames().received, 300);
    assert!(rig.physics().ram().displacement_m.abs() < 4e-3);
    // The first of them is evidence in the next cycle, and the rig is safe by itself.
    let faults: Vec<_> = heard
        .iter()
        .filter_map(|message| match message {
            Message::Fault(fault) => Some((fault.code, fault.detail)),
            _ => None,
        })
        .collect();
    assert_eq!(faults, [(FaultCode::Protection, 0x101)]);
    let first = heard.iter().position(|message| matches!(message, Message::Fault(_)));
    assert!(first.is_some_and(|at| at <= 2), "{first:?}");
    assert_eq!(rig.run_state(), RunState::Safe);
}

#[test]
fn a_second_host_was_accepted() {
    // Its announcement and its heartbeat are evidence in the cycle in which they arrive.
    let says = |frame: Frame| {
        let frame = WireFrame::from(&frame);
        second_sender(stopped_by(move |since, _, _| {
            [if since == 0 { vec![frame.clone()] } else { vec![] }, vec![]]
        }))
    };
    let stranger = Host::new(Profile::Classical);
    assert_eq!(says(stranger.sync_message(WirePace::LockStep).encode()), Some((0x080, 0)));
    let heartbeat = Heartbeat::new(Sender::Host, 0, RunState::Standby, 77).encode().0;
    assert_eq!(says(heartbeat), Some((0x700, 0)));
    // Its plain commands too; those that another session seals take three of ten cycles.
    assert_eq!(says(Host::new(Profile::Classical).run()), Some((0x101, 0)));
    let mut stranger = Host::new(Profile::Classical);
    let code = can_protocol::SessionCode::of(3, 4);
    (stranger.code, stranger.sent) = (Some(code), 700);
    let sealed = stopped_by(move |_, _, _| [vec![WireFrame::from(&stranger.run())], vec![]]);
    let (id, cycles) = second_sender(sealed).unwrap();
    assert!(id == 0x101 && cycles == 2, "{cycles}");
    // Before the run it is refused by name.
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let mut bus = Loud(MemoryBus::new(Some(laboratory_rig())), 0);
    let buses = std::slice::from_mut(&mut bus);
    let refused = session.greet(&mut state, buses, Duration::from_secs(1), &Requests::armed());
    let Err(NoAnswer::Refused { node: 1, refusal: Refusal::NotQuiet(heard) }) = refused else {
        panic!("{refused:?}")
    };
    assert_eq!(heard.to_string(), "HEARTBEAT_HOST of another host");
}

/// A bus with the heartbeats of another host.
struct Loud(MemoryBus, u64);

impl Bus for Loud {
    fn send(&mut self, frame: &Frame) -> Sent {
        self.0.send(frame)
    }
    fn receive(&mut self) -> Option<WireFrame> {
        if self.1.is_multiple_of(20) && self.1 > 0 {
            self.1 += 1;
            let heartbeat = Heartbeat::new(Sender::Host, 0, RunState::Run, 77).encode().0;
            return Some(WireFrame::from(&heartbeat));
        }
        self.0.receive()
    }
    fn wait(&mut self, timeout: Duration) -> bool {
        self.1 += 1;
        self.0.wait(timeout)
    }
    fn counters(&self) -> BusCounters {
        self.0.counters()
    }
}

#[test]
fn a_second_answer_to_one_counter_with_another_force_was_used_or_ignored() {
    for is_first in [false, true] {
        let found = second_sender(stopped_by(move |since, frame, seal| {
            let lie = liar(frame, seal).encode_sealed(Profile::Classical, seal).0;
            let lie = if since == 5 { vec![WireFrame::from(&lie)] } else { vec![] };
            if is_first { [lie, vec![]] } else { [vec![], lie] }
        }));
        assert_eq!(found, Some((0x201, 5)), "{is_first}");
    }
}

#[test]
fn a_plain_measurement_next_to_a_sealed_one_is_a_second_sender_at_once() {
    let found = second_sender(stopped_by(|since, frame, seal| {
        let plain = liar(frame, seal).encode(Profile::Classical).0;
        [vec![], if since == 5 { vec![WireFrame::from(&plain)] } else { vec![] }]
    }));
    assert_eq!(found, Some((0x201, 5)));
}

#[test]
fn three_of_ten_cycles_with_a_bad_frame_next_to_a_good_one_are_a_second_sender() {
    let each = |gap: u64| {
        second_sender(stopped_by(move |since, frame, _| {
            // Once in 256 a spoilt copy is a valid plain frame, and evidence of its own.
            let is_spoilt = since % gap == 0 && since < 300;
            [vec![], if is_spoilt { vec![spoilt(frame)] } else { vec![] }]
        }))
    };
    assert_eq!(each(1), Some((0x201, 2)));
    assert_eq!(each(4), Some((0x201, 8)));
    assert_eq!(each(5), None);
}

#[test]
fn a_repeat_bit_for_bit_is_no_second_sender() {
    let found = stopped_by(|_, frame, _| [vec![], vec![frame.clone()]]);
    assert_eq!(found.map(|(stop, _)| stop.to_string()), None);
}

#[test]
fn a_rig_that_rebooted_in_a_run_was_armed_by_the_next_command() {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let nobody = |_: u64, _: &WireFrame, _: Seal| [vec![], vec![]];
    let mut bus = Shared::new(laboratory_rig(), Box::new(nobody));
    let buses = std::slice::from_mut(&mut bus);
    session.greet(&mut state, buses, Duration::from_secs(1), &Requests::armed()).unwrap();
    cycles(&session, &mut state, &mut bus, 1500);
    bus.bus.rigs_mut()[0] = laboratory_rig().with_draw(Draw::seeded(7, 7));
    cycles(&session, &mut state, &mut bus, 1000);
    let stop = state.stop.unwrap();
    assert_eq!(stop.cause.signal, Signal::LostMeasurements);
    // The last measurement is used in cycle 1500; the fifth cycle without one stops.
    assert_eq!(stop.cycle, 1500 + 5);
    let rig = &bus.bus.rigs()[0];
    // It has heard a sync since, and no command.
    assert_eq!((rig.run_state(), rig.is_armed(), rig.runs()), (RunState::Standby, false, 0));
    assert_eq!(rig.physics().ram().displacement_m, 0.0);
}

#[test]
fn a_displacement_that_is_not_believed_asks_for_the_pressure_off() {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    // The rig itself is sound; what arrives of it is 60 mm off.
    let mut bus = FaultyBus::new(&run.rig, NODE, 1);
    let fault = Fault::StuckDisplacement(60e-3);
    let injection = Injection { fault, begin: BEGIN, lasts: u64::MAX, until: BEGIN + 1000 };
    let injected = inject(&session, &run, &mut bus, &injection).unwrap();
    let stop = injected.stop.unwrap();
    assert_eq!(stop.cause.action, Action::PowerOff);
    assert!(injected.cycles_to_detect().is_some_and(|cycles| cycles <= 2), "{stop}");
    assert_eq!((injected.rig, injected.violation), (RunState::Fault, None));
    let rig = bus.rig().unwrap();
    assert!(rig.is_latched() && rig.is_at_rest());
}

#[test]
fn pressure_off_is_obeyed_in_every_state_and_latched() {
    let off = |node| {
        let (counter, state, code) = (14, RunState::Safe, FaultCode::Sensor);
        PressureOff { node, counter, state, code, detail: 2 }.encode().0
    };
    let mut host = Host::new(Profile::Classical);
    let idle = FedRig::from(RigNode::new(&quiet(), NODE, Profile::Classical));
    let mut moving = armed(&quiet(), &mut host, WirePace::LockStep);
    for _ in 0..100 {
        give(&mut moving, &host.run());
        answers(&mut moving);
    }
    let mut obeys = |mut rig: FedRig, node: Option<Node>| {
        give(&mut rig, &off(Some(Node::ALL[1])));
        assert!(!rig.is_latched(), "another node's");
        give(&mut rig, &off(node));
        assert_eq!(rig.run_state(), RunState::Fault);
        let heard = answers(&mut rig);
        let [Message::Fault(fault)] = heard[..] else { panic!("{heard:?}") };
        assert_eq!((fault.code, fault.state), (FaultCode::PressureLost, RunState::Fault));
        let mut pressures = Vec::new();
        for _ in 0..60 {
            rig.cycle();
            for message in answers(&mut rig) {
                if let Message::Telemetry(telemetry) = message {
                    pressures.push(telemetry.pressure);
                }
            }
        }
        assert!(!pressures.is_empty() && pressures.iter().all(|off| *off == Pressure::Off));
        assert!(rig.is_at_rest());
        // No command moves it.
        give(&mut rig, &host.run());
        rig.cycle();
        assert_eq!(rig.run_state(), RunState::Fault);
    };
    obeys(idle, None);
    obeys(moving, Some(NODE));
}

#[test]
fn a_latched_rig_is_reset_over_the_bus_and_no_other() {
    let reset = |bus: &mut MemoryBus| {
        reset_over(bus, NODE, Draw::seeded(5, 0), Duration::ZERO).map_err(|why| why.to_string())
    };
    let mut bus = MemoryBus::new(Some(laboratory_rig()));
    let unlatched = reset(&mut bus).unwrap_err();
    assert_eq!(unlatched, "the rig refused: STATE");
    bus.inject(&WireFrame::from(
        &Host::new(Profile::Classical).sync_message(WirePace::LockStep).encode(),
    ));
    assert_eq!(reset(&mut bus).unwrap_err(), "the rig refused: STATE");
    let off = PressureOff {
        node: None,
        counter: 0,
        state: RunState::Safe,
        code: FaultCode::Sensor,
        detail: 2,
    };
    bus.inject(&WireFrame::from(&off.encode().0));
    assert_eq!(bus.rigs()[0].run_state(), RunState::Fault);
    assert_eq!(reset(&mut bus), Ok(()));
    assert_eq!(bus.rigs()[0].run_state(), RunState::Init);
    let condition = Condition { may_reset: false, ..bus.rigs()[0].condition() };
    let keyed = laboratory_rig().with_condition(condition);
    let mut bus = MemoryBus::new(Some(keyed));
    bus.inject(&WireFrame::from(&off.encode().0));
    assert_eq!(reset(&mut bus).unwrap_err(), "the rig refused: RESET");
    assert!(reset_over(&mut bus, Node::ALL[1], Draw::seeded(5, 0), Duration::ZERO).is_err());
}

#[test]
fn a_rig_that_is_not_ready_is_refused_by_item_and_a_key_that_is_turned_off_is_safe() {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let ready = laboratory_rig().condition();
    let refused = |condition: Condition| {
        let mut state = session.start(session.line.start(run.start.state.clone()));
        let mut bus = MemoryBus::new(Some(laboratory_rig().with_condition(condition)));
        let buses = std::slice::from_mut(&mut bus);
        let patience = Duration::from_secs(1);
        match session.greet(&mut state, buses, patience, &Requests::armed()) {
            Err(NoAnswer::Refused { node: 1, refusal }) => refusal,
            other => panic!("{other:?}"),
        }
    };
    for (condition, item) in [
        (Condition { zero_age_s: None, ..ready }, ArmItem::ZeroAge),
        (Condition { zero_age_s: Some(9 * 3600), ..ready }, ArmItem::ZeroAge),
        (Condition { shunt_passed: false, ..ready }, ArmItem::ShuntCheck),
    ] {
        let Refusal::ByHost(shortfall) = refused(condition) else { panic!("{item}") };
        assert_eq!(shortfall.item, item);
    }
    let weak = can_protocol::arming::Limits { velocity_um_per_s: 49_999, ..ready.limits };
    let Refusal::ByHost(shortfall) = refused(Condition { limits: weak, ..ready }) else { panic!() };
    assert_eq!((shortfall.item, shortfall.needed), (ArmItem::Velocity, 50_000));
    // The rig's own key.
    let off = refused(Condition { enabled: false, ..ready });
    assert_eq!(off, Refusal::ByRig(ArmItem::Enabled));
    let mut host = Host::new(Profile::Classical);
    let mut rig = armed(&quiet(), &mut host, WirePace::LockStep);
    give(&mut rig, &host.run());
    assert_eq!(measured(&mut rig).state, RunState::Run);
    rig.enable(false);
    give(&mut rig, &host.run());
    assert_eq!(measured(&mut rig).state, RunState::Safe);
}

#[test]
fn tighter_limits_of_a_rig_are_taken() {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let ready = laboratory_rig().condition();
    let limits =
        can_protocol::arming::Limits { velocity_um_per_s: 60_000, force_n: 5000, ..ready.limits };
    let rig = laboratory_rig().with_condition(Condition { limits, ..ready });
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let nobody = |_: u64, _: &WireFrame, _: Seal| [vec![], vec![]];
    let mut bus = Shared::new(rig, Box::new(nobody));
    let buses = std::slice::from_mut(&mut bus);
    session.greet(&mut state, buses, Duration::from_secs(1), &Requests::armed()).unwrap();
    assert_eq!(state.line.slots[0].limits.velocity_m_per_s, 0.06);
    assert_eq!(state.line.slots[0].limits.stroke_m, run.motion.stroke_m);
    let agreement = state.ports[0].agreement().unwrap();
    assert_eq!(agreement.configuration.limits.force_n, 5000);
    // The damper pulls with more than that.
    cycles(&session, &mut state, &mut bus, 3000);
    let stop = state.stop.unwrap();
    assert_eq!((stop.cause.signal, stop.cause.limit), (Signal::Force, 5000.0));
}

#[test]
fn an_armed_rig_whose_first_command_never_comes_goes_back_to_standby() {
    let mut host = Host::new(Profile::Classical);
    let mut rig = armed(&quiet(), &mut host, WirePace::LockStep);
    assert_eq!(rig.run_state(), RunState::Armed);
    (0..501).for_each(|_| rig.idle());
    assert_eq!(rig.run_state(), RunState::Standby);
    give(&mut rig, &host.run());
    assert_eq!((rig.frames().unarmed, rig.runs()), (1, 0));
}
