//! What both sides hold in common once a rig is armed.
use super::configuration::Configuration;
use crate::SessionCode;

/// The result of an exchange, equal on both sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Agreement {
    /// Number of the host.
    pub host_number: u32,
    /// Fresh number of the rig.
    pub rig_number: u32,
    /// The configuration with the agreed limits.
    pub configuration: Configuration,
}

impl Agreement {
    /// The code that seals commands and measurements from now on, both from cycle 0.
    pub fn code(&self) -> SessionCode {
        SessionCode::of(self.host_number, self.rig_number)
    }

    /// The value of ARM: only who heard this rig's number in this exchange and has its
    /// configuration knows it.
    pub(super) fn arm_value(&self) -> u32 {
        self.rig_number ^ self.configuration.hash()
    }

    /// The value of ARMED, the same towards the host.
    pub(super) fn armed_value(&self) -> u32 {
        self.host_number ^ self.configuration.hash()
    }
}
