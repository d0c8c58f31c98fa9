//! A bus around a bus: faults between the host and an emulated rig.

use super::change::Memory;
use super::kind::Fault;
use super::opener::Opener;
use crate::bus::{Bus, BusCounters, MemoryBus, Sent, WireFrame};
use crate::draw::Draw;
use crate::rig::{RigNode, WATCHDOG_CYCLES};
use can_protocol::{Frame, MessageId, Node, Profile};
use scenario::rig::RigSetup;
use std::collections::VecDeque;
use std::time::Duration;

/// Cycles of rest between two sessions.
const RELAXING_CYCLES: u32 = 1000;

/// A memory bus with a fault that begins in a cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultyBus {
    bus: MemoryBus,
    /// The rig that the fault is about.
    node: Node,
    /// Rigs beside it, to which nothing happens.
    others: Vec<Node>,
    setup: RigSetup,
    fault: Option<(Fault, u64, u64)>,
    memory: Memory,
    /// Commands that the host has sent since the session was coupled.
    cycle: u64,
    pending: VecDeque<WireFrame>,
    opener: Opener,
}

impl FaultyBus {
    /// A bus with one rig, without a fault yet.
    pub fn new(setup: &RigSetup, node: Node, seed: u64) -> Self {
        Self {
            bus: MemoryBus::new(Some(RigNode::new(setup, node, Profile::Classical))),
            node,
            others: Vec::new(),
            setup: setup.clone(),
            fault: None,
            memory: Memory::new(Draw::seeded(seed, 1)),
            cycle: 0,
            pending: VecDeque::new(),
            opener: Opener::default(),
        }
    }

    /// The same bus with sound rigs beside the one that the fault is about.
    #[must_use]
    pub fn beside(mut self, nodes: impl IntoIterator<Item = Node>) -> Self {
        self.others = nodes.into_iter().filter(|node| *node != self.node).collect();
        self.bus = self.fresh();
        self
    }

    /// A bus with all rigs, just started.
    fn fresh(&self) -> MemoryBus {
        let nodes = [self.node].into_iter().chain(self.others.iter().copied());
        MemoryBus::new(nodes.map(|node| RigNode::new(&self.setup, node, Profile::Classical)))
    }

    /// Begins a session: cycles count from here. The fault acts from `begin` for so many cycles.
    pub fn inject(&mut self, fault: Fault, begin: u64, lasts: u64) {
        self.fault = Some((fault, begin, lasts));
        self.cycle = 0;
        self.memory.begin();
    }

    /// The same bus without a fault, its rig reset by the key if it is latched.
    pub fn mend(&mut self) {
        self.fault = None;
        self.pending.clear();
        if self.bus.rigs().len() <= self.others.len() {
            self.bus = self.fresh();
        }
        // Its host is gone. The ram comes to rest and the damper relaxes before the key is turned.
        for rig in self.bus.rigs_mut() {
            rig.host_is_silent(WATCHDOG_CYCLES);
            (0..RELAXING_CYCLES).for_each(|_| rig.rest_if_uncommanded());
            rig.reset();
            while rig.take_frame().is_some() {}
        }
        // What it has sent belongs to no session.
        while self.bus.receive().is_some() {}
    }

    /// The rig that the fault is about.
    pub fn rig(&self) -> Option<&RigNode> {
        self.bus.rigs().iter().find(|rig| rig.node() == self.node)
    }

    /// The fault that acts, and the cycles since it began.
    fn acting(&self) -> Option<(Fault, u64)> {
        let (fault, begin, lasts) = self.fault?;
        let since = self.cycle.checked_sub(begin).filter(|since| *since < lasts)?;
        Some((fault, since))
    }

    /// The sound rigs as they are.
    fn rigs_beside(&self) -> Vec<RigNode> {
        self.bus.rigs().iter().filter(|rig| rig.node() != self.node).cloned().collect()
    }

    /// Lets the rig go on without a command.
    fn pass_slot(&mut self) {
        self.bus.rigs_mut().iter_mut().for_each(RigNode::cycle);
        // Collects its answers.
        self.bus.wait(Duration::ZERO);
    }

    /// What happens with the first and with every command of the host.
    fn on_command(&mut self, fault: Fault, since: u64) {
        if fault == Fault::Reboot && since == 0 {
            let rig = RigNode::new(&self.setup, self.node, Profile::Classical);
            self.bus = MemoryBus::new(std::iter::once(rig).chain(self.rigs_beside()));
        }
        if fault == Fault::Gone && since == 0 {
            self.bus = MemoryBus::new(self.rigs_beside());
        }
        if let Some(foreign) = fault.foreign_command(self.node, since) {
            self.bus.inject(&foreign);
        }
        self.pending.extend(fault.flood());
    }
}

impl Bus for FaultyBus {
    fn send(&mut self, frame: &Frame) -> Sent {
        let is_command = frame.id() == MessageId::Command(Profile::Classical, self.node).raw();
        self.cycle += u64::from(is_command);
        self.opener.hear(self.node, &WireFrame::from(frame));
        let Some((fault, since)) = self.acting() else { return self.bus.send(frame) };
        if is_command {
            self.on_command(fault, since);
        }
        match fault {
            Fault::Down => Sent::Down,
            Fault::SkipSlots(slots) if is_command && since == 0 => {
                let sent = self.bus.send(frame);
                (0..slots).for_each(|_| self.pass_slot());
                sent
            }
            Fault::NoRoom { full, of } if is_command && since % of < full => Sent::Dropped,
            _ if is_command && fault.loses_command(since, &mut self.memory.draw) => Sent::Away,
            _ => self.bus.send(frame),
        }
    }

    fn receive(&mut self) -> Option<WireFrame> {
        loop {
            if let Some(frame) = self.pending.pop_front() {
                return Some(frame);
            }
            let frame = self.bus.receive()?;
            let seal = self.opener.hear(self.node, &frame);
            match (self.acting(), seal) {
                (Some((Fault::Down, _)), _) => {}
                (Some((fault, since)), Some(seal)) => {
                    let frames = fault.change(since, frame, seal, self.node, &mut self.memory);
                    self.pending.extend(frames);
                }
                _ => return Some(frame),
            }
        }
    }

    fn wait(&mut self, timeout: Duration) -> bool {
        !self.pending.is_empty() || self.bus.wait(timeout)
    }

    fn counters(&self) -> BusCounters {
        self.bus.counters()
    }
}
