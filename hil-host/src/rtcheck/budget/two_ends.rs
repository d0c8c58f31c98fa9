//! Both ends of a bus in one thread: the host's, and that of emulated rigs which are served when
//! the host's cycle is over.

use crate::BenchError;
use crate::bus::{Bus, BusCounters, MAX_RIGS, Sent, SocketCanBus, WireFrame};
use crate::rig::RigNode;
use can_protocol::{Frame, MessageId, Profile};
use heapless::{Deque, Vec};
use std::time::Duration;

/// Frames that wait for either end.
const QUEUE_FRAMES: usize = 64;

/// What is between both ends.
#[derive(Debug)]
enum Between {
    /// Queues: to the rigs, to the host.
    Memory(Box<[Deque<WireFrame, QUEUE_FRAMES>; 2]>),
    /// Sockets on one interface: of the rigs, of the host.
    Sockets(Box<[SocketCanBus; 2]>),
}

/// Which end a frame goes to, or comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Rigs,
    Host,
}

/// A bus whose rigs answer when they are served.
#[derive(Debug)]
pub(super) struct TwoEnds {
    between: Between,
    rigs: Vec<RigNode, MAX_RIGS>,
}

impl TwoEnds {
    /// With queues in memory.
    pub(super) fn in_memory(rigs: impl Iterator<Item = RigNode>) -> Self {
        Self { between: Between::Memory(Box::default()), rigs: rigs.collect() }
    }

    /// With two sockets on an interface.
    ///
    /// # Errors
    /// An interface that cannot be used.
    pub(super) fn on(
        interface: &str,
        rigs: impl Iterator<Item = RigNode>,
        profile: Profile,
    ) -> Result<Self, BenchError> {
        let of = |is_of_host: bool| -> std::vec::Vec<MessageId> {
            MessageId::all().filter(|message| message.is_of_host() == is_of_host).collect()
        };
        // Each end hears what the other sends.
        let sockets = [
            SocketCanBus::open(interface, &of(true), profile)?,
            SocketCanBus::open(interface, &of(false), profile)?,
        ];
        Ok(Self { between: Between::Sockets(Box::new(sockets)), rigs: rigs.collect() })
    }

    /// The rigs take what has arrived, and their answers go out.
    pub(super) fn serve(&mut self) {
        while let Some(frame) = self.take(Side::Rigs) {
            self.rigs.iter_mut().for_each(|rig| rig.on_frame(&frame));
        }
        for number in 0..self.rigs.len() {
            while let Some(answer) = self.rigs.get_mut(number).and_then(RigNode::take_frame) {
                self.put(Side::Host, &answer);
            }
        }
    }

    fn put(&mut self, to: Side, frame: &Frame) -> Sent {
        match (&mut self.between, to) {
            (Between::Memory(queues), to) => {
                let [to_rigs, to_host] = &mut **queues;
                let queue = if to == Side::Rigs { to_rigs } else { to_host };
                let is_full = queue.push_back(WireFrame::from(frame)).is_err();
                if is_full { Sent::Dropped } else { Sent::Away }
            }
            (Between::Sockets(sockets), Side::Rigs) => sockets[1].send(frame),
            (Between::Sockets(sockets), Side::Host) => sockets[0].send(frame),
        }
    }

    fn take(&mut self, at: Side) -> Option<WireFrame> {
        match (&mut self.between, at) {
            (Between::Memory(queues), Side::Rigs) => queues[0].pop_front(),
            (Between::Memory(queues), Side::Host) => queues[1].pop_front(),
            (Between::Sockets(sockets), Side::Rigs) => sockets[0].receive(),
            (Between::Sockets(sockets), Side::Host) => sockets[1].receive(),
        }
    }
}

impl Bus for TwoEnds {
    #[inline]
    fn send(&mut self, frame: &Frame) -> Sent {
        self.put(Side::Rigs, frame)
    }

    #[inline]
    fn receive(&mut self) -> Option<WireFrame> {
        self.take(Side::Host)
    }

    fn wait(&mut self, _timeout: Duration) -> bool {
        // While nobody commands, a wait is a cycle of the rigs.
        self.rigs.iter_mut().for_each(RigNode::idle);
        self.serve();
        true
    }

    fn has_own_time(&self) -> bool {
        false
    }

    fn counters(&self) -> BusCounters {
        BusCounters::default()
    }
}
