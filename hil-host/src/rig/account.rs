//! What a rig process prints: a line per second while it runs, and a summary at the end.

use super::{FrameCounts, RigNode};
use crate::bus::BusCounters;
use can_protocol::RunState;
use heapless::spsc::Consumer;
use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// What a rig did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RigSummary {
    /// Its number.
    pub node: u8,
    /// Its run state at the end, as in the DBC.
    pub state: &'static str,
    /// Cycles it computed.
    pub cycles: u64,
    /// Ticks of its own clock that it missed.
    pub skipped: u64,
    /// How often it was set running.
    pub runs: u64,
    /// How often it went safe by itself.
    pub safe_events: u64,
    /// How the commands were received.
    pub frames: FrameCounts,
    /// Frames that the bus took from it.
    pub sent: u64,
    /// Frames that the bus did not take.
    pub send_dropped: u64,
    /// Frames that the kernel lost on the way in.
    pub receive_dropped: u64,
    /// Error frames of the controller.
    pub error_frames: u64,
}

impl RigSummary {
    pub(super) fn new(rig: &RigNode, bus: BusCounters, skipped: u64) -> Self {
        Self {
            node: rig.node().number(),
            state: rig.run_state().name(),
            cycles: rig.cycles(),
            skipped,
            runs: rig.runs(),
            safe_events: rig.safe_events(),
            frames: rig.frames(),
            sent: bus.sent,
            send_dropped: bus.send_dropped,
            receive_dropped: bus.receive_dropped,
            error_frames: bus.error_frames,
        }
    }

    /// Whether it ended in the safe state, or with a fault.
    pub fn is_safe(&self) -> bool {
        self.state == RunState::Safe.name() || self.state == RunState::Fault.name()
    }
}

/// What is printed once per second.
#[derive(Debug, Clone, Copy)]
pub(super) struct Status {
    state: RunState,
    cycles: u64,
    frames: FrameCounts,
    force_n: f64,
    displacement_m: f64,
    bus: BusCounters,
}

impl Status {
    pub(super) fn of(rig: &RigNode, bus: BusCounters) -> Self {
        let (force_n, displacement_m) =
            rig.last().map_or((0.0, 0.0), |reading| (reading.force_n, reading.displacement_m));
        Self {
            state: rig.run_state(),
            cycles: rig.cycles(),
            frames: rig.frames(),
            force_n,
            displacement_m,
            bus,
        }
    }
}

pub(super) fn print_statuses(mut statuses: Consumer<'_, Status>, done: &AtomicBool) {
    while !done.load(Ordering::Acquire) {
        while let Some(Status { state, cycles, frames, force_n, displacement_m, bus }) =
            statuses.dequeue()
        {
            files::say!(
                "{state} cycle {cycles} received {} lost {} bad {} force {force_n:+.0} N \
                 displacement {:+.3} mm send-dropped {}",
                frames.received,
                frames.lost,
                frames.crc_errors
                    + frames.wrong_sequence
                    + frames.repeated
                    + frames.conflicts
                    + frames.unarmed
                    + frames.too_far,
                displacement_m * 1e3,
                bus.send_dropped,
            );
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// The account of a rig in two lines.
pub fn summary_text(summary: &RigSummary) -> String {
    let mut lines = Vec::new();
    let frames = &summary.frames;
    lines.push(format!(
        "rig node {}: {} after {} cycles in {} runs, {} ticks missed, {} times safe by itself",
        summary.node,
        summary.state,
        summary.cycles,
        summary.runs,
        summary.skipped,
        summary.safe_events
    ));
    lines.push(format!(
        "commands received {} lost {} wrong checksum {} repeated {} out of sequence {} in conflict \
         {} unarmed {} too far {}; sent {}, dropped {} out and {} in",
        frames.received,
        frames.lost,
        frames.crc_errors,
        frames.repeated,
        frames.wrong_sequence,
        frames.conflicts,
        frames.unarmed,
        frames.too_far,
        summary.sent,
        summary.send_dropped,
        summary.receive_dropped
    ));
    lines.join("\n")
}
