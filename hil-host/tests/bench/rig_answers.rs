//! Same frames, same answers, bit for bit: twice, after a clone in the middle, on the memory bus.

use crate::support::host::{Host, setup};
use crate::support::rig::{give, greeted};
use can_protocol::{Measurement, Mode, Node, Pace, Profile, RunState};
use hil_host::bus::QUEUE_FRAMES;
use hil_host::bus::{Bus, BusCounters, MemoryBus, Sent, WireFrame};
use hil_host::rig::RigNode;
use std::hash::{DefaultHasher, Hash, Hasher};

const CYCLES: usize = 3000;

fn hash_of(rig: &mut RigNode, hasher: &mut DefaultHasher) {
    while let Some(frame) = rig.take_frame() {
        (frame.id(), frame.data()).hash(hasher);
    }
}

/// Answers to a run with holds, a stop and a new arming in it; cloned at `switch` if given.
fn run(switch: Option<usize>) -> u64 {
    let mut host = Host::new(Profile::Classical);
    let mut rig = greeted(&setup(), &host, Pace::LockStep);
    let mut hasher = DefaultHasher::new();
    for cycle in 0..CYCLES {
        let frame = match cycle {
            700..=720 => host.say(RunState::Run, Mode::Hold, None, None),
            1500..=1600 => host.state(RunState::Armed),
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

/// Measurements of four rigs on a memory bus.
fn on_memory_bus(pace: Pace, profile: Profile) -> Vec<Measurement> {
    let rigs = Node::ALL.map(|node| RigNode::new(&setup(), node, profile));
    let mut bus = MemoryBus::new(rigs);
    let mut hosts = Node::ALL.map(|node| Host { node, ..Host::new(profile) });
    let mut measured = Vec::new();
    bus.send(&hosts[0].sync(pace));
    for _ in 0..500 {
        for host in &mut hosts {
            assert_eq!(bus.send(&host.run()), Sent::Away);
        }
        while let Some(frame) = bus.receive() {
            measured.extend(Measurement::decode(frame.id(), frame.data()));
        }
    }
    assert_eq!(bus.counters().sent, 2001);
    assert_eq!(bus.counters().receive_dropped, 0);
    measured
}

#[test]
fn on_the_memory_bus_pace_changes_nothing_and_every_command_has_its_answer() {
    for profile in [Profile::Classical, Profile::Fd] {
        let lock_step = on_memory_bus(Pace::LockStep, profile);
        assert_eq!(lock_step.len(), 2000);
        let modulus = usize::from(profile.counter_modulus());
        for (number, measurement) in lock_step.iter().enumerate() {
            assert_eq!(measurement.node, Node::ALL[number % 4]);
            assert_eq!(measurement.echo.map(usize::from), Some(number / 4 % modulus));
            assert_eq!(measurement.state, RunState::Run);
        }
        assert_eq!(on_memory_bus(Pace::Clock, profile), lock_step);
        // Four load cells, four noises.
        assert_ne!(lock_step[0].force_n, lock_step[1].force_n);
    }
}

#[test]
fn a_rig_in_line_answers_as_one_that_is_fed_by_hand() {
    let mut host = Host::new(Profile::Classical);
    let mut rig = greeted(&setup(), &host, Pace::LockStep);
    let mut bus = MemoryBus::new(vec![RigNode::new(&setup(), host.node, host.profile)]);
    bus.send(&host.sync(Pace::LockStep));
    while bus.receive().is_some() {}
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
    bus.send(&host.sync(Pace::LockStep));
    for _ in 0..100 {
        bus.send(&host.run());
    }
    // A heartbeat for the sync, 100 measurements, 5 heartbeats, 2 telemetries.
    let dropped = 108 - QUEUE_FRAMES as u64;
    let expected = BusCounters { sent: 101, receive_dropped: dropped, ..BusCounters::default() };
    assert_eq!(bus.counters(), expected);
    let kept = std::iter::from_fn(|| bus.receive()).count();
    assert_eq!((kept, bus.counters().received), (QUEUE_FRAMES, QUEUE_FRAMES as u64));
}
