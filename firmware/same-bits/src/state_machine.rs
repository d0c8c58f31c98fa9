//! The state machine: every event in every state, then a long walk at random.

use crate::random::Random;
use firmware_core::fnv;
use firmware_core::supervision::{Event, Outcome, State};

fn word(outcome: Outcome) -> u64 {
    match outcome {
        Outcome::Stays => 100,
        Outcome::Refused => 101,
        Outcome::Enters(state) => place(state),
    }
}

/// Place of a state in the list of all.
fn place(state: State) -> u64 {
    State::ALL.iter().position(|other| *other == state).unwrap_or(State::ALL.len()) as u64
}

/// Outcomes of the whole table and of so many events.
#[inline(never)]
pub fn run(steps: u32) -> u64 {
    let mut hash = fnv::START;
    for state in State::ALL {
        for event in Event::ALL {
            hash = fnv::add(hash, word(state.on(event)));
        }
    }
    let (mut state, mut random) = (State::default(), Random::new(22));
    for _ in 0..steps {
        let drawn = usize::from(random.byte()) % Event::ALL.len();
        let Some(event) = Event::ALL.get(drawn) else { continue };
        let outcome = state.on(*event);
        if let Outcome::Enters(next) = outcome {
            state = next;
        }
        hash = fnv::add(hash, word(outcome));
    }
    hash
}
