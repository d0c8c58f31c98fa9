//! A rig on a bus where anybody sends anything, with a right CRC too.
//!
//! The ram of a rig that is not armed stays where it is.

use crate::frames::Raw;
use can_protocol::{Node, Profile};
use hil_host::bus::{Bus as _, MemoryBus, WireFrame};
use hil_host::rig::RigNode;
use scenario::rig::{RigFile, RigSetup};
use std::sync::LazyLock;

/// Frames of one input that are looked at.
const FRAMES: usize = 300;

/// Speed that a ram at rest does not exceed, m/s: its damper relaxes.
const AT_REST_M_PER_S: f64 = 1e-3;

static SETUP: LazyLock<RigSetup> =
    LazyLock::new(|| RigFile::default_setup().expect("the built-in rig"));

pub(crate) fn rig(bytes: &[u8]) {
    let mut bus = MemoryBus::new(Some(RigNode::new(&SETUP, Node::ALL[0], Profile::Classical)));
    let mut rest = bytes;
    for _ in 0..FRAMES {
        let Some((frame, after)) = Raw::take(rest) else { break };
        rest = after;
        let Some(frame) = WireFrame::new(frame.id, frame.data().len() > 8, frame.data()) else {
            continue;
        };
        let before = state(&bus);
        bus.inject(&frame);
        let now = state(&bus);
        if !before.is_armed && !now.is_armed {
            assert!(
                (now.ram_m - before.ram_m).abs() < AT_REST_M_PER_S * 1e-3,
                "the ram of a rig that is not armed moved from {} m to {} m",
                before.ram_m,
                now.ram_m
            );
        }
        while bus.receive().is_some() {}
    }
}

/// What the rules are about.
struct State {
    ram_m: f64,
    is_armed: bool,
}

fn state(bus: &MemoryBus) -> State {
    let rig = bus.rigs().first();
    State {
        ram_m: rig.map_or(0.0, |rig| rig.physics().ram().displacement_m),
        is_armed: rig.is_some_and(RigNode::is_armed),
    }
}
