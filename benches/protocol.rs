//! Encoding and decoding of the cyclic pair.

use can_protocol::{Command, Measurement, Mode, Node, Profile, Receiver, ReceiverState, RunState};
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;

fn codec(criterion: &mut Criterion) {
    for (name, profile) in [("classical", Profile::Classical), ("FD", Profile::Fd)] {
        let node = Node::ALL[0];
        let mut command = Command {
            node,
            counter: 0,
            state: RunState::Run,
            mode: Mode::FollowWithVelocity,
            echo: Some(3),
            displacement_m: Some(1.234_567e-3),
            velocity_m_per_s: Some(-0.0421),
            time_us: None,
        };
        criterion.bench_function(&format!("encode command, {name}"), |bencher| {
            bencher.iter(|| {
                command.counter = profile.next_counter(command.counter);
                black_box(&command).encode(profile)
            });
        });
        let mut measurement = Measurement {
            node,
            counter: 0,
            state: RunState::Run,
            flags: can_protocol::MeasurementFlags::empty(),
            echo: Some(3),
            force_n: Some(12_345.6),
            displacement_m: Some(1.2e-3),
            time_us: None,
        };
        let frames: Vec<_> = (0..profile.counter_modulus())
            .map(|counter| {
                measurement.counter = counter;
                measurement.encode(profile).0
            })
            .collect();
        let Ok(receiver) = Receiver::<Measurement>::new(profile, node, 5) else { return };
        let mut state = ReceiverState::default();
        let mut next = frames.iter().cycle();
        criterion.bench_function(&format!("receive measurement, {name}"), |bencher| {
            bencher.iter(|| {
                let frame = next.next()?;
                receiver.accept(&mut state, black_box(frame.id()), frame.data())
            });
        });
    }
}

criterion_group!(benches, codec);
criterion_main!(benches);
