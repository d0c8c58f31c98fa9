//! Same frames, same answers, bit for bit: twice, after a clone in the middle, on the memory bus.

use crate::support::host::{Host, setup};
use crate::support::rig::{arm, armed, give};
use can_protocol::{Measurement, Mode, Node, Pace, Profile, RunState, Seal, SessionCode, Sync};
use hil_host::bus::QUEUE_FRAMES;
use hil_host::bus::{Bus, BusCounters, MemoryBus, Sent, WireFrame};
use hil_host::rig::RigNode;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::time::Duration;

const CYCLES: usize = 3000;

fn hash_of(rig: &mut RigNode, hasher: &mut DefaultHasher) {
    while let Some(frame) = rig.take_frame() {
        (frame.id(), frame.data()).hash(hasher);
    }
}

/// Answers to a run with holds, a stop and a new arming in it; cloned at `switch` if given.
fn run(switch: Option<usize>) -> u64 {
    let mut host = Host::new(Profile::Classical);
    let mut rig = armed(&setup(), &mut host, Pace::LockStep);
    let mut hasher = DefaultHasher::new();
    for cycle in 0..CYCLES {
        if cycle == 1601 {
            // The force of the damper fades.
            (0..500).for_each(|_| rig.idle());
            let sync = host.sync_message(Pace::LockStep);
            give(&mut rig, &sync.encode());
            arm(&mut rig, &mut host, &sync);
            // The ram stands about where the motion was then.
            host.cycle = 1500;
        }
        let frame = match cycle {
            700..=720 => host.say(RunState::Run, Mode::Hold, None, None),
            1500..=1599 => host.state(RunState::RampOut),
            1600 => host.state(RunState::Standby),
            _ => host.run(),
        };
        give(&mut rig, &frame);
        hash_of(&mut rig, &mut hasher);
        if switch == Some(cycle) {
            let snapshot = rig.clone();
            // What the first one does from here on must not reach the snapshot.
            for _ in 0..50 {
                give(&mut rig, &host.clone().run());
            }
            assert_ne!(rig, snapshot);
            rig = snapshot;
        }
    }
    hasher.finish()
}

#[test]
fn the_answers_to_the_same_commands_are_the_same() {
    let once = run(None);
    assert_eq!(run(None), once);
    for switch in [0, 710, 1234, 1555, 2998] {
        assert_eq!(run(Some(switch)), once, "cloned after cycle {switch}");
    }
}

/// Arms the rig of a host on a memory bus.
fn arm_on(bus: &mut MemoryBus, host: &mut Host, sync: &Sync) -> SessionCode {
    host.arm(sync, |question| {
        if let Some(question) = question {
            bus.send(&question);
        }
        bus.wait(Duration::ZERO);
        std::iter::from_fn(|| bus.receive()).collect()
    })
}

/// Measurements of four rigs on a memory bus.
fn on_memory_bus(pace: Pace, profile: Profile) -> (Vec<Measurement>, [u32; 4]) {
    let rigs = Node::ALL.map(|node| RigNode::new(&setup(), node, profile));
    let mut bus = MemoryBus::new(rigs);
    let mut hosts = Node::ALL.map(|node| Host { node, ..Host::new(profile) });
    let mut measured = Vec::new();
    let sync = hosts[0].sync_message(pace);
    bus.send(&sync.encode());
    let hold = |bus: &mut MemoryBus, hosts: &mut [Host]| {
        // The rigs that are armed already do not wait for the others.
        for host in hosts {
            bus.send(&host.state(RunState::Armed));
        }
    };
    let mut codes = Vec::new();
    for number in 0..hosts.len() {
        let (before, host) = hosts.split_at_mut(number);
        codes.push(host[0].arm(&sync, |question| {
            if let Some(question) = question {
                bus.send(&question);
            }
            hold(&mut bus, before);
            bus.wait(Duration::ZERO);
            std::iter::from_fn(|| bus.receive()).collect()
        }));
    }
    // The rams stand in the middle, where the motion begins.
    for host in &mut hosts {
        host.cycle = 0;
    }
    let firsts = hosts.clone().map(|host| host.sent);
    let sent = bus.counters().sent;
    for cycle in 0..500 {
        for host in &mut hosts {
            assert_eq!(bus.send(&host.run()), Sent::Away);
        }
        while let Some(frame) = bus.receive() {
            for ((node, code), first) in Node::ALL.into_iter().zip(&codes).zip(firsts) {
                let seal = Seal { code: *code, cycle: first + cycle };
                let opened = Measurement::decode_sealed(frame.id(), frame.data(), seal);
                measured.extend(opened.ok().filter(|measurement| measurement.node == node));
            }
        }
    }
    assert_eq!(bus.counters().sent - sent, 2000);
    assert_eq!(bus.counters().receive_dropped, 0);
    (measured, firsts)
}

#[test]
fn on_the_memory_bus_pace_changes_nothing_and_every_command_has_its_answer() {
    for profile in [Profile::Classical, Profile::Fd] {
        let (lock_step, measured_from) = on_memory_bus(Pace::LockStep, profile);
        assert_eq!(lock_step.len(), 2000);
        let modulus = usize::from(profile.counter_modulus());
        for (number, measurement) in lock_step.iter().enumerate() {
            assert_eq!(measurement.node, Node::ALL[number % 4]);
            let first = measured_from[number % 4] as usize;
            assert_eq!(measurement.echo.map(usize::from), Some((first + number / 4) % modulus));
            assert_eq!(measurement.state, RunState::Run);
        }
        assert_eq!(on_memory_bus(Pace::Clock, profile), (lock_step.clone(), measured_from));
        // Four load cells, four noises.
        assert_ne!(lock_step[0].force_n, lock_step[1].force_n);
    }
}

#[test]
fn a_rig_in_line_answers_as_one_that_is_fed_by_hand() {
    let mut host = Host::new(Profile::Classical);
    let mut rig = armed(&setup(), &mut host, Pace::LockStep);
    let mut bus = MemoryBus::new(vec![RigNode::new(&setup(), host.node, host.profile)]);
    let mut other = Host::new(Profile::Classical);
    let sync = other.sync_message(Pace::LockStep);
    bus.send(&sync.encode());
    let code = arm_on(&mut bus, &mut other, &sync);
    assert_eq!((Some(code), other.sent), (host.code, host.sent));
    for _ in 0..1000 {
        let frame = host.run();
        give(&mut rig, &frame);
        bus.send(&frame);
        while let Some(frame) = rig.take_frame() {
            assert_eq!(bus.receive(), Some(WireFrame::from(&frame)));
        }
        assert_eq!(bus.receive(), None);
    }
}

#[test]
fn a_host_that_never_receives_loses_frames_and_they_are_counted() {
    let mut host = Host::new(Profile::Classical);
    let mut bus = MemoryBus::new(vec![RigNode::new(&setup(), host.node, host.profile)]);
    let sync = host.sync_message(Pace::LockStep);
    bus.send(&sync.encode());
    arm_on(&mut bus, &mut host, &sync);
    let before = bus.counters();
    for _ in 0..100 {
        bus.send(&host.run());
    }
    // 100 measurements, 5 heartbeats, 2 telemetries.
    let dropped = 107 - QUEUE_FRAMES as u64;
    let sent = before.sent + 100;
    let expected = BusCounters { sent, receive_dropped: dropped, ..before };
    assert_eq!(bus.counters(), expected);
    let kept = std::iter::from_fn(|| bus.receive()).count();
    let received = before.received + QUEUE_FRAMES as u64;
    assert_eq!((kept, bus.counters().received), (QUEUE_FRAMES, received));
}
