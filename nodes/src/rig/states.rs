//! Which of the host's states a rig follows into, from which of its own.

use can_protocol::RunState;
use firmware_core::supervision::{Event, Outcome, State};

/// The state that a command leads to; none where its state cannot follow from the rig's.
///
/// Frames may be lost, and a ramp may have no cycle at all: RUN is also followed out of ARMED, and
/// STANDBY out of any motion.
pub fn follow(state: State, commanded: RunState) -> Option<State> {
    use RunState as To;
    let events: &[Event] = match (state, commanded) {
        // Latched: no command does anything.
        (State::Safe | State::Fault, _)
        | (State::Armed, To::Armed)
        | (State::OpenLoop, To::OpenLoop)
        | (State::RampIn, To::RampIn)
        | (State::Run, To::Run)
        | (State::RampOut, To::RampOut) => &[],
        (State::Armed, To::OpenLoop) => &[Event::StartOpenLoop],
        (State::Armed, To::RampIn) => &[Event::Couple],
        (State::Armed, To::Run) => &[Event::Couple, Event::RampDone],
        (State::Armed, To::Standby) => &[Event::Disarm],
        (State::RampIn, To::Run) | (State::RampOut, To::Standby) => &[Event::RampDone],
        (State::OpenLoop | State::RampIn | State::Run, To::RampOut) => &[Event::End],
        (State::OpenLoop | State::RampIn | State::Run, To::Standby) => {
            &[Event::End, Event::RampDone]
        }
        (State::Armed, To::Safe | To::Fault) => &[Event::Stop],
        (from, To::Safe | To::Fault) if from.moves() => &[Event::Stop],
        _ => return None,
    };
    events.iter().try_fold(state, |state, event| match state.on(*event) {
        Outcome::Enters(next) => Some(next),
        Outcome::Stays | Outcome::Refused => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire_state::wire_state;

    #[test]
    fn every_state_that_is_followed_is_the_one_commanded_and_what_is_latched_stays() {
        for from in State::ALL {
            for commanded in RunState::ALL {
                let Some(to) = follow(from, commanded) else { continue };
                match from {
                    State::Safe | State::Fault => assert_eq!(to, from),
                    _ if commanded == RunState::Fault => assert_eq!(to, State::Safe),
                    _ => assert_eq!(wire_state(to), commanded),
                }
                // Nothing is followed before arming.
                assert!(!matches!(from, State::Init | State::Standby));
            }
        }
        assert_eq!(follow(State::RampOut, RunState::Run), None);
        assert_eq!(follow(State::Run, RunState::Armed), None);
    }
}
