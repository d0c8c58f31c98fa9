//! What a rig keeps of its host: the timing it announced and the commands it sends.

use crate::bus::WireFrame;
use can_protocol::{Command, Counts, Node, Pace, Profile, Receiver, ReceiverState, Sync};
use serde::Serialize;

/// Commands that may be missing in a row before a newer one is out of sequence.
const MAX_DELTA: u8 = 5;

/// Time from one sync to the next beyond which it is another host's: ten are lost (us).
const SYNC_GAP_US: u32 = 1_000_000;

/// How time runs, as the host's sync sets it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timing {
    /// Classical or FD.
    pub profile: Profile,
    /// Who waits for whom.
    pub pace: Pace,
    /// Length of a cycle in the model (us).
    pub period_us: u16,
    /// Real time over model time.
    pub slow_down: u8,
}

impl Default for Timing {
    fn default() -> Self {
        Self { profile: Profile::Classical, pace: Pace::Clock, period_us: 1000, slow_down: 1 }
    }
}

impl Timing {
    /// Length of a cycle in the model (s).
    pub fn period_s(self) -> f64 {
        f64::from(self.period_us) * 1e-6
    }

    /// Length of a cycle in real time (ns).
    pub fn wall_period_ns(self) -> u64 {
        u64::from(self.period_us) * 1000 * u64::from(self.slow_down)
    }
}

impl From<&Sync> for Timing {
    fn from(sync: &Sync) -> Self {
        Self {
            profile: sync.profile,
            pace: sync.pace,
            period_us: sync.period_us.get(),
            slow_down: sync.slow_down.get(),
        }
    }
}

/// How the commands that came in were received.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct FrameCounts {
    /// Valid and new.
    pub received: u64,
    /// Missing by the counters of those that came.
    pub lost: u64,
    /// Wrong checksum, length or reserved code.
    pub crc_errors: u64,
    /// The same counter again.
    pub repeated: u64,
    /// An old counter, or too far ahead.
    pub wrong_sequence: u64,
}

impl FrameCounts {
    fn plus(self, counts: &Counts) -> Self {
        Self {
            received: self.received + counts.initial + counts.ok + counts.some_lost,
            lost: self.lost + counts.lost_frames,
            crc_errors: self.crc_errors + counts.wrong_crc,
            repeated: self.repeated + counts.repeated,
            wrong_sequence: self.wrong_sequence + counts.wrong_sequence,
        }
    }
}

/// The commands of one host.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Session {
    node: Node,
    receiver: Receiver<Command>,
    state: ReceiverState,
    /// Counts of sessions before this one.
    earlier: FrameCounts,
    pending: Option<Command>,
    accepted_since_sync: bool,
    sync_time_us: u32,
}

impl Session {
    pub(super) fn new(profile: Profile, node: Node) -> Self {
        Self {
            node,
            receiver: receiver(profile, node),
            state: ReceiverState::default(),
            earlier: FrameCounts::default(),
            pending: None,
            accepted_since_sync: false,
            sync_time_us: 0,
        }
    }

    /// Judges a frame with a command's id; true when it is valid and new.
    pub(super) fn accept(&mut self, frame: &WireFrame) -> bool {
        let reception = self.receiver.accept(&mut self.state, frame.id(), frame.data());
        let Some(command) = reception.and_then(|reception| reception.data) else { return false };
        self.pending = Some(command);
        self.accepted_since_sync = true;
        true
    }

    /// The newest command that was not taken yet.
    pub(super) fn take(&mut self) -> Option<Command> {
        self.pending.take()
    }

    /// A sync came. True when a new session begins with it: no command came since the last sync, or
    /// its time does not follow on.
    pub(super) fn on_sync(&mut self, time_us: u32) -> bool {
        let advance_us = time_us.wrapping_sub(self.sync_time_us) & Sync::TIME.ones();
        let follows = self.accepted_since_sync && advance_us <= SYNC_GAP_US;
        self.sync_time_us = time_us;
        self.accepted_since_sync = false;
        !follows
    }

    pub(super) fn change_profile(&mut self, profile: Profile) {
        self.receiver = receiver(profile, self.node);
        self.restart();
    }

    pub(super) fn note_no_frame(&mut self) {
        self.receiver.no_frame(&mut self.state);
    }

    pub(super) fn echo(&self) -> Option<u8> {
        self.state.echo()
    }

    pub(super) fn counts(&self) -> FrameCounts {
        self.earlier.plus(self.state.counts())
    }

    /// Forgets the counters of an earlier session, not what was counted.
    pub(super) fn restart(&mut self) {
        self.earlier = self.counts();
        self.state = ReceiverState::default();
        self.pending = None;
    }
}

fn receiver(profile: Profile, node: Node) -> Receiver<Command> {
    const { assert!(MAX_DELTA >= 1 && MAX_DELTA <= 7) };
    match Receiver::new(profile, node, MAX_DELTA) {
        Ok(receiver) => receiver,
        Err(_) => unreachable!("1 to 7 fits every profile"),
    }
}
