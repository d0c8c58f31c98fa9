//! The handshake before arming: who is there, and an operator's consent.

use super::no_answer::NoAnswer;
use super::port::Port;
use super::requests::Requests;
use super::session::{Session, SessionState};
use crate::bus::{Bus, WireFrame};
use can_protocol::arming::{Listener, Quiet};
use can_protocol::{
    Error, Fault, FaultCode, Heartbeat, MessageId, PROTOCOL_VERSION, RunState, Sender,
};
use firmware_core::supervision::Event;
use std::time::{Duration, Instant};

/// Time after which an announcement is repeated.
const ROUND: Duration = Duration::from_millis(100);

/// Longest wait for one frame.
const GLANCE: Duration = Duration::from_millis(5);

impl Session<'_> {
    /// Meets the rigs and arms them: the next cycle is the first of `RAMP_IN`.
    ///
    /// # Errors
    /// Those of [`Session::meet`] and [`Session::arm`].
    pub fn greet<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut [B],
        patience: Duration,
        requests: &Requests,
    ) -> Result<(), NoAnswer> {
        self.meet(state, buses, patience, requests)?;
        self.arm(state, buses, requests)
    }

    /// Announces the session until every rig has agreed to it by a heartbeat, for at most
    /// `patience`, and waits for an operator who lets it be armed.
    ///
    /// # Errors
    /// A rig that does not answer, is latched or has another version of the protocol, or a stop.
    pub fn meet<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut [B],
        patience: Duration,
        requests: &Requests,
    ) -> Result<(), NoAnswer> {
        state.quiet = buses.iter().map(|_| Quiet::new(Listener::Host)).collect();
        debug_assert_eq!(state.quiet.len(), buses.len(), "more buses than damper slots");
        let until = Instant::now() + patience;
        let mut silent: Vec<&Port> = self.ports.iter().collect();
        let mut refusing: Option<&Port> = None;
        let mut is_waiting = false;
        loop {
            if requests.is_ending() {
                return Err(NoAnswer::Interrupted);
            }
            if silent.is_empty() && requests.may_arm() {
                break;
            }
            if silent.is_empty() && !is_waiting {
                is_waiting = true;
                requests.wait_for_arming();
                files::say!("the rigs are ready and wait to be armed");
            }
            // Read before the round, so that a process that was suspended gets one more.
            let late = Instant::now() > until;
            let (sync, heartbeat) = (self.sync(state), self.heartbeat(state));
            for bus in buses.iter_mut() {
                bus.send(&sync);
                bus.send(&heartbeat);
            }
            // A heartbeat says more than a fault: it has one more round to come.
            let refused = refusing;
            self.hear(state, &mut silent, &mut refusing, buses)?;
            if let Some(port) = refused.filter(|port| silent.contains(port)) {
                let node = port.node.number();
                return Err(NoAnswer::RefusedSync { node, session: self.sync_message(state) });
            }
            if late && !silent.is_empty() {
                let nodes = silent.iter().map(|port| port.node.number()).collect();
                return Err(NoAnswer::Silent(nodes));
            }
        }
        state.line.on(Event::Agreed);
        Ok(())
    }

    /// Listens for one round, or until the last rig has answered; ports whose rigs have answered
    /// leave the list. `refusing` is the last whose rig has refused the session.
    fn hear<'a, B: Bus>(
        &'a self,
        state: &mut SessionState,
        silent: &mut Vec<&Port>,
        refusing: &mut Option<&'a Port>,
        buses: &mut [B],
    ) -> Result<(), NoAnswer> {
        let (round, is_waiting) = (Instant::now(), silent.is_empty());
        while round.elapsed() < ROUND && (is_waiting || !silent.is_empty()) {
            for (number, bus) in buses.iter_mut().enumerate() {
                while let Some(frame) = bus.receive() {
                    if let Some(quiet) = state.quiet.get_mut(number) {
                        quiet.hear(frame.id(), frame.data());
                    }
                    let ports = self.ports.iter().zip(&mut state.ports);
                    for (port, memory) in ports.filter(|(port, _)| port.bus == number) {
                        port.hear_state(memory, &frame);
                        if has_refused(port, &frame) {
                            *refusing = Some(port);
                        }
                        if has_agreed(port, &frame)? {
                            silent.retain(|known| known.node != port.node || known.bus != number);
                        }
                    }
                }
                if is_waiting {
                    // Nothing is urgent before an operator has decided.
                    std::thread::sleep(GLANCE);
                    bus.wait(Duration::ZERO);
                } else if !silent.is_empty() {
                    bus.wait(GLANCE);
                }
            }
        }
        Ok(())
    }
}

/// Whether a frame is a fault with which a rig refuses an announced session.
fn has_refused(port: &Port, frame: &WireFrame) -> bool {
    let fault = Fault::decode(frame.id(), frame.data());
    fault.is_ok_and(|fault| {
        fault.sender == Sender::Rig(port.node) && fault.code == FaultCode::ConfigurationMismatch
    })
}

/// Whether a frame is a heartbeat of a rig that has agreed to the session.
fn has_agreed(port: &Port, frame: &WireFrame) -> Result<bool, NoAnswer> {
    if frame.id() != MessageId::Heartbeat(Sender::Rig(port.node)).raw() {
        return Ok(false);
    }
    let node = port.node.number();
    let heartbeat = match Heartbeat::decode(frame.id(), frame.data()) {
        Ok(heartbeat) => heartbeat,
        Err(Error::Length { .. }) => return Err(NoAnswer::Version { node, version: None }),
        Err(_) => return Ok(false),
    };
    match heartbeat.state {
        _ if heartbeat.version != PROTOCOL_VERSION => {
            Err(NoAnswer::Version { node, version: Some(heartbeat.version) })
        }
        state @ (RunState::Safe | RunState::Fault) => Err(NoAnswer::Latched { node, state }),
        // Its own heartbeat, before it has heard of this session.
        RunState::Init => Ok(false),
        _ => Ok(true),
    }
}
