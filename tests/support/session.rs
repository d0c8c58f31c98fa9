//! A scenario in this process: the control loop with its rig on the memory bus.

#![allow(
    clippy::unwrap_used,
    clippy::large_stack_arrays,
    reason = "a test may fail loudly and has a large stack"
)]

use can_protocol::{Node, Pace as WirePace, Profile};
use firmware_core::line::Slot;
use firmware_core::track::Track;
use hil_host::bus::MemoryBus;
use hil_host::clock::Tick;
use hil_host::control::{Arming, Buses, Port, Requests, Session, SessionState};
use hil_host::record::Recorder;
use hil_host::rig::RigNode;
use scenario::run::{Overrides, Run};
use std::num::NonZeroU8;
use std::path::Path;
use std::time::Duration;

/// A scenario of the repository, perhaps cut to a duration.
pub(crate) fn scenario(name: &str, duration_s: impl Into<Option<f64>>) -> Run {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios").join(name);
    let overrides = Overrides { duration_s: duration_s.into(), ..Overrides::default() };
    Run::load(&path, overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// The session of a scenario; every rig slot gets its own node.
pub(crate) fn session<'a>(run: &'a Run, track: &'a Track<'a>) -> Session<'a> {
    let line = hil_host::run::line(run, track);
    let ports = line
        .slots
        .iter()
        .enumerate()
        .filter(|(_, slot)| matches!(slot, Slot::Rig(_)))
        .zip(Node::ALL)
        .map(|((slot, _), node)| {
            let port = Port::new(node, 0, slot, Profile::Classical).unwrap();
            match hil_host::run::watch_of(run, slot) {
                Some(watch) => port.watched(watch),
                None => port,
            }
        })
        .collect();
    Session {
        line,
        ports,
        profile: Profile::Classical,
        pace: WirePace::LockStep,
        slow_down: NonZeroU8::MIN,
        arming: Arming::in_memory(),
        delay_gate: None,
        watched: [Some(0), Some(1), Some(3)],
        rear_bogie: Some(2),
    }
}

/// The bus of a session, with its rigs.
pub(crate) fn bus(run: &Run, session: &Session<'_>) -> MemoryBus {
    MemoryBus::new(
        session.ports.iter().map(|port| RigNode::new(&run.rig, port.node, session.profile)),
    )
}

/// A session that has greeted its rigs and can cycle.
pub(crate) fn ready(run: &Run, session: &Session<'_>) -> (SessionState, [MemoryBus; 1]) {
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let mut buses = [bus(run, session)];
    session
        .greet(&mut state, &mut buses, Duration::from_secs(1), &Requests::armed())
        .unwrap_or_else(|why| panic!("{why:?}"));
    (state, buses)
}

/// Runs a number of cycles, dropping what would be recorded.
pub(crate) fn cycles(
    session: &Session<'_>,
    state: &mut SessionState,
    buses: &mut [MemoryBus],
    recorder: &mut Recorder<'_>,
    count: u64,
) {
    let mut buses = Buses::new(buses, recorder);
    for _ in 0..count {
        session.cycle(state, &mut buses, Tick::default());
    }
}
