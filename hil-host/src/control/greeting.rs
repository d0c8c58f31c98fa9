//! The handshake before the first cycle: who is there, and where every ram stands.

use super::port::Port;
use super::requests::Requests;
use super::session::{Session, SessionState};
use crate::BenchError;
use crate::bus::{Bus, BusChoice};
use can_protocol::{MessageId, RunState, Sender};
use firmware_core::guard::Command;
use firmware_core::supervision::Event;
use firmware_core::vehicle::DAMPER_SLOTS;
use std::time::{Duration, Instant};

/// Why a session cannot begin.
#[derive(Debug, Clone, PartialEq)]
pub enum NoAnswer {
    /// These nodes did not answer in time.
    Silent(Vec<u8>),
    /// These nodes did not say where their ram stands.
    NoDisplacement(Vec<u8>),
    /// A ram stands too far from where the vehicle needs it.
    TooFar {
        /// Its node.
        node: u8,
        /// Where it stands (m).
        ram_m: f64,
    },
    /// The user ended the wait.
    Interrupted,
}

impl NoAnswer {
    /// The error of a run on a bus.
    pub(crate) fn on(self, bus: &BusChoice) -> BenchError {
        let bus = bus.to_string();
        match self {
            Self::Silent(nodes) => BenchError::SilentRigs { nodes, bus },
            Self::NoDisplacement(nodes) => BenchError::BlindRigs { nodes, bus },
            Self::TooFar { node, ram_m } => BenchError::FarRam { node, bus, ram_m },
            Self::Interrupted => BenchError::Interrupted,
        }
    }
}

/// Time after which an announcement is repeated.
const ROUND: Duration = Duration::from_millis(100);

/// Patience with a rig that has answered before.
const ROUND_TRIP: Duration = Duration::from_secs(1);

/// Longest wait for one frame.
const GLANCE: Duration = Duration::from_millis(5);

impl Session<'_> {
    /// Announces the session until every rig has sent its heartbeat and its displacement, for at
    /// most `patience`; waits for an operator to arm it; and couples it: the next cycle is the first
    /// of `RAMP_IN`.
    ///
    /// # Errors
    /// A rig that does not answer or stands too far away, or a stop.
    pub fn greet<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut [B],
        patience: Duration,
        requests: &Requests,
    ) -> Result<(), NoAnswer> {
        let until = Instant::now() + patience;
        self.announce_to_rigs(state, buses, until, requests)?;
        state.line.on(Event::Agreed);
        let mut rams_m = self.rams_m(state, buses, until, requests)?;
        if !requests.may_arm() {
            eprintln!("the rigs are ready and wait to be armed");
        }
        while !requests.may_arm() {
            // A ram may be moved by its own controller until it is armed.
            std::thread::sleep(ROUND);
            state.ports.iter_mut().zip(&self.ports).for_each(|(memory, port)| port.forget(memory));
            rams_m = self.rams_m(state, buses, Instant::now() + ROUND_TRIP, requests)?;
        }
        // What the rigs sent before the first command of the run belongs to no cycle.
        for bus in buses {
            while bus.receive().is_some() {}
        }
        state.line.on(Event::Arm);
        self.line.couple(&mut state.line, rams_m).map_err(|far| {
            let port = self.ports.iter().find(|port| port.slot == far.slot);
            NoAnswer::TooFar { node: port.map_or(0, |port| port.node.number()), ram_m: far.ram_m }
        })?;
        for (port, memory) in self.ports.iter().zip(&mut state.ports) {
            port.begin(memory, state.line.slots[port.slot].command);
        }
        Ok(())
    }

    /// Announces the session until every rig has sent its heartbeat.
    fn announce_to_rigs<B: Bus>(
        &self,
        state: &SessionState,
        buses: &mut [B],
        until: Instant,
        requests: &Requests,
    ) -> Result<(), NoAnswer> {
        let mut silent: Vec<&Port> = self.ports.iter().collect();
        while !silent.is_empty() {
            if requests.is_ending() {
                return Err(NoAnswer::Interrupted);
            }
            // Read before the round, so that a process that was suspended gets one more.
            let late = Instant::now() > until;
            for bus in buses.iter_mut() {
                bus.send(&self.sync(state));
            }
            hear(&mut silent, buses);
            if late && !silent.is_empty() {
                return Err(NoAnswer::Silent(
                    silent.iter().map(|port| port.node.number()).collect(),
                ));
            }
        }
        Ok(())
    }

    /// Asks every rig where its ram stands, with commands in STANDBY; by slot (m).
    fn rams_m<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut [B],
        until: Instant,
        requests: &Requests,
    ) -> Result<[f64; DAMPER_SLOTS], NoAnswer> {
        let mut rams_m = [0.0; DAMPER_SLOTS];
        loop {
            if requests.is_ending() {
                return Err(NoAnswer::Interrupted);
            }
            let late = Instant::now() > until;
            let mut missing = Vec::new();
            for (port, memory) in self.ports.iter().zip(&mut state.ports) {
                match port.displacement_m(memory) {
                    Some(ram_m) => rams_m[port.slot] = ram_m,
                    None => missing.push(port.node.number()),
                }
            }
            if missing.is_empty() {
                return Ok(rams_m);
            }
            if late {
                return Err(NoAnswer::NoDisplacement(missing));
            }
            self.ask(state, buses);
        }
    }

    /// One command in STANDBY to every rig, and what comes back.
    fn ask<B: Bus>(&self, state: &mut SessionState, buses: &mut [B]) {
        for (port, memory) in self.ports.iter().zip(&mut state.ports) {
            let frame = port.command(memory, &Command::default(), RunState::Standby, 0);
            if let Some(bus) = buses.get_mut(port.bus) {
                bus.send(&frame);
            }
        }
        for (number, bus) in buses.iter_mut().enumerate() {
            if self.ports.iter().any(|port| port.bus == number) {
                bus.wait(GLANCE);
            }
            while let Some(frame) = bus.receive() {
                let mut ports = self.ports.iter().zip(&mut state.ports);
                ports.any(|(port, memory)| port.bus == number && port.take_frame(memory, &frame));
            }
        }
    }
}

/// Listens for one round; ports whose rigs have answered leave the list.
fn hear<B: Bus>(silent: &mut Vec<&Port>, buses: &mut [B]) {
    let round = Instant::now();
    while !silent.is_empty() && round.elapsed() < ROUND {
        for (number, bus) in buses.iter_mut().enumerate() {
            while let Some(frame) = bus.receive() {
                silent.retain(|port| {
                    let heartbeat = MessageId::Heartbeat(Sender::Rig(port.node));
                    port.bus != number || frame.id() != heartbeat.raw()
                });
            }
            if !silent.is_empty() {
                bus.wait(GLANCE);
            }
        }
    }
}
