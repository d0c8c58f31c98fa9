//! A node that is driven by a timer and has a CAN driver: what an image runs.
//!
//! One interrupt of the timer is one [`TimedRig::tick`] or [`TimedLocomotive::tick`]. In lock-step
//! a rig answers a command as soon as it is polled; the locomotive's cycle waits for the tick after
//! the answer.

use crate::can::{receive, transmit};
use crate::locomotive::Locomotive;
use crate::rig::{Numbers, Plant, RigNode};
use crate::track::{Reader, Server, Source};
use can_protocol::Pace;
use embedded_can::nb::Can;

/// Cycles in which a rig that has lost its host in lock-step comes to rest: a second at 1 kHz,
/// more than it needs from the highest speed that a command can name.
const REST_TICKS: u32 = 1000;

/// A rig with its CAN driver.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedRig<P: Plant, N> {
    rig: RigNode<P, N>,
    /// Ticks of silence after which a lock-step host is lost.
    silence_ticks: u32,
    /// New commands so far, and ticks since the last of them.
    accepted: u64,
    silent_ticks: u32,
    /// Ticks of its own clock that are left to come to rest.
    resting: u32,
}

impl<P: Plant, N: Numbers> TimedRig<P, N> {
    /// A rig that has just started. In lock-step its host is lost after so many silent ticks,
    /// usually [`SILENCE_TICKS`](crate::locomotive::SILENCE_TICKS).
    pub fn new(rig: RigNode<P, N>, silence_ticks: u32) -> Self {
        Self { rig, silence_ticks, accepted: 0, silent_ticks: 0, resting: 0 }
    }

    /// The rig.
    pub fn rig(&self) -> &RigNode<P, N> {
        &self.rig
    }

    /// Every frame that has arrived; in lock-step the answer to one goes out before the next is
    /// taken.
    pub fn poll<C: Can>(&mut self, can: &mut C) {
        while let Some(frame) = receive(can) {
            self.rig.on_frame(&frame);
            if self.rig.pace() == Pace::LockStep {
                self.send(can);
            }
        }
    }

    /// One tick of the timer.
    pub fn tick<C: Can>(&mut self, can: &mut C) {
        self.poll(can);
        let is_idle = self.rig.is_idle() || (self.rig.is_latched() && self.rig.is_at_rest());
        match self.rig.pace() {
            Pace::Clock => self.rig.cycle(),
            // Without commands its own clock is the only one.
            Pace::LockStep if is_idle => self.rig.rest_if_uncommanded(),
            Pace::LockStep => self.watch_host(),
        }
        self.send(can);
    }

    /// In lock-step a host that is silent for a second is lost, and the rig's own clock stops the
    /// ram.
    fn watch_host(&mut self) {
        if let Some(left) = self.resting.checked_sub(1) {
            self.resting = if self.rig.is_at_rest() { 0 } else { left };
            return self.rig.cycle();
        }
        let accepted = self.rig.frames().received;
        let is_new = accepted != self.accepted;
        (self.accepted, self.silent_ticks) =
            (accepted, if is_new { 0 } else { self.silent_ticks.saturating_add(1) });
        if self.silent_ticks >= self.silence_ticks {
            self.rig.host_is_silent(self.silent_ticks);
            (self.silent_ticks, self.resting) = (0, REST_TICKS);
        }
    }

    /// A host that hears nothing acts by itself, so a frame that finds no room is lost.
    fn send<C: Can>(&mut self, can: &mut C) {
        while let Some(frame) = self.rig.take_frame() {
            let _lost = !transmit(can, &frame);
        }
    }
}

/// A locomotive with its CAN driver.
#[derive(Debug)]
pub struct TimedLocomotive<'a>(Locomotive<'a>);

impl<'a> TimedLocomotive<'a> {
    /// A locomotive that is going to announce itself.
    pub fn new(locomotive: Locomotive<'a>) -> Self {
        Self(locomotive)
    }

    /// The locomotive.
    pub fn locomotive(&self) -> &Locomotive<'a> {
        &self.0
    }

    /// The locomotive, to ask it to end.
    pub fn locomotive_mut(&mut self) -> &mut Locomotive<'a> {
        &mut self.0
    }

    /// One tick of the timer on the line's track, after `skipped` that were missed.
    pub fn tick<C: Can>(&mut self, can: &mut C, skipped: u32) {
        while let Some(frame) = receive(can) {
            self.0.hear(&frame);
        }
        self.0.tick(skipped);
        self.send(can);
    }

    /// The same on a track that a server on the same bus has.
    pub fn tick_reading<C: Can, const N: usize>(
        &mut self,
        can: &mut C,
        reader: &mut Reader<N>,
        skipped: u32,
    ) {
        while let Some(frame) = receive(can) {
            self.0.hear(&frame);
            reader.hear(&frame);
        }
        self.0.tick_reading(reader, skipped);
        self.send(can);
        if let Some(frame) = reader.take_frame() {
            // It is asked for again.
            let _lost = !transmit(can, &frame);
        }
    }

    fn send<C: Can>(&mut self, can: &mut C) {
        let mut had_room = true;
        while let Some(frame) = self.0.take_frame() {
            had_room &= transmit(can, &frame);
        }
        self.0.note_room(had_room);
    }
}

/// A track server with its CAN driver.
#[derive(Debug, Clone)]
pub struct TimedServer<S>(Server<S>);

impl<S: Source> TimedServer<S> {
    /// A server that waits for a locomotive.
    pub fn new(server: Server<S>) -> Self {
        Self(server)
    }

    /// The server.
    pub fn server(&self) -> &Server<S> {
        &self.0
    }

    /// One tick of the timer.
    pub fn tick<C: Can>(&mut self, can: &mut C) {
        while let Some(frame) = receive(can) {
            self.0.hear(&frame);
        }
        self.0.tick();
        while let Some(frame) = self.0.take_frame() {
            if !transmit(can, &frame) {
                return self.0.put_back(frame);
            }
        }
    }
}
