//! The armed sessions of a run: what host and rig have exchanged.

use crate::control::{Port, PortState};
use serde::{Deserialize, Serialize};

/// The session of one rig.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ArmedSession {
    /// The rig's node.
    pub node: u8,
    /// The host's number.
    pub host_number: u32,
    /// The rig's number.
    pub rig_number: u32,
    /// The code that both give, which seals commands and measurements.
    pub session_code: u16,
}

/// The sessions of the rigs that were armed.
pub(super) fn sessions(ports: &[Port], states: &[PortState]) -> Vec<ArmedSession> {
    let of_port = |(port, state): (&Port, &PortState)| {
        let agreement = state.agreement()?;
        Some(ArmedSession {
            node: port.node.number(),
            host_number: agreement.host_number,
            rig_number: agreement.rig_number,
            session_code: agreement.code().bits(),
        })
    };
    ports.iter().zip(states).filter_map(of_port).collect()
}
