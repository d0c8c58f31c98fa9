//! Frames: what the loop counted, and what passed the bus.

use super::outcome::Outcome;
use crate::bus::BusCounters;
use crate::options::PaceChoice;
use serde::{Deserialize, Serialize};

/// Frames of the cyclic pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Frames {
    /// Commands that the bus took.
    pub sent: u64,
    /// Valid, new measurements.
    pub received: u64,
    /// Measurements that are missing by their counters, or commands without one.
    pub lost: u64,
    /// Frames whose protection failed.
    pub crc_errors: u64,
    /// Repeated measurements.
    pub repeated: u64,
    /// Measurements out of sequence.
    pub wrong_sequence: u64,
    /// Commands that the bus did not take in time.
    pub late: u64,
}

/// Everything that passed the bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "documented at the bus")]
pub struct BusCount {
    pub sent: u64,
    pub received: u64,
    pub send_dropped: u64,
    pub receive_dropped: u64,
    pub error_frames: u64,
}

impl From<BusCounters> for BusCount {
    fn from(counters: BusCounters) -> Self {
        let BusCounters { sent, received, send_dropped, receive_dropped, error_frames } = counters;
        Self { sent, received, send_dropped, receive_dropped, error_frames }
    }
}

pub(super) fn frames(outcome: &Outcome<'_>) -> Frames {
    let mut frames = Frames {
        sent: 0,
        received: 0,
        lost: 0,
        crc_errors: 0,
        repeated: 0,
        wrong_sequence: 0,
        late: outcome.state.late,
    };
    for (port, state) in outcome.ports.iter().zip(&outcome.state.ports) {
        let counts = port.counts(state);
        frames.sent += state.commands;
        frames.received += counts.initial + counts.ok + counts.some_lost;
        frames.crc_errors += counts.wrong_crc;
        frames.repeated += counts.repeated;
        frames.wrong_sequence += counts.wrong_sequence;
        frames.lost += counts.lost_frames;
    }
    frames.sent -= outcome.state.late.min(frames.sent);
    // On its own clock a rig measures more or less often than it is commanded; otherwise every
    // command has its measurement.
    if outcome.pace != PaceChoice::Realtime {
        frames.lost = frames.lost.max(frames.sent.saturating_sub(frames.received));
    }
    frames
}
