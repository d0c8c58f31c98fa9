//! Quiet: how long no other host and no second node was heard.
use crate::{Heartbeat, MessageId, Node, Sender};
use core::fmt;

/// Counts the cycles since a foreign frame. A side must be quiet for [`Quiet::CYCLES`] before it
/// arms.
///
/// A host hears another host by any frame that only a host sends, a rig by a command (nobody
/// commands a rig that is not armed). Both hear a second node under one number, or one that
/// restarted, by a heartbeat with another boot number; a rig also by any frame under its own ids.
///
/// ```
/// use can_protocol::arming::{Listener, Quiet};
/// use can_protocol::{Heartbeat, RunState, Sender};
/// let mut quiet = Quiet::new(Listener::Host);
/// (0..300).for_each(|_| quiet.cycle());
/// assert!(quiet.is_quiet());
/// let (frame, _) = Heartbeat::new(Sender::Host, 0, RunState::Run, 0xDEAD_BEEF).encode();
/// quiet.hear(frame.id(), frame.data());
/// assert_eq!(quiet.remaining(), 300);
/// assert_eq!(quiet.heard().unwrap().to_string(), "HEARTBEAT_HOST of another host");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quiet {
    listener: Listener,
    /// Cycles still to come without a foreign frame.
    remaining: u16,
    /// The boot numbers last heard: host, then nodes 1 to 4.
    boots: [Option<u32>; 5],
    heard: Option<Heard>,
}

/// Who listens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Listener {
    /// The host, on one bus; it does not hear its own frames.
    Host,
    /// A rig; it does not hear its own frames.
    Rig(Node),
}

/// A foreign frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heard {
    /// Which.
    pub message: MessageId,
    /// Of whom.
    pub who: Foreign,
}

/// Who should not be on the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Foreign {
    /// Another host, or the host started again.
    AnotherHost,
    /// A second node under one number, or the node started again.
    SecondNode,
}

impl Quiet {
    /// How many cycles must pass without a foreign frame.
    pub const CYCLES: u16 = 300;

    /// Nothing heard yet, all cycles to come.
    pub const fn new(listener: Listener) -> Self {
        Self { listener, remaining: Self::CYCLES, boots: [None; 5], heard: None }
    }

    /// One cycle passed.
    pub const fn cycle(&mut self) {
        self.remaining = self.remaining.saturating_sub(1);
    }

    /// Take notice of a frame, whatever it is.
    pub fn hear(&mut self, id: u16, data: &[u8]) {
        let Some(message) = MessageId::from_raw(id) else { return };
        let who = match (self.listener, message) {
            (listener, MessageId::Heartbeat(sender)) if !is_own(listener, sender) => {
                self.foreign_heartbeat(sender, id, data)
            }
            (Listener::Host, _) => message.is_of_host().then_some(Foreign::AnotherHost),
            (Listener::Rig(own), MessageId::Command(_, node)) if node == own => {
                Some(Foreign::AnotherHost)
            }
            (Listener::Rig(own), _) => is_of_rig(message, own).then_some(Foreign::SecondNode),
        };
        if let Some(who) = who {
            self.restart(Heard { message, who });
        }
    }

    /// Starts the count anew.
    pub(super) const fn restart(&mut self, heard: Heard) {
        self.remaining = Self::CYCLES;
        self.heard = Some(heard);
    }

    /// A heartbeat whose boot number is not the one heard before. The first one is nobody's
    /// second.
    fn foreign_heartbeat(&mut self, sender: Sender, id: u16, data: &[u8]) -> Option<Foreign> {
        let heartbeat = Heartbeat::decode(id, data).ok()?;
        let known = self.boots.get_mut(usize::from(sender.number()))?;
        let before = known.replace(heartbeat.boot);
        let who = match sender {
            Sender::Host => Foreign::AnotherHost,
            Sender::Rig(_) => Foreign::SecondNode,
        };
        before.is_some_and(|boot| boot != heartbeat.boot).then_some(who)
    }

    /// Whether all cycles passed.
    pub const fn is_quiet(&self) -> bool {
        self.remaining == 0
    }

    /// Cycles still to come without a foreign frame.
    pub const fn remaining(&self) -> u16 {
        self.remaining
    }

    /// The foreign frame heard last, if any.
    pub const fn heard(&self) -> Option<Heard> {
        self.heard
    }

    /// The boot number that a peer's heartbeat last had.
    pub fn boot(&self, sender: Sender) -> Option<u32> {
        self.boots.get(usize::from(sender.number())).copied().flatten()
    }
}

fn is_own(listener: Listener, sender: Sender) -> bool {
    match listener {
        Listener::Host => sender == Sender::Host,
        Listener::Rig(node) => sender == Sender::Rig(node),
    }
}

/// Messages that only this rig sends.
fn is_of_rig(message: MessageId, own: Node) -> bool {
    match message {
        MessageId::Measurement(_, node)
        | MessageId::Telemetry(node)
        | MessageId::ArmAnswer(node)
        | MessageId::Fault(Sender::Rig(node))
        | MessageId::Heartbeat(Sender::Rig(node)) => node == own,
        _ => false,
    }
}

impl fmt::Display for Heard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let who = match self.who {
            Foreign::AnotherHost => "another host",
            Foreign::SecondNode => "a second node",
        };
        write!(f, "{} of {who}", self.message)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Profile, RunState};

    const NODE: Node = Node::ALL[0];

    fn heartbeat(sender: Sender, boot: u32) -> crate::Frame {
        Heartbeat::new(sender, 0, RunState::Standby, boot).encode().0
    }

    /// Whether one frame of this id, content unread, starts the count anew.
    fn disturbs(listener: Listener, message: MessageId) -> bool {
        let mut quiet = Quiet::new(listener);
        (0..Quiet::CYCLES).for_each(|_| quiet.cycle());
        quiet.hear(message.raw(), &[0; 16]);
        assert_eq!(quiet.is_quiet(), quiet.heard().is_none());
        !quiet.is_quiet()
    }

    #[test]
    fn a_host_is_disturbed_by_every_frame_that_only_a_host_sends() {
        for message in MessageId::all() {
            assert_eq!(disturbs(Listener::Host, message), message.is_of_host(), "{message}");
        }
    }

    #[test]
    fn a_rig_is_disturbed_by_a_command_and_by_its_own_ids() {
        for message in MessageId::all() {
            let expected = is_of_rig(message, NODE)
                || [Profile::Classical, Profile::Fd]
                    .iter()
                    .any(|profile| message == MessageId::Command(*profile, NODE));
            assert_eq!(disturbs(Listener::Rig(NODE), message), expected, "{message}");
        }
    }

    #[test]
    fn a_second_boot_number_under_one_sender_disturbs() {
        for (listener, sender, who) in [
            (Listener::Host, Sender::Rig(NODE), Foreign::SecondNode),
            (Listener::Rig(NODE), Sender::Host, Foreign::AnotherHost),
            (Listener::Rig(NODE), Sender::Rig(Node::ALL[1]), Foreign::SecondNode),
        ] {
            let mut quiet = Quiet::new(listener);
            (0..Quiet::CYCLES).for_each(|_| quiet.cycle());
            let first = heartbeat(sender, 1);
            quiet.hear(first.id(), first.data());
            quiet.hear(first.id(), first.data());
            assert!(quiet.is_quiet());
            assert_eq!(quiet.boot(sender), Some(1));
            let second = heartbeat(sender, 2);
            quiet.hear(second.id(), second.data());
            let heard = Heard { message: MessageId::Heartbeat(sender), who };
            assert_eq!((quiet.remaining(), quiet.heard()), (Quiet::CYCLES, Some(heard)));
        }
    }

    #[test]
    fn foreign_protocols_and_damaged_heartbeats_do_not() {
        let mut quiet = Quiet::new(Listener::Host);
        (0..Quiet::CYCLES).for_each(|_| quiet.cycle());
        quiet.hear(0x123, &[1, 2, 3]);
        quiet.hear(0x701, &[0; 8]);
        quiet.hear(0x701, &[]);
        assert!(quiet.is_quiet());
    }
}
