//! The answer time of a bus: from an announcement to what comes back.
//!
//! A rig answers every sync at once with a heartbeat, and it sends heartbeats every 20 ms anyway.
//! So a sync is sent right behind one of these, and a heartbeat that comes within [`CLEAR`] can
//! only be the answer; a later one counts as lost. The sync is that of a run with a clock: a rig
//! that waits goes to STANDBY, none is armed, and nothing moves.
//!
//! Where no rig answers, a second socket on the same interface takes the sync. A CAN controller
//! hands its own frame back when it was on the wire and acknowledged; a virtual interface hands it
//! over at once. The one holds the time of the frame, the other does not, and neither went through
//! a rig.
//!
//! Nobody else's run is disturbed: if a host is heard first, nothing is sent.

use super::distribution::empty;
use crate::bus::{Bus, Sent, WireFrame};
use crate::clock::now_ns;
use can_protocol::{
    Frame, Heartbeat, MessageId, Node, PROTOCOL_VERSION, Pace, Profile, Sender, Sync,
};
use hdrhistogram::Histogram;
use std::num::{NonZeroU8, NonZeroU16};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Time from one announcement to the next: the 10 Hz of the protocol.
const ROUND: Duration = Duration::from_millis(100);

/// Behind a heartbeat that was not asked for, no other one is due for this long.
const CLEAR: Duration = Duration::from_millis(15);

/// How long a host is listened for before anything is sent: three of its syncs.
const LISTEN: Duration = Duration::from_millis(300);

/// Announcements after which there is no rig.
const ATTEMPTS: u32 = 5;

/// Length of a cycle that is announced (µs).
const PERIOD_US: NonZeroU16 = NonZeroU16::new(1000).unwrap();

/// Who answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnsweredBy {
    /// A rig, by a heartbeat.
    Rig(Node),
    /// A second socket of this process.
    Loopback,
}

/// What was measured on a bus.
#[derive(Debug, Clone, PartialEq)]
pub struct AnswerTimes {
    /// Who answered.
    pub by: AnsweredBy,
    /// Announcements that the bus took.
    pub sent: u64,
    /// Announcements without an answer in time, and those that the bus did not take.
    pub lost: u64,
    /// The answer times (ns).
    pub times_ns: Histogram<u64>,
}

/// The id of a frame that only a host sends, if one is heard within the time of three syncs.
pub(super) fn hear_host<B: Bus>(bus: &mut B) -> Option<u16> {
    let mut found = None;
    until(LISTEN, bus, |frame| {
        let is_of_host = MessageId::from_raw(frame.id()).is_some_and(MessageId::is_of_host);
        found = is_of_host.then(|| frame.id());
        is_of_host
    });
    found
}

/// The node of a rig that answers an announcement.
pub(super) fn find_rig<B: Bus>(bus: &mut B, profile: Profile) -> Option<Node> {
    let mut found = None;
    for _ in 0..ATTEMPTS {
        bus.send(&announcement(profile));
        until(ROUND, bus, |frame| {
            found = rig_of(frame);
            found.is_some()
        });
        if found.is_some() {
            break;
        }
    }
    found
}

/// Times the answers until `ended`; `echo` is the second socket where no rig answers.
pub(super) fn time_answers<B: Bus>(
    bus: &mut B,
    mut echo: Option<&mut B>,
    by: AnsweredBy,
    profile: Profile,
    ended: &AtomicBool,
) -> AnswerTimes {
    debug_assert_eq!(echo.is_some(), by == AnsweredBy::Loopback, "an echo instead of a rig");
    let mut answers = AnswerTimes { by, sent: 0, lost: 0, times_ns: empty() };
    while !ended.load(Ordering::Relaxed) {
        let begin_ns = now_ns();
        match (by, &mut echo) {
            (AnsweredBy::Rig(node), _) => {
                let is_heartbeat = |frame: &WireFrame| rig_of(frame) == Some(node);
                // Whether it came or not: without one, any answer in time is the answer.
                until(ROUND, bus, is_heartbeat);
                answers.round(bus, None, profile, is_heartbeat);
            }
            (AnsweredBy::Loopback, Some(echo)) => {
                let is_sync = |frame: &WireFrame| frame.id() == MessageId::Sync.raw();
                answers.round(bus, Some(*echo), profile, is_sync);
            }
            (AnsweredBy::Loopback, None) => break,
        }
        let spent = Duration::from_nanos(now_ns().saturating_sub(begin_ns));
        std::thread::sleep(ROUND.saturating_sub(spent));
    }
    answers
}

impl AnswerTimes {
    /// One announcement and its answer, on `echo` or on the same socket.
    fn round<B: Bus>(
        &mut self,
        bus: &mut B,
        echo: Option<&mut B>,
        profile: Profile,
        is_answer: impl FnMut(&WireFrame) -> bool,
    ) {
        let frame = announcement(profile);
        let begin_ns = now_ns();
        let is_taken = bus.send(&frame) == Sent::Away;
        self.sent += u64::from(is_taken);
        let is_answered = is_taken
            && match echo {
                Some(echo) => until(CLEAR, echo, is_answer),
                None => until(CLEAR, bus, is_answer),
            };
        if is_answered {
            self.times_ns.saturating_record(now_ns().saturating_sub(begin_ns));
        } else {
            self.lost += 1;
        }
    }
}

/// Takes frames until one is the one, for at most `patience`; whether it came. What waits already
/// is looked at too.
fn until<B: Bus>(
    patience: Duration,
    bus: &mut B,
    mut is_the_one: impl FnMut(&WireFrame) -> bool,
) -> bool {
    let end_ns = now_ns() + patience.as_nanos() as u64;
    loop {
        while let Some(frame) = bus.receive() {
            if is_the_one(&frame) {
                return true;
            }
        }
        let left_ns = end_ns.saturating_sub(now_ns());
        if left_ns == 0 {
            return false;
        }
        bus.wait(Duration::from_nanos(left_ns));
    }
}

/// The rig that a heartbeat is of.
fn rig_of(frame: &WireFrame) -> Option<Node> {
    match Heartbeat::decode(frame.id(), frame.data()).ok()?.sender {
        Sender::Rig(node) => Some(node),
        Sender::Host => None,
    }
}

/// The sync of a run with a clock.
fn announcement(profile: Profile) -> Frame {
    Sync {
        version: PROTOCOL_VERSION,
        profile,
        pace: Pace::Clock,
        period_us: PERIOD_US,
        slow_down: NonZeroU8::MIN,
        time_us: (now_ns() / 1000) as u32,
    }
    .encode()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::{BusCounters, MemoryBus};
    use crate::rig::RigNode;
    use scenario::rig::RigFile;

    fn with_rig(profile: Profile) -> MemoryBus {
        let setup = RigFile::default_setup().unwrap();
        MemoryBus::new(std::iter::once(RigNode::new(&setup, Node::ALL[1], profile)))
    }

    #[test]
    fn a_rig_is_found_by_its_heartbeat_and_stays_unarmed() {
        let mut bus = with_rig(Profile::Classical);
        assert_eq!(hear_host(&mut bus), None);
        assert_eq!(find_rig(&mut bus, Profile::Classical), Some(Node::ALL[1]));
        assert_eq!(find_rig(&mut MemoryBus::default(), Profile::Classical), None);
    }

    #[test]
    fn a_host_on_the_bus_is_heard_before_anything_is_sent() {
        /// A bus on which a host sends and everything that is sent is counted.
        struct Overheard(Option<WireFrame>, u64);
        impl Bus for Overheard {
            fn send(&mut self, _frame: &Frame) -> Sent {
                self.1 += 1;
                Sent::Away
            }
            fn receive(&mut self) -> Option<WireFrame> {
                self.0.take()
            }
            fn wait(&mut self, _timeout: Duration) -> bool {
                false
            }
            fn counters(&self) -> BusCounters {
                BusCounters::default()
            }
        }
        let sync = WireFrame::from(&announcement(Profile::Classical));
        let mut bus = Overheard(Some(sync), 0);
        assert_eq!((hear_host(&mut bus), bus.1), (Some(MessageId::Sync.raw()), 0));
    }

    #[test]
    fn every_announcement_is_answered_or_lost() {
        let mut bus = with_rig(Profile::Classical);
        let by = AnsweredBy::Rig(Node::ALL[1]);
        let mut answers = AnswerTimes { by, sent: 0, lost: 0, times_ns: empty() };
        let is_answer = |frame: &WireFrame| rig_of(frame) == Some(Node::ALL[1]);
        answers.round(&mut bus, None, Profile::Classical, is_answer);
        assert_eq!((answers.sent, answers.lost, answers.times_ns.len()), (1, 0, 1));
        let mut nobody = MemoryBus::default();
        answers.round(&mut nobody, None, Profile::Classical, is_answer);
        assert_eq!((answers.sent, answers.lost, answers.times_ns.len()), (2, 1, 1));
    }

    #[test]
    fn an_end_that_was_asked_for_before_measures_nothing() {
        let (mut bus, mut echo) = (MemoryBus::default(), MemoryBus::default());
        let ended = AtomicBool::new(true);
        let by = AnsweredBy::Loopback;
        let answers = time_answers(&mut bus, Some(&mut echo), by, Profile::Classical, &ended);
        assert_eq!((answers.sent, answers.lost, answers.times_ns.len()), (0, 0, 0));
    }
}
