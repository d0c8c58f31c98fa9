//! What a rig keeps of its host: the timing it announced, the session that it armed, and the
//! commands that it sends.

use crate::{WATCHDOG_CYCLES, WireFrame};
use can_protocol::arming::{Configuration, Limits};
use can_protocol::{
    Command, Counts, Node, Pace, Profile, Receiver, ReceiverState, Seal, SessionCode, Status, Sync,
};
use core::num::{NonZeroU8, NonZeroU16};
use firmware_core::supervision::{Frames, SecondSender};

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

    /// The configuration of a session with these limits.
    pub fn configuration(self, limits: Limits) -> Configuration {
        Configuration {
            profile: self.profile,
            pace: self.pace,
            period_us: NonZeroU16::new(self.period_us).unwrap_or(NonZeroU16::MIN),
            slow_down: NonZeroU8::new(self.slow_down).unwrap_or(NonZeroU8::MIN),
            watchdog_cycles: WATCHDOG_CYCLES as u16,
            limits,
        }
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FrameCounts {
    /// Valid and new.
    pub received: u64,
    /// Missing by the counters of those that came.
    pub lost: u64,
    /// Wrong checksum, length or reserved code, or not sealed by this session.
    pub crc_errors: u64,
    /// The same frame again.
    pub repeated: u64,
    /// An old counter, or too far ahead.
    pub wrong_sequence: u64,
    /// Another content under the counter of the last one.
    pub conflicts: u64,
    /// Commands that came while the rig was not armed.
    pub unarmed: u64,
    /// Commands that stepped further than the agreed speed allows, and were not followed.
    pub too_far: u64,
}

impl FrameCounts {
    fn plus(self, counts: &Counts) -> Self {
        Self {
            received: self.received + counts.initial + counts.ok + counts.some_lost,
            lost: self.lost + counts.lost_frames,
            crc_errors: self.crc_errors + counts.wrong_crc,
            repeated: self.repeated + counts.repeated,
            wrong_sequence: self.wrong_sequence + counts.wrong_sequence,
            conflicts: self.conflicts + counts.conflict,
            unarmed: self.unarmed,
            too_far: self.too_far,
        }
    }
}

/// The commands of one host.
#[derive(Debug, Clone, PartialEq)]
pub struct Session {
    node: Node,
    armed: Option<Armed>,
    /// Counts of sessions before this one.
    earlier: FrameCounts,
    pending: Option<Command>,
    accepted_since_sync: bool,
    sync_time_us: u32,
}

/// What an armed session has.
#[derive(Debug, Clone, PartialEq)]
struct Armed {
    code: SessionCode,
    profile: Profile,
    receiver: Receiver<Command>,
    state: ReceiverState,
    /// Number of the next measurement.
    cycle: u32,
    /// What came under the command's id since the last cycle.
    frames: Frames,
    second_sender: SecondSender,
}

impl Session {
    /// No session yet.
    pub fn new(node: Node) -> Self {
        Self {
            node,
            armed: None,
            earlier: FrameCounts::default(),
            pending: None,
            accepted_since_sync: false,
            sync_time_us: 0,
        }
    }

    /// Begins an armed session; both sides count from cycle 0.
    pub fn arm(&mut self, profile: Profile, code: SessionCode) {
        self.end();
        let Ok(receiver) = Receiver::new(profile, self.node, MAX_DELTA) else {
            debug_assert!(false, "{MAX_DELTA} lost commands fit every profile");
            return;
        };
        let receiver = receiver.sealed(code);
        let state = ReceiverState::default();
        let (frames, second_sender) = (Frames::default(), SecondSender::default());
        self.armed =
            Some(Armed { code, profile, receiver, state, cycle: 0, frames, second_sender });
    }

    /// Ends it; what was counted stays.
    pub fn end(&mut self) {
        self.earlier = self.counts();
        (self.armed, self.pending) = (None, None);
    }

    /// Judges a frame with a command's id; true when it is valid and new.
    pub fn accept(&mut self, frame: &WireFrame) -> bool {
        let Some(Armed { receiver, state, frames, .. }) = &mut self.armed else {
            self.earlier.unarmed += 1;
            return false;
        };
        let Some(reception) = receiver.accept(state, frame.id(), frame.data()) else {
            return false;
        };
        frames.bad |= reception.status == Status::WrongCrc;
        frames.conflict |= reception.status == Status::Conflict;
        frames.foreign |= reception.plain;
        frames.good |= reception.data.is_some();
        let Some(command) = reception.data else { return false };
        self.pending = Some(command);
        self.accepted_since_sync = true;
        true
    }

    /// A cycle has passed; whether there is evidence of a second sender of commands.
    pub fn has_second_sender(&mut self) -> bool {
        let Some(armed) = &mut self.armed else { return false };
        armed.second_sender.take(core::mem::take(&mut armed.frames))
    }

    /// Notes a command that steps too far.
    pub fn note_too_far(&mut self) {
        self.earlier.too_far += 1;
    }

    /// The host's number of the last accepted command.
    pub fn commanded_cycle(&self) -> Option<u32> {
        self.armed.as_ref().and_then(|armed| armed.state.cycle())
    }

    /// The newest command that was not taken yet.
    pub fn take(&mut self) -> Option<Command> {
        self.pending.take()
    }

    /// A sync came. True when it is that of another host, or of this one started anew: no command
    /// came since the last sync, or its time does not follow on.
    pub fn on_sync(&mut self, time_us: u32) -> bool {
        let advance_us = time_us.wrapping_sub(self.sync_time_us) & Sync::TIME.ones();
        let follows = self.accepted_since_sync && advance_us <= SYNC_GAP_US;
        self.sync_time_us = time_us;
        self.accepted_since_sync = false;
        !follows
    }

    /// A cycle had no command.
    pub fn note_no_frame(&mut self) {
        if let Some(Armed { receiver, state, .. }) = &mut self.armed {
            receiver.no_frame(state);
        }
    }

    /// Whether a session is armed, and not ended.
    pub fn is_armed(&self) -> bool {
        self.armed.is_some()
    }

    /// Whether a command of an armed session was accepted.
    pub fn is_commanded(&self) -> bool {
        self.echo().is_some()
    }

    /// Whether no measurement of the session was sent yet.
    pub fn is_new(&self) -> bool {
        self.armed.as_ref().is_some_and(|armed| armed.cycle == 0)
    }

    /// Counter of the last accepted command of the session.
    pub fn echo(&self) -> Option<u8> {
        self.armed.as_ref().and_then(|armed| armed.state.echo())
    }

    /// Profile and seal of the next measurement; none before the first command.
    pub fn next_seal(&mut self) -> Option<(Profile, Seal)> {
        let armed = self.armed.as_mut().filter(|armed| armed.state.echo().is_some())?;
        let seal = Seal { code: armed.code, cycle: armed.cycle };
        armed.cycle = armed.cycle.saturating_add(1);
        Some((armed.profile, seal))
    }

    /// Leaves out the seals of measurements that were lost before they could be sealed.
    pub fn skip_measurements(&mut self, lost: u32) {
        if let Some(armed) = self.armed.as_mut().filter(|armed| armed.state.echo().is_some()) {
            armed.cycle = armed.cycle.saturating_add(lost);
        }
    }

    /// How the commands of all sessions were received.
    pub fn counts(&self) -> FrameCounts {
        match &self.armed {
            Some(armed) => self.earlier.plus(armed.state.counts()),
            None => self.earlier,
        }
    }
}
