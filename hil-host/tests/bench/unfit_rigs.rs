//! Rigs that cannot carry a run are refused before anything moves.

use crate::support::host::setup;
use crate::support::locomotive::{NODE, scenario, session};
use can_protocol::arming::Refusal;
use can_protocol::{ArmItem, Pace as WirePace, Profile};
use hil_host::Draw;
use hil_host::bus::MemoryBus;
use hil_host::control::{NoAnswer, Requests};
use hil_host::rig::RigNode;
use scenario::rig::RigSetup;
use std::time::Duration;

/// Why rigs on one bus are not armed; their rams have not moved.
fn refused(rigs: Vec<RigNode>) -> Refusal {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let mut bus = MemoryBus::new(rigs);
    let buses = std::slice::from_mut(&mut bus);
    let patience = Duration::from_secs(1);
    let answer = session.greet(&mut state, buses, patience, &Requests::armed());
    assert!(bus.rigs().iter().all(|rig| rig.physics().ram().displacement_m == 0.0));
    match answer {
        Err(NoAnswer::Refused { node: 1, refusal }) => refusal,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_stroke_of_1_mm_and_a_rate_of_10_mm_per_s_ended_as_completed() {
    let item = |setup: RigSetup| {
        let refusal = refused(vec![RigNode::new(&setup, NODE, Profile::Classical)]);
        let Refusal::ByHost(shortfall) = refusal else { panic!("{refusal:?}") };
        shortfall.item
    };
    assert_eq!(item(RigSetup { stroke_m: 1e-3, ..setup() }), ArmItem::Stroke);
    assert_eq!(item(RigSetup { rate_m_per_s: 10e-3, ..setup() }), ArmItem::Velocity);
}

#[test]
fn two_rigs_on_one_node_ended_as_completed() {
    let rig = || RigNode::new(&setup(), NODE, Profile::Classical);
    let refusal = refused(vec![rig(), rig().with_draw(Draw::seeded(99, 0))]);
    assert!(matches!(refusal, Refusal::NotQuiet(_)), "{refusal:?}");
}
