//! The handshake before the first cycle.

use super::port::Port;
use super::session::{Session, SessionState};
use crate::bus::Bus;
use can_protocol::{MessageId, Sender};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Why a session cannot begin.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoAnswer {
    /// These nodes did not answer in time.
    Silent(Vec<u8>),
    /// The user ended the wait.
    Interrupted,
}

/// Time after which an announcement is repeated.
const ROUND: Duration = Duration::from_millis(100);

/// Longest wait for one frame.
const GLANCE: Duration = Duration::from_millis(5);

impl Session<'_> {
    /// Announces the session until every rig has sent its heartbeat, for at most `patience`.
    ///
    /// # Errors
    /// A rig that does not answer, or a stop.
    pub fn greet<B: Bus>(
        &self,
        state: &SessionState,
        buses: &mut [B],
        patience: Duration,
        stop: &AtomicBool,
    ) -> Result<(), NoAnswer> {
        let begin = Instant::now();
        let mut silent: Vec<&Port> = self.ports.iter().collect();
        while !silent.is_empty() {
            if stop.load(Ordering::Relaxed) {
                return Err(NoAnswer::Interrupted);
            }
            // Read before the round, so that a process that was suspended gets one more.
            let late = begin.elapsed() > patience;
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
        // What the rigs sent before the first command belongs to no cycle.
        for bus in buses {
            while bus.receive().is_some() {}
        }
        Ok(())
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
