//! The states of a bench: who may move what, and how that ends.
//!
//! Host and rig run the same machine. Each has its own state and sends it with every message; a
//! state in which the ram may move is entered only while the peer is in a state that allows it, and
//! that check belongs to the caller.
//!
//! ```text
//! INIT -> STANDBY -> ARMED -> RAMP_IN -> RUN -> RAMP_OUT -> STANDBY
//!                          -> OPEN_LOOP ------> RAMP_OUT
//! any motion -> SAFE, any state -> FAULT; both are left by a reset alone
//! ```
//!
//! The machine is a table: [`State::on`] gives the outcome of every event in every state, and a
//! test lists all of them. The diagram in `docs/bench-states.md` is written from it.

use core::fmt::{self, Write};

/// State of a host or of a rig.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum State {
    /// Nothing is agreed with the peer.
    #[default]
    Init,
    /// Versions, configuration and limits are agreed; the ram stands still.
    Standby,
    /// Every check has passed and an operator has armed; the ram holds its position.
    Armed,
    /// The ram follows a motion of its own; no force reaches the vehicle.
    OpenLoop,
    /// The coupling is faded in.
    RampIn,
    /// The measured force acts on the vehicle.
    Run,
    /// Coupling and motion are faded out.
    RampOut,
    /// The ram was brought to rest without the peer's help, and holds.
    Safe,
    /// A fault is latched.
    Fault,
}

/// Something that happens to a bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Event {
    /// The peer has agreed to version, configuration and limits.
    Agreed,
    /// An operator arms, and every check has passed.
    Arm,
    /// An operator disarms.
    Disarm,
    /// An operator starts a motion without coupling.
    StartOpenLoop,
    /// An operator starts the coupled run.
    Couple,
    /// A ramp has reached its end.
    RampDone,
    /// The run is to end in order: its duration is over, an operator ends it, or a limit asks for
    /// it.
    End,
    /// Motion must stop at once: an enable, a peer or a signal is lost.
    Stop,
    /// The peer is silent or has started anew.
    PeerLost,
    /// A fault that an operator has to look at.
    Fail,
    /// An operator resets, at the rig or by a command of its own, while the ram stands still.
    Reset,
}

/// What an event does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Outcome {
    /// The bench enters a state.
    Enters(State),
    /// The state stays, and that is right.
    Stays,
    /// An operator's request that this state does not allow.
    Refused,
}

impl State {
    /// All states.
    pub const ALL: [Self; 9] = [
        Self::Init,
        Self::Standby,
        Self::Armed,
        Self::OpenLoop,
        Self::RampIn,
        Self::Run,
        Self::RampOut,
        Self::Safe,
        Self::Fault,
    ];

    /// Its name on the bus.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Init => "INIT",
            Self::Standby => "STANDBY",
            Self::Armed => "ARMED",
            Self::OpenLoop => "OPEN_LOOP",
            Self::RampIn => "RAMP_IN",
            Self::Run => "RUN",
            Self::RampOut => "RAMP_OUT",
            Self::Safe => "SAFE",
            Self::Fault => "FAULT",
        }
    }

    /// Whether the ram may follow commands.
    pub const fn moves(self) -> bool {
        matches!(self, Self::OpenLoop | Self::RampIn | Self::Run | Self::RampOut)
    }

    /// Whether measured force may act on the vehicle.
    pub const fn is_coupled(self) -> bool {
        matches!(self, Self::RampIn | Self::Run | Self::RampOut)
    }

    /// What an event does in this state.
    ///
    /// ```
    /// use firmware_core::supervision::{Event, Outcome, State};
    /// assert_eq!(State::Run.on(Event::End), Outcome::Enters(State::RampOut));
    /// assert_eq!(State::Safe.on(Event::Arm), Outcome::Refused);
    /// assert_eq!(State::Fault.on(Event::Stop), Outcome::Stays);
    /// ```
    pub const fn on(self, event: Event) -> Outcome {
        match self.entered_by(event) {
            Some(state) => Outcome::Enters(state),
            None if event.is_request() => Outcome::Refused,
            None => Outcome::Stays,
        }
    }

    /// The transitions, by the state that is entered.
    const fn entered_by(self, event: Event) -> Option<Self> {
        use State::{Armed, Fault, Init, OpenLoop, RampIn, RampOut, Run, Safe, Standby};
        Some(match (self, event) {
            (Standby, Event::PeerLost) | (Safe | Fault, Event::Reset) => Init,
            (Init, Event::Agreed)
            | (Armed, Event::Disarm | Event::End)
            | (RampOut, Event::RampDone) => Standby,
            (Standby, Event::Arm) => Armed,
            (Armed, Event::StartOpenLoop) => OpenLoop,
            (Armed, Event::Couple) => RampIn,
            (RampIn, Event::RampDone) => Run,
            (OpenLoop | RampIn | Run, Event::End) => RampOut,
            // A stop that comes before arming must not be forgotten by it.
            (Standby, Event::Stop)
            | (Armed | OpenLoop | RampIn | Run | RampOut, Event::Stop | Event::PeerLost) => Safe,
            (Init | Standby | Armed | OpenLoop | RampIn | Run | RampOut | Safe, Event::Fail) => {
                Fault
            }
            _ => return None,
        })
    }
}

impl Event {
    /// All events.
    pub const ALL: [Self; 11] = [
        Self::Agreed,
        Self::Arm,
        Self::Disarm,
        Self::StartOpenLoop,
        Self::Couple,
        Self::RampDone,
        Self::End,
        Self::Stop,
        Self::PeerLost,
        Self::Fail,
        Self::Reset,
    ];

    /// In words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Agreed => "agreed",
            Self::Arm => "arm",
            Self::Disarm => "disarm",
            Self::StartOpenLoop => "start open loop",
            Self::Couple => "couple",
            Self::RampDone => "ramp done",
            Self::End => "end",
            Self::Stop => "stop",
            Self::PeerLost => "peer lost",
            Self::Fail => "fail",
            Self::Reset => "reset",
        }
    }

    /// Whether an operator asks for it.
    pub const fn is_request(self) -> bool {
        matches!(self, Self::Arm | Self::Disarm | Self::StartOpenLoop | Self::Couple | Self::Reset)
    }
}

/// Writes the machine as a Mermaid diagram: every transition, with the events that cause it.
///
/// # Errors
/// Those of the writer.
pub fn write_diagram(out: &mut impl Write) -> fmt::Result {
    writeln!(out, "stateDiagram-v2")?;
    writeln!(out, "    [*] --> {}", State::default().name())?;
    for from in State::ALL {
        for to in State::ALL {
            let mut causes = Event::ALL.into_iter().filter(|e| from.on(*e) == Outcome::Enters(to));
            let Some(first) = causes.next() else { continue };
            write!(out, "    {} --> {}: {}", from.name(), to.name(), first.name())?;
            causes.try_for_each(|event| write!(out, ", {}", event.name()))?;
            writeln!(out)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows: states in order; columns: events in order. `.` stays, `x` refused, else the first
    /// letters of the state that is entered.
    const TABLE: [[&str; 11]; 9] = [
        ["ST", "x", "x", "x", "x", ".", ".", ".", ".", "FA", "x"],
        [".", "AR", "x", "x", "x", ".", ".", "SA", "IN", "FA", "x"],
        [".", "x", "ST", "OP", "RI", ".", "ST", "SA", "SA", "FA", "x"],
        [".", "x", "x", "x", "x", ".", "RO", "SA", "SA", "FA", "x"],
        [".", "x", "x", "x", "x", "RU", "RO", "SA", "SA", "FA", "x"],
        [".", "x", "x", "x", "x", ".", "RO", "SA", "SA", "FA", "x"],
        [".", "x", "x", "x", "x", "ST", ".", "SA", "SA", "FA", "x"],
        [".", "x", "x", "x", "x", ".", ".", ".", ".", "FA", "IN"],
        [".", "x", "x", "x", "x", ".", ".", ".", ".", ".", "IN"],
    ];

    fn short(outcome: Outcome) -> &'static str {
        match outcome {
            Outcome::Stays => ".",
            Outcome::Refused => "x",
            Outcome::Enters(State::Init) => "IN",
            Outcome::Enters(State::Standby) => "ST",
            Outcome::Enters(State::Armed) => "AR",
            Outcome::Enters(State::OpenLoop) => "OP",
            Outcome::Enters(State::RampIn) => "RI",
            Outcome::Enters(State::Run) => "RU",
            Outcome::Enters(State::RampOut) => "RO",
            Outcome::Enters(State::Safe) => "SA",
            Outcome::Enters(State::Fault) => "FA",
        }
    }

    #[test]
    fn every_event_in_every_state() {
        for (state, row) in State::ALL.into_iter().zip(TABLE) {
            for (event, expected) in Event::ALL.into_iter().zip(row) {
                assert_eq!(
                    short(state.on(event)),
                    expected,
                    "{} on {}",
                    state.name(),
                    event.name()
                );
            }
        }
    }

    #[test]
    fn a_force_acts_where_the_ram_follows_the_vehicle() {
        let coupled = State::ALL.map(State::is_coupled);
        let moves_with = |state| matches!(state, State::RampIn | State::Run | State::RampOut);
        assert_eq!(coupled, State::ALL.map(moves_with));
        let open_loop = State::OpenLoop;
        assert!(open_loop.moves() && !open_loop.is_coupled());
    }

    #[test]
    fn nothing_moves_that_was_not_armed() {
        for from in State::ALL {
            for event in Event::ALL {
                let Outcome::Enters(to) = from.on(event) else { continue };
                if to.moves() && !from.moves() {
                    assert_eq!(from, State::Armed, "{}", event.name());
                }
                assert!(to != State::Armed || (from, event) == (State::Standby, Event::Arm));
                // What is latched is left by a reset alone.
                if from == State::Fault {
                    assert_eq!(event, Event::Reset);
                }
                if from == State::Safe {
                    assert!(matches!(event, Event::Reset | Event::Fail));
                }
            }
        }
        for state in State::ALL.into_iter().filter(|state| state.moves()) {
            for event in [Event::Stop, Event::PeerLost] {
                assert_eq!(state.on(event), Outcome::Enters(State::Safe), "{}", state.name());
            }
        }
    }

    #[test]
    fn every_state_can_be_reached_and_left() {
        let mut reached = [State::Init; 9];
        let mut count = 1;
        let mut next = 0;
        while next < count {
            for event in Event::ALL {
                if let Outcome::Enters(to) = reached[next].on(event)
                    && !reached[..count].contains(&to)
                {
                    reached[count] = to;
                    count += 1;
                }
            }
            next += 1;
        }
        assert_eq!(count, State::ALL.len());
        let leaves = |state: State| {
            Event::ALL.into_iter().any(|event| matches!(state.on(event), Outcome::Enters(_)))
        };
        assert!(State::ALL.into_iter().all(leaves));
    }
}
