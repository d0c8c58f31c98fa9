//! Several rigs of one vehicle, and going on without one of them, in virtual time with exact
//! cycles.

use crate::support::locomotive::{NODE, scenario, session};
use can_protocol::{Frame, MessageId, Node, Pace as WirePace, Profile, RunState, Trips};
use firmware_core::supervision::{Signal, State};
use hil_host::bus::{Bus, BusCounters, MemoryBus, Sent, WireFrame};
use hil_host::clock::Tick;
use hil_host::control::{Buses, End, Requests, SessionState, Stop};
use hil_host::faults::{
    Fault, FaultyBus, Injected, Injection, drop_out_rows, drop_outs, inject, on_rigs,
};
use hil_host::record::{ForceSource, Queues, Row};
use hil_host::rig::RigNode;
use scenario::run::{IfRigDropsOut, Run};
use std::time::Duration;

/// Cycle in which a fault begins.
const BEGIN: u64 = 2000;
/// Cycles in which a force that is not believed leaves the vehicle.
const FADE: u64 = 20;

/// The locomotive with so many rigs, which drop out or stop the run.
fn on(rigs: usize, if_lost: IfRigDropsOut) -> Run {
    on_rigs(&scenario(), rigs, if_lost)
}

/// A fault of the first of so many rigs.
fn injected(rigs: usize, if_lost: IfRigDropsOut, fault: Fault, lasts: u64) -> Injected {
    let run = on(rigs, if_lost);
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let mut bus = FaultyBus::new(&run.rig, NODE, 1).beside(Node::ALL.into_iter().take(rigs));
    let injection = Injection { fault, begin: BEGIN, lasts, until: BEGIN + 2500 };
    inject(&session, &run, &mut bus, &injection).unwrap()
}

#[test]
fn a_rig_drops_out_in_the_cycle_in_which_it_stopped_the_run() {
    let faults = [
        (Fault::Gone, Signal::LostMeasurements, 4),
        (Fault::LoseMeasurements { lost: 1, of: 1 }, Signal::LostMeasurements, 4),
        (Fault::InvalidForce, Signal::InvalidForce, 4),
        (Fault::InvalidDisplacement, Signal::InvalidDisplacement, 4),
        (Fault::StuckForce(99.9e3), Signal::ForceRate, 1),
        (Fault::StuckDisplacement(60e-3), Signal::Velocity, 0),
        (Fault::Trips(Trips::EMERGENCY_STOP), Signal::RigTrip, 0),
        (Fault::ReportFault, Signal::RigFault, 0),
        (Fault::Says(RunState::Safe), Signal::RigState, 0),
        (Fault::FlipBits { bits: 1, every: 1 }, Signal::WrongSeal, 4),
    ];
    for (fault, signal, cycles) in faults {
        for rigs in [1, 3] {
            let today = injected(rigs, IfRigDropsOut::Stop, fault, u64::MAX);
            let stop = today.stop.unwrap();
            assert_eq!(today.dropped_out, None);
            let found = injected(rigs, IfRigDropsOut::Model, fault, u64::MAX);
            let lost = found.dropped_out.unwrap();
            let of = |stop: Stop| (stop.cause.signal, stop.cycle - BEGIN);
            assert_eq!((of(lost), of(stop)), ((signal, cycles), (signal, cycles)), "{fault:?}");
            assert_eq!(lost.node, Some(1));
            assert_eq!(found.violation, None, "{fault:?} {rigs}");
            // With one rig nothing real is left.
            let end = (rigs == 1).then_some(End::RampedOut);
            assert_eq!((found.end, found.stop.is_some()), (end, rigs == 1), "{fault:?} {rigs}");
            let again = injected(rigs, IfRigDropsOut::Model, fault, u64::MAX);
            assert_eq!(found, again, "{fault:?} {rigs}");
        }
    }
}

#[test]
fn every_fault_of_one_rig_has_it_drop_out_in_time_alone_and_beside_two_others() {
    for others in [2, 0] {
        let mut wrong = Vec::new();
        let all_right = drop_outs(&scenario(), others, |row, injected, is_right| {
            if !is_right {
                wrong.push(format!("{} {}: {injected:?}", row.number, row.what));
            }
        });
        assert_eq!(wrong, Vec::<String>::new(), "{others} others");
        assert!(all_right.unwrap());
    }
    assert!(drop_out_rows(2).len() > 40, "{}", drop_out_rows(2).len());
}

#[test]
fn a_second_sender_and_a_host_without_room_still_end_the_run() {
    for fault in [Fault::PlainSender, Fault::NoRoom { full: 2, of: u64::MAX }] {
        let found = injected(3, IfRigDropsOut::Model, fault, u64::MAX);
        assert!(found.dropped_out.is_none() && found.stop.is_some(), "{fault:?}: {found:?}");
    }
}

/// Rigs in memory, whose measurements are lost in some cycles of the session.
struct Unplugged {
    bus: MemoryBus,
    /// Node, first and last cycle.
    lost: Vec<(Node, u64, u64)>,
    /// Commands to each node since the coupling.
    cycles: [u64; 4],
}

impl Unplugged {
    fn new(run: &Run, rigs: usize, lost: &[(usize, u64, u64)]) -> Self {
        let nodes = Node::ALL.into_iter().take(rigs);
        let bus = MemoryBus::new(nodes.map(|node| RigNode::new(&run.rig, node, PROFILE)));
        let lost = lost.iter().map(|(rig, from, to)| (Node::ALL[*rig], *from, *to)).collect();
        Self { bus, lost, cycles: [0; 4] }
    }
}

const PROFILE: Profile = Profile::Classical;

impl Bus for Unplugged {
    fn send(&mut self, frame: &Frame) -> Sent {
        for (number, node) in Node::ALL.into_iter().enumerate() {
            let is_its = frame.id() == MessageId::Command(PROFILE, node).raw();
            self.cycles[number] += u64::from(is_its);
        }
        self.bus.send(frame)
    }
    fn receive(&mut self) -> Option<WireFrame> {
        loop {
            let frame = self.bus.receive()?;
            let is_lost = self.lost.iter().any(|(node, from, to)| {
                let cycle = self.cycles[usize::from(node.number()) - 1];
                frame.id() == MessageId::Measurement(PROFILE, *node).raw()
                    && (*from..*to).contains(&cycle)
            });
            if !is_lost {
                return Some(frame);
            }
        }
    }
    fn wait(&mut self, timeout: Duration) -> bool {
        self.bus.wait(timeout)
    }
    fn counters(&self) -> BusCounters {
        self.bus.counters()
    }
}

/// So many cycles of a run whose measurements are lost (rig, first and last cycle).
fn course(run: &Run, rigs: usize, lost: &[(usize, u64, u64)], cycles: u64) -> Ran {
    let track = run.track.view();
    let session = session(run, &track, WirePace::LockStep);
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let mut bus = Unplugged::new(run, rigs, lost);
    let buses = std::slice::from_mut(&mut bus);
    session.greet(&mut state, buses, Duration::from_secs(1), &Requests::armed()).unwrap();
    bus.cycles = [0; 4];
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let mut rows = Vec::new();
    for _ in 0..cycles {
        let mut buses = Buses::new(std::slice::from_mut(&mut bus), &mut recorder);
        rows.push(session.cycle(&mut state, &mut buses, Tick::default()));
    }
    let rigs = bus.bus.rigs().iter().map(RigNode::run_state).collect();
    let is_faded_out = session.line.is_faded_out(&state.line);
    Ran { rows, state, rigs, is_faded_out }
}

/// What became of it.
struct Ran {
    rows: Vec<Row>,
    state: SessionState,
    rigs: Vec<RunState>,
    is_faded_out: bool,
}

/// First cycle of rows in which a slot ran on its model.
fn dropped_out(rows: &[Row], slot: usize) -> u64 {
    rows.iter().find(|row| row.force_source[slot] == ForceSource::DroppedOut).unwrap().cycle
}

#[test]
fn one_of_three_rigs_leaves_and_stays_out_although_it_comes_back() {
    let run = on(3, IfRigDropsOut::Model);
    let ran = course(&run, 3, &[(0, BEGIN, BEGIN + 50)], BEGIN + 1500);
    // The measurement of the last command before is used in the cycle behind it.
    let out = dropped_out(&ran.rows, 0);
    assert_eq!(out, BEGIN + 5);
    for row in &ran.rows[out as usize - 1..] {
        assert_eq!((row.state, row.force_source[0]), (RunState::Run, ForceSource::DroppedOut));
        assert_eq!(row.force_source[1..], [ForceSource::Rig, ForceSource::Rig, ForceSource::Model]);
        assert_eq!((row.coupling[1], row.coupling[2]), (1.0, 1.0));
        let is_faded = row.cycle >= out + FADE - 1;
        assert_eq!(row.coupling[0] == 0.0, is_faded, "{}", row.cycle);
        if is_faded {
            assert_eq!(row.force_n[0], row.model_n[0]);
        }
    }
    // From the fade's first cycle on the force moves no further than model and fade do.
    for pair in ran.rows[out as usize - 2..].windows(2) {
        let [before, now] = pair else { continue };
        let model_n = (now.model_n[0] - before.model_n[0]).abs();
        let gain = before.coupling[0] - now.coupling[0];
        let held_n = ran.state.line.slots[0].guard.force_n;
        let most_n = model_n + gain * (held_n - before.model_n[0]).abs() + 1e-6;
        let step_n = (now.force_n[0] - before.force_n[0]).abs();
        assert!(gain <= 0.08 && step_n <= most_n, "{}: {step_n} {most_n}", now.cycle);
    }
    // The model was in step: what the rig measured before was its force.
    let before = &ran.rows[BEGIN as usize - 1000..BEGIN as usize];
    let rms = |of: &dyn Fn(&Row) -> f64| {
        (before.iter().map(|row| of(row).powi(2)).sum::<f64>() / before.len() as f64).sqrt()
    };
    let (off_n, force_n) =
        (rms(&|row| row.force_n[0] - row.model_n[0]), rms(&|row| row.force_n[0]));
    assert!(off_n < 0.1 * force_n && force_n > 500.0, "{off_n} of {force_n} N");
    // It heard SAFE, and its ram rests; the others go on.
    assert_eq!(ran.rigs, [RunState::Safe, RunState::Run, RunState::Run]);
    let last = ran.rows.last().unwrap();
    assert_eq!((last.command_m_per_s[0], last.age_cycles[0]), (0.0, u8::MAX));
    assert!(last.command_m_per_s[1] != 0.0);
    assert_eq!(ran.state.stop, None);
    // Bit for bit the same again.
    let again = course(&run, 3, &[(0, BEGIN, BEGIN + 50)], BEGIN + 1500);
    assert_eq!(ran.state.hash, again.state.hash);
    assert!(ran.state.line.vehicle.is_finite());
}

#[test]
fn a_second_rig_may_follow_and_with_the_last_one_the_run_is_ramped_out() {
    let run = on(3, IfRigDropsOut::Model);
    let ever = u64::MAX;
    let lost = [(0, BEGIN, ever), (2, BEGIN + 300, ever), (1, BEGIN + 700, ever)];
    let ran = course(&run, 3, &lost, BEGIN + 1200);
    let out = [0, 2, 1].map(|slot| dropped_out(&ran.rows, slot));
    assert_eq!(out, [BEGIN + 5, BEGIN + 305, BEGIN + 705]);
    let stop = ran.state.stop.unwrap();
    assert_eq!((stop.node, stop.cycle + 1), (Some(2), out[2]));
    for row in &ran.rows {
        let is_out = row.cycle >= out[2];
        let is_in = row.cycle <= 1000;
        let state = match () {
            () if is_out => RunState::RampOut,
            () if is_in => RunState::RampIn,
            () => RunState::Run,
        };
        assert_eq!(row.state, state, "{}", row.cycle);
    }
    assert!(ran.is_faded_out && ran.state.line.state == State::RampOut);
    assert_eq!(ran.rigs, [RunState::Safe; 3]);
}

#[test]
fn a_rig_that_is_lost_before_run_ends_the_run() {
    let run = on(3, IfRigDropsOut::Model);
    let ran = course(&run, 3, &[(0, 700, 800)], 900);
    let stop = ran.state.stop.unwrap();
    assert_eq!((stop.cause.signal, ran.state.line.state), (Signal::LostMeasurements, State::Safe));
    assert!(ran.state.ports.iter().all(|port| !port.has_dropped_out()));
}

#[test]
fn a_rig_whose_slot_does_not_allow_it_still_ends_the_run() {
    let mut run = on(3, IfRigDropsOut::Model);
    let scenario::run::SlotForce::Rig { if_drops_out, .. } = &mut run.slots[1].force else {
        panic!("no rig")
    };
    *if_drops_out = IfRigDropsOut::Stop;
    let ran = course(&run, 3, &[(0, BEGIN, u64::MAX), (1, BEGIN + 200, u64::MAX)], BEGIN + 400);
    assert!(ran.state.ports[0].has_dropped_out() && !ran.state.ports[1].has_dropped_out());
    let stop = ran.state.stop.unwrap();
    assert_eq!((stop.node, ran.state.line.state), (Some(2), State::Safe));
    assert_eq!(ran.rigs, [RunState::Safe; 3]);
}

#[test]
fn what_a_lost_rig_stood_for_goes_on_with_its_own_model() {
    let tables = "[[slot]]\nplace = \"front right\"\non = \"partner\"\nof = \"front left\"\n\
        [[slot]]\nplace = \"rear left\"\non = \"rig\"\nnode = 2\nif_rig_drops_out = \"model\"\n";
    let mut run = crate::support::locomotive::scenario_with(tables);
    let scenario::run::SlotForce::Rig { if_drops_out, .. } = &mut run.slots[0].force else {
        panic!("no rig")
    };
    *if_drops_out = IfRigDropsOut::Model;
    let ran = course(&run, 2, &[(0, BEGIN, u64::MAX)], BEGIN + 300);
    let out = dropped_out(&ran.rows, 0);
    assert_eq!((out, dropped_out(&ran.rows, 1)), (BEGIN + 5, BEGIN + 5));
    let before = &ran.rows[out as usize - 2];
    assert_eq!(before.force_source[1], ForceSource::StandIn);
    assert_eq!(before.force_n[1], -before.force_n[0]);
    for row in &ran.rows[out as usize + FADE as usize..] {
        assert_eq!(row.force_n[1], row.model_n[1]);
        assert!(row.force_n[1] != -row.force_n[0]);
    }
}
