//! A rig that stands for other dampers of the locomotive: how exact that is on rough track.

use crate::support::locomotive::{lasting, session};
use can_protocol::{Node, Pace as WirePace, Profile};
use firmware_core::track::IrregularitySample;
use hil_host::bus::MemoryBus;
use hil_host::clock::Tick;
use hil_host::control::{Buses, Requests};
use hil_host::record::{Queues, Row};
use hil_host::rig::RigNode;
use scenario::run::{Run, SlotForce};
use std::time::Duration;

fn slot(place: &str, on: &str, more: &str) -> String {
    format!("[[slot]]\nplace = \"{place}\"\non = \"{on}\"\n{more}\n")
}

/// The rows of RUN.
fn rows(run: &Run) -> Vec<Row> {
    let track = run.track.view();
    let session = session(run, &track, WirePace::LockStep);
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let rig = |slot: &scenario::run::Slot| match slot.force {
        SlotForce::Rig { node, .. } => Some(node),
        _ => None,
    };
    let nodes = run.slots.iter().filter_map(rig).map(|node| Node::new(node).unwrap());
    let rigs = nodes.map(|node| RigNode::new(&run.rig, node, Profile::Classical));
    let mut bus = MemoryBus::new(rigs);
    let buses = std::slice::from_mut(&mut bus);
    session.greet(&mut state, buses, Duration::from_secs(1), &Requests::armed()).unwrap();
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let mut buses = Buses::new(buses, &mut recorder);
    let cycles = 1000 + run.cycles();
    let rows = (0..cycles).map(|_| session.cycle(&mut state, &mut buses, Tick::default()));
    rows.filter(|row| row.time_s >= 0.0).collect()
}

fn rms(rows: &[Row], of: impl Fn(&Row) -> f64) -> f64 {
    (rows.iter().map(|row| of(row).powi(2)).sum::<f64>() / rows.len() as f64).sqrt()
}

/// Rms of the difference of two runs over that of the first.
fn apart(one: &[Row], other: &[Row], of: impl Fn(&Row) -> f64) -> f64 {
    let pairs = one.iter().zip(other);
    let difference = pairs.map(|(a, b)| (of(a) - of(b)).powi(2)).sum::<f64>() / one.len() as f64;
    difference.sqrt() / rms(one, of)
}

/// How far a run with a partner was from one with a second rig: strokes from moving oppositely over
/// the stroke of the rig, force of the partner, yaw acceleration of the bogie.
fn of_a_partner(change: impl Fn(&mut IrregularitySample)) -> [f64; 3] {
    const SECONDS: f64 = 6.0;
    let run = |on: &str, more: &str| {
        let mut run = lasting(SECONDS, &slot("front right", on, more));
        run.track.samples.samples.iter_mut().for_each(&change);
        rows(&run)
    };
    let (two, one) = (run("rig", "node = 2"), run("partner", "of = \"front left\""));
    assert!(one.iter().all(|row| row.force_n[1] == -row.force_n[0]));
    let from_yaw = rms(&one, |row| row.extension_m[0] + row.extension_m[1])
        / rms(&one, |row| row.extension_m[0]);
    let force = apart(&two, &one, |row| row.force_n[1]);
    [from_yaw, force, apart(&two, &one, |row| row.bogie_yaw_rad_per_s2[0])]
}

#[test]
fn on_a_track_that_is_rough_sideways_alone_a_partner_is_a_second_rig() {
    let found = of_a_partner(|sample| {
        (sample.vertical_m, sample.cross_level_m, sample.gauge_m) = (0.0, 0.0, 0.0);
    });
    println!("strokes, force, yaw: {found:?}");
    // Wheels lift a little where they shift: of second order. And each rig has its own noise.
    assert!(found.iter().all(|share| *share < 0.05), "{found:?}");
}

#[test]
fn on_rough_track_pitch_moves_both_dampers_alike_and_the_share_says_so() {
    let [from_yaw, force, yaw] = of_a_partner(|_| {});
    println!("strokes {from_yaw}, force {force}, yaw {yaw}");
    // Dampers 1.2 m below the centre of the carbody: most of the stroke here is pitch.
    assert!((0.3..1.2).contains(&from_yaw), "{from_yaw}");
    assert!(force < from_yaw && yaw < 0.25, "{force} {yaw}");
}

#[test]
fn a_rig_of_the_other_bogie_does_not_take_the_energy_that_a_damper_takes() {
    const SECONDS: f64 = 6.0;
    let tables = slot("front right", "partner", "of = \"front left\"")
        + &slot("rear left", "other_bogie", "of = \"front left\"")
        + &slot("rear right", "other_bogie", "of = \"front left\"");
    let run = lasting(SECONDS, &tables);
    let all = rows(&run);
    for row in &all {
        let [left, right, rear_left, rear_right] = row.force_n;
        assert_eq!([right, rear_left, rear_right], [-left, left, -left]);
    }
    // Work against the own stroke: what a damper of this place would take is not taken.
    let work = |slot: usize| -> f64 {
        all.iter().map(|row| row.force_n[slot] * row.extension_m_per_s[slot]).sum()
    };
    let [front, rear] = [work(0), work(2)];
    println!("front {front}, rear {rear}");
    assert!(front > 0.0 && rear < 0.7 * front, "{front} {rear}");
}
