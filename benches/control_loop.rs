//! The in-process loop: one cycle with a rig on the memory bus, receive to send.

use can_protocol::{Node, Pace, Profile};
use criterion::{Criterion, criterion_group, criterion_main};
use hil_host::bus::MemoryBus;
use hil_host::clock::Tick;
use hil_host::control::{Arming, Buses, Port, Requests, Session};
use hil_host::record::Queues;
use hil_host::rig::RigNode;
use scenario::run::{Overrides, Run};
use std::num::NonZeroU8;
use std::path::Path;
use std::time::Duration;

fn cycle(criterion: &mut Criterion) {
    let path = Path::new("scenarios/ss9-160kmh.toml");
    let run = match Run::load(path, Overrides { duration_s: Some(60.0), ..Overrides::default() }) {
        Ok(run) => run,
        Err(error) => panic!("{error}"),
    };
    let track = run.track.view();
    let Ok(port) = Port::new(Node::ALL[0], 0, 0, Profile::Classical) else { return };
    let Ok(ports) = heapless::Vec::from_slice(&[port]) else { return };
    let session = Session {
        line: hil_host::run::line(&run, &track),
        ports,
        profile: Profile::Classical,
        pace: Pace::LockStep,
        slow_down: NonZeroU8::MIN,
        arming: Arming::in_memory(),
        delay_gate: None,
        watched: [Some(0), Some(1), Some(3)],
        rear_bogie: Some(2),
    };
    let bus = || vec![MemoryBus::new([RigNode::new(&run.rig, Node::ALL[0], Profile::Classical)])];
    let (mut state, mut buses) =
        (session.start(session.line.start(run.start.state.clone())), bus());
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let (patience, stop) = (Duration::from_secs(1), Requests::armed());
    let greeted = session.greet(&mut state, &mut buses, patience, &stop);
    assert_eq!(greeted, Ok(()), "the rig in memory does not answer");
    let start = (state.clone(), buses.clone());
    criterion.bench_function("control cycle, memory bus", |bencher| {
        bencher.iter(|| {
            if state.line.cycle > 55_000 {
                (state, buses) = start.clone();
            }
            session.cycle(&mut state, &mut Buses::new(&mut buses, &mut recorder), Tick::default())
        });
    });
}

criterion_group!(benches, cycle);
criterion_main!(benches);
