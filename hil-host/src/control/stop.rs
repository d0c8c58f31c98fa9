//! What stopped a session: one cause, with its time, its cycle and its node.

use can_protocol::{Fault, FaultCode, Frame, Node, PressureOff, RunState, Sender};
use firmware_core::supervision::{Cause, Noted, Signal};
use nodes::locomotive::fault_of;
use serde::{Deserialize, Serialize};
use std::fmt;

/// What stopped a session.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Control cycle in which it was found.
    pub cycle: u64,
    /// Time of that cycle, s.
    pub time_s: f64,
    /// The rig that it is about.
    pub node: Option<u8>,
    /// The signal with its value and its limit.
    pub cause: Cause,
    /// Ticks that the host skipped just before: then the rig may not be to blame.
    pub skipped: u64,
}

/// Something that the loop has found, for the events of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Notice {
    /// What stopped the session.
    Cause(Stop),
    /// The first time that something was beyond a limit which ends nothing.
    Noted(Stop),
    /// A rig whose slot goes on with its model.
    DroppedOut {
        /// The number of the slot, from 0.
        slot: usize,
        /// Why, and from when.
        why: Stop,
    },
}

/// A request to drop the pressure, which is sent twice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PressureRequest {
    stop: Stop,
    sent: u8,
}

impl PressureRequest {
    /// How often it is sent.
    const TIMES: u8 = 2;

    pub(super) const fn new(stop: Stop) -> Self {
        Self { stop, sent: 0 }
    }

    /// The next frame of it, while it is to be sent. A cause without a rig is for all of them.
    pub(super) fn next(&mut self, state: RunState) -> Option<Frame> {
        let counter = self.sent;
        if counter >= Self::TIMES {
            return None;
        }
        self.sent += 1;
        let node = self.stop.node.and_then(|node| Node::new(node).ok());
        let (code, detail) = fault_of(&self.stop.cause);
        Some(PressureOff { node, counter, state, code, detail }.encode().0)
    }
}

/// The same in `summary.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StopSummary {
    /// Time, s.
    pub time_s: f64,
    /// Control cycle.
    pub cycle: u64,
    /// The rig that it is about; null where it is the host, the bus or the vehicle.
    pub node: Option<u8>,
    /// Key of the signal.
    pub signal: String,
    /// In words.
    pub message: String,
    /// Value of the signal.
    pub value: f64,
    /// Its limit; null where there is none.
    pub limit: Option<f64>,
    /// Unit of both; null for a code.
    pub unit: Option<String>,
    /// What the limit asks for.
    pub action: String,
    /// Ticks that the host skipped just before.
    #[serde(default)]
    pub skipped_ticks: u64,
}

/// Something beyond a limit that ended nothing, in `summary.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NotedSummary {
    /// The first time.
    #[serde(flatten)]
    pub first: StopSummary,
    /// How often it was found: once in each cycle, or cycle of the motion.
    pub times: u64,
    /// Value of the largest magnitude.
    pub largest: f64,
}

/// A rig that was lost while the vehicle went on, in `summary.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DropOutSummary {
    /// Place of its damper on the vehicle.
    pub place: String,
    /// Why, and from when; the message names the place.
    #[serde(flatten)]
    pub why: StopSummary,
}

impl NotedSummary {
    /// What was noted of a rig, and its first time.
    pub(super) fn of(noted: &Noted, first: Stop) -> Self {
        Self { first: first.summary(), times: noted.times, largest: noted.largest }
    }
}

impl DropOutSummary {
    /// Of the damper at a place.
    pub(crate) fn of(place: &str, why: &Stop) -> Self {
        let mut message = format!("from {:.3} s {place} ran on its model: ", why.time_s);
        // Writing to a string cannot fail.
        let _ = why.write_what(&mut message);
        Self { place: place.to_owned(), why: StopSummary { message, ..why.summary() } }
    }
}

impl Stop {
    /// For `summary.json`.
    pub fn summary(&self) -> StopSummary {
        let Cause { signal, value, limit, action } = self.cause;
        StopSummary {
            time_s: self.time_s,
            cycle: self.cycle,
            node: self.node,
            signal: signal.key().to_owned(),
            message: self.to_string(),
            value,
            limit: limit.is_finite().then_some(limit),
            unit: signal.unit().map(str::to_owned),
            action: action.name().to_owned(),
            skipped_ticks: self.skipped,
        }
    }

    /// The host's fault message.
    pub(super) fn fault(&self, counter: u8, state: RunState) -> Frame {
        let (code, detail) = fault_of(&self.cause);
        let fault = Fault { sender: Sender::Host, counter, state, code, detail };
        fault.encode().0
    }

    /// The value in words, where it is a code.
    fn coded(&self) -> Option<String> {
        let value = self.cause.value;
        match self.cause.signal {
            Signal::RigState => RunState::ALL
                .into_iter()
                .find(|state| f64::from(state.code()) == value)
                .map(|state| state.name().to_owned()),
            Signal::RigFault => {
                let code = FaultCode::from_code(value as u16);
                Some(format!("{} ({})", code.name(), code.code()))
            }
            Signal::RigTrip => {
                let trips = can_protocol::Trips::from_bits_truncate(value as u8);
                Some(trips.iter_names().map(|(name, _)| name).collect::<Vec<_>>().join(", "))
            }
            Signal::SecondSender => Some(format!("{:#05x}", value as u16)),
            _ => None,
        }
    }
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "at {:.3} s (cycle {}), ", self.time_s, self.cycle)?;
        self.write_what(f)
    }
}

impl Stop {
    /// What was found, without its time.
    fn write_what(&self, f: &mut impl fmt::Write) -> fmt::Result {
        let Cause { signal, value, limit, .. } = self.cause;
        if let Some(node) = self.node {
            write!(f, "rig node {node}: ")?;
        }
        write!(f, "{}", signal.name())?;
        match (self.coded(), signal.unit()) {
            (Some(code), _) => write!(f, " {code}"),
            // A fact that no limit has counted.
            (None, Some("cycles")) if !limit.is_finite() => Ok(()),
            (None, Some("cycles")) => write!(f, " {value:.0} cycles, limit {limit:.0} cycles"),
            (None, Some(unit)) => {
                write!(f, " {} {unit}", report::significant(value, 4))?;
                let limit = limit.is_finite().then(|| report::significant(limit, 4));
                limit.map_or(Ok(()), |limit| write!(f, ", limit {limit} {unit}"))
            }
            (None, None) => Ok(()),
        }?;
        match self.skipped {
            0 => Ok(()),
            1 => write!(f, "; this host had just skipped a tick"),
            ticks => write!(f, "; this host had just skipped {ticks} ticks"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_core::supervision::Action;

    fn stop(signal: Signal, value: f64, limit: f64) -> Stop {
        let cause = Cause { signal, value, limit, action: Action::Stop };
        Stop { cycle: 15_005, time_s: 15.004, node: Some(1), cause, skipped: 0 }
    }

    #[test]
    fn a_stop_says_what_where_and_how_much() {
        let texts = [
            (stop(Signal::Force, 99_000.0, 40_000.0), "measured force 99000 N, limit 40000 N"),
            (stop(Signal::RigState, 7.0, f64::INFINITY), "state of the rig FAULT"),
            (stop(Signal::RigFault, 36.0, f64::INFINITY), "fault of the rig EMERGENCY_STOP (36)"),
            (stop(Signal::SecondSender, 513.0, f64::INFINITY), "second sender on 0x201"),
            (
                stop(Signal::WrongSeal, 5.0, 5.0),
                "measurements with a wrong CRC 5 cycles, limit 5 cycles",
            ),
            (stop(Signal::WrongSeal, 1.0, f64::INFINITY), "measurements with a wrong CRC"),
            (
                stop(Signal::RigTrip, 192.0, f64::INFINITY),
                "guard or limit of the rig GUARD_OPEN, EMERGENCY_STOP",
            ),
        ];
        for (stop, text) in texts {
            let whole = format!("at 15.004 s (cycle 15005), rig node 1: {text}");
            assert_eq!(stop.to_string(), whole);
        }
    }

    #[test]
    fn a_late_host_blamed_its_rig() {
        let late = Stop { skipped: 10, ..stop(Signal::OldMeasurements, 5.0, 5.0) };
        let text = late.to_string();
        assert!(text.ends_with("limit 5 cycles; this host had just skipped 10 ticks"), "{text}");
    }

    #[test]
    fn every_cause_has_a_fault_code() {
        for signal in Signal::ALL {
            let frame = stop(signal, 20.0, 10.0).fault(3, RunState::Safe);
            let fault = Fault::decode(frame.id(), frame.data()).unwrap();
            assert_eq!((fault.sender, fault.counter), (Sender::Host, 3));
            assert!(fault.code != FaultCode::Cleared, "{signal:?}");
        }
    }
}
