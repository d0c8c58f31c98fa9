//! A rig that a test feeds frame by frame.

use super::host::{Host, setup};
use can_protocol::{Frame, Measurement, Message, MessageId, Pace, Seal, SessionCode, Sync};
use hil_host::bus::WireFrame;
use hil_host::rig::RigNode;
use scenario::rig::RigSetup;
use std::ops::{Deref, DerefMut};

/// The laboratory rig without noise.
pub(crate) fn quiet() -> RigSetup {
    RigSetup { force_noise_n: 0.0, displacement_noise_m: 0.0, ..setup() }
}

/// A rig, and what its listener knows of its session.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FedRig {
    rig: RigNode,
    code: Option<SessionCode>,
    /// Number of its next measurement.
    heard: u32,
}

impl Deref for FedRig {
    type Target = RigNode;

    fn deref(&self) -> &RigNode {
        &self.rig
    }
}

impl DerefMut for FedRig {
    fn deref_mut(&mut self) -> &mut RigNode {
        &mut self.rig
    }
}

impl From<RigNode> for FedRig {
    fn from(rig: RigNode) -> Self {
        Self { rig, code: None, heard: 0 }
    }
}

/// A rig that has had its handshake and is armed.
pub(crate) fn armed(setup: &RigSetup, host: &mut Host, pace: Pace) -> FedRig {
    let mut rig = FedRig::from(RigNode::new(setup, host.node, host.profile));
    let sync = host.sync_message(pace);
    give(&mut rig, &sync.encode());
    arm(&mut rig, host, &sync);
    rig
}

/// Arms a rig that has had this sync.
pub(crate) fn arm(rig: &mut FedRig, host: &mut Host, sync: &Sync) {
    let code = host.arm(sync, |question| pass(rig, question));
    (rig.code, rig.heard) = (Some(code), 0);
}

/// Gives a rig a frame, lets a cycle pass without commands, and takes what it sends.
pub(crate) fn pass(rig: &mut RigNode, frame: Option<Frame>) -> Vec<WireFrame> {
    if let Some(frame) = frame {
        give(rig, &frame);
    }
    rig.idle();
    std::iter::from_fn(|| rig.take_frame()).map(|frame| WireFrame::from(&frame)).collect()
}

pub(crate) fn give(rig: &mut RigNode, frame: &Frame) {
    rig.on_frame(&WireFrame::from(frame));
}

/// All messages that the rig has to send.
pub(crate) fn answers(rig: &mut FedRig) -> Vec<Message> {
    std::iter::from_fn(|| rig.rig.take_frame().map(|frame| rig.open(&frame))).collect()
}

impl FedRig {
    /// The message in a frame of this rig.
    pub(crate) fn open(&mut self, frame: &Frame) -> Message {
        let (id, data) = (frame.id(), frame.data());
        match (MessageId::from_raw(id), self.code) {
            (Some(MessageId::Measurement(..)), Some(code)) => {
                let seal = Seal { code, cycle: self.heard };
                self.heard += 1;
                Message::Measurement(Measurement::decode_sealed(id, data, seal).unwrap())
            }
            _ => Message::decode(id, data).unwrap(),
        }
    }
}

/// The one measurement among the rig's answers.
pub(crate) fn measured(rig: &mut FedRig) -> Measurement {
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
