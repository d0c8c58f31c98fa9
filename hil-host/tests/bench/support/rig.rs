//! A rig that a test feeds frame by frame.

use super::host::{Host, setup};
use can_protocol::{Frame, Measurement, Message, Pace};
use hil_host::bus::WireFrame;
use hil_host::rig::RigNode;
use scenario::rig::RigSetup;

/// The laboratory rig without noise.
pub(crate) fn quiet() -> RigSetup {
    RigSetup { force_noise_n: 0.0, displacement_noise_m: 0.0, ..setup() }
}

/// A rig that has had its handshake.
pub(crate) fn greeted(setup: &RigSetup, host: &Host, pace: Pace) -> RigNode {
    let mut rig = RigNode::new(setup, host.node, host.profile);
    give(&mut rig, &host.sync(pace));
    answers(&mut rig);
    rig
}

pub(crate) fn give(rig: &mut RigNode, frame: &Frame) {
    rig.on_frame(&WireFrame::from(frame));
}

/// All messages that the rig has to send.
pub(crate) fn answers(rig: &mut RigNode) -> Vec<Message> {
    std::iter::from_fn(|| rig.take_frame())
        .map(|frame| Message::decode(frame.id(), frame.data()).unwrap())
        .collect()
}

/// The one measurement among the rig's answers.
pub(crate) fn measured(rig: &mut RigNode) -> Measurement {
    let found: Vec<_> = answers(rig)
        .into_iter()
        .filter_map(|message| match message {
            Message::Measurement(measurement) => Some(measurement),
            _ => None,
        })
        .collect();
    let [measurement] = found[..] else { panic!("{} measurements", found.len()) };
    measurement
}
