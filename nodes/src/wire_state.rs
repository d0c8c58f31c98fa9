//! The states of a bench as they travel.

use can_protocol::RunState;
use firmware_core::supervision::State;

/// The run state of the protocol.
pub const fn wire_state(state: State) -> RunState {
    match state {
        State::Init => RunState::Init,
        State::Standby => RunState::Standby,
        State::Armed => RunState::Armed,
        State::OpenLoop => RunState::OpenLoop,
        State::RampIn => RunState::RampIn,
        State::Run => RunState::Run,
        State::RampOut => RunState::RampOut,
        State::Safe => RunState::Safe,
        State::Fault => RunState::Fault,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_have_the_same_names() {
        for state in State::ALL {
            assert_eq!(wire_state(state).name(), state.name());
        }
    }
}
