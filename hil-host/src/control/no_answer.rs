//! Why a session cannot begin.

use crate::BenchError;
use crate::bus::BusChoice;
use can_protocol::arming::Refusal;
use can_protocol::{RunState, Sync};

/// Why a session cannot begin.
#[derive(Debug, Clone, PartialEq)]
pub enum NoAnswer {
    /// These nodes did not answer in time.
    Silent(Vec<u8>),
    /// A rig speaks another version of the protocol.
    Version {
        /// Its node.
        node: u8,
        /// Its version; none where its heartbeat cannot be read.
        version: Option<u8>,
    },
    /// A rig refuses the announced session, by FAULT `CONFIGURATION_MISMATCH`.
    RefusedSync {
        /// Its node.
        node: u8,
        /// The session that it cannot follow.
        session: Sync,
    },
    /// A rig is latched in SAFE or FAULT.
    Latched {
        /// Its node.
        node: u8,
        /// Its state.
        state: RunState,
    },
    /// A rig was not armed.
    Refused {
        /// Its node.
        node: u8,
        /// What stood against it.
        refusal: Refusal,
    },
    /// A rig does not take part in an exchange, because another host commands it.
    Commanded {
        /// Its node.
        node: u8,
        /// Its state.
        state: RunState,
    },
    /// These nodes did not say where their ram stands.
    NoDisplacement(Vec<u8>),
    /// A ram stands too far from where the vehicle needs it.
    TooFar {
        /// Its node.
        node: u8,
        /// Where it stands (m).
        ram_m: f64,
    },
    /// A motion in open loop leads beyond the agreed stroke.
    NoRoom {
        /// Its node.
        node: u8,
        /// Where its ram stands (m).
        ram_m: f64,
        /// The farthest from mid-stroke that the motion leads (m).
        reach_m: f64,
        /// The agreed stroke (m).
        stroke_m: f64,
    },
    /// The user ended the wait.
    Interrupted,
}

impl NoAnswer {
    /// The error of a run on a bus.
    pub fn on(self, bus: &BusChoice) -> BenchError {
        let bus = bus.to_string();
        match self {
            Self::Silent(nodes) => BenchError::SilentRigs { nodes, bus },
            Self::Version { node, version } => BenchError::ForeignVersion { node, bus, version },
            Self::RefusedSync { node, session } => BenchError::RefusedSync { node, bus, session },
            Self::Latched { node, state } => BenchError::LatchedRig { node, bus, state },
            Self::Refused { node, refusal } => BenchError::UnarmedRig { node, bus, refusal },
            Self::Commanded { node, state } => BenchError::CommandedRig { node, bus, state },
            Self::NoDisplacement(nodes) => BenchError::BlindRigs { nodes, bus },
            Self::TooFar { node, ram_m } => BenchError::FarRam { node, bus, ram_m },
            Self::NoRoom { node, ram_m, reach_m, stroke_m } => {
                BenchError::NoRoom { node, bus, ram_m, reach_m, stroke_m }
            }
            Self::Interrupted => BenchError::Interrupted,
        }
    }
}
