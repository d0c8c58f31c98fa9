//! The run state that every protected message and the heartbeat carry.
use core::fmt;

/// Run state of host or rig, as the 4-bit code on the wire. Codes 8 to 15 are reserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum RunState {
    /// Starting up, nothing checked yet.
    Init = 0,
    /// Checked and idle: no power to the actuator.
    Standby = 1,
    /// Ready to move, holding position.
    Armed = 2,
    /// Coupling is being faded in.
    RampIn = 3,
    /// Coupled.
    Run = 4,
    /// Coupling is being faded out.
    RampOut = 5,
    /// Decelerated by itself and holding position.
    Safe = 6,
    /// Latched fault: only an operator leaves it.
    Fault = 7,
}

impl RunState {
    /// All states in the order of their codes.
    pub const ALL: [Self; 8] = [
        Self::Init,
        Self::Standby,
        Self::Armed,
        Self::RampIn,
        Self::Run,
        Self::RampOut,
        Self::Safe,
        Self::Fault,
    ];

    /// The code on the wire.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The state of a code, `None` for a reserved one.
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }

    /// The name in the DBC.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Init => "INIT",
            Self::Standby => "STANDBY",
            Self::Armed => "ARMED",
            Self::RampIn => "RAMP_IN",
            Self::Run => "RUN",
            Self::RampOut => "RAMP_OUT",
            Self::Safe => "SAFE",
            Self::Fault => "FAULT",
        }
    }
}

impl fmt::Display for RunState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_and_states_are_one_to_one() {
        for code in 0..=255 {
            match RunState::from_code(code) {
                Some(state) => assert_eq!(state.code(), code),
                None => assert!(code >= 8),
            }
        }
    }
}
