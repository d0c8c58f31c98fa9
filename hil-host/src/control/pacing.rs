//! Cycle after cycle: who sets the pace, and how a session ends.

use super::buses::Buses;
use super::course::Course;
use super::notices::Notices;
use super::requests::Requests;
use super::session::{Session, SessionState};
use crate::bus::Bus;
use crate::clock::{Pacer, Tick};
use crate::silence::{GLANCE, SILENCE, Silence};
use can_protocol::{Pace as WirePace, RunState};
use firmware_core::supervision::{Action, Cause, Event, Signal, State};
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// Who sets the pace.
#[derive(Debug, Clone, PartialEq)]
pub enum Pace {
    /// Absolute deadlines; missed ticks are skipped and counted.
    Realtime(Pacer),
    /// The next cycle comes when every rig has echoed this one.
    LockStep,
    /// Nothing waits.
    Fast,
}

impl Pace {
    /// What the rigs are given: without a clock a command is a cycle.
    pub const fn on_the_wire(&self) -> WirePace {
        match self {
            Self::Realtime(_) => WirePace::Clock,
            Self::LockStep | Self::Fast => WirePace::LockStep,
        }
    }
}

/// How often a rig is sent the end of its session at most, and how long each answer may take.
const FAREWELLS: u32 = 4;
const FAREWELL: Duration = Duration::from_millis(20);

/// Time of the safe stop before the session ends (s): braking from the highest speed of a command
/// takes a quarter of it.
pub const STOP_S: f64 = 0.2;

/// How a session ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum End {
    /// All cycles were run.
    Completed,
    /// The user interrupted it, or the record could not be kept.
    Stopped,
    /// A limit asked for an orderly end: coupling and motion were faded out.
    #[serde(rename = "ramped_out")]
    RampedOut,
    /// A guard tripped or a peer was lost: the rigs were brought to rest.
    Safe,
}

impl End {
    /// The word for it, as `summary.json` has it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Completed => "completed",
            Self::Stopped => "stopped",
            Self::RampedOut => "ramped_out",
            Self::Safe => "safe",
        }
    }
}

/// How a session comes to its end, cycle by cycle.
#[derive(Debug, Default)]
pub(crate) struct Ending {
    /// Why it ends in order.
    why: Option<End>,
    /// Cycle in which it was safe first.
    safe_since: Option<u64>,
}

impl Ending {
    /// Looks at the state after a cycle; the end, once it is reached. `cycles` are those of RUN.
    pub(crate) fn take(
        &mut self,
        session: &Session<'_>,
        state: &mut SessionState,
        cycles: u64,
        is_stopped: bool,
    ) -> Option<End> {
        let is_over = state.line.state == State::Run && state.line.run_cycles() >= cycles;
        self.take_open(session, state, is_over, is_stopped)
    }

    /// The same where the caller knows whether all was done.
    pub(crate) fn take_open(
        &mut self,
        session: &Session<'_>,
        state: &mut SessionState,
        is_over: bool,
        is_stopped: bool,
    ) -> Option<End> {
        if state.line.is_safe() {
            let since = *self.safe_since.get_or_insert(state.line.cycle);
            return (state.line.cycle >= since + session.cycles(STOP_S)).then_some(End::Safe);
        }
        let why = match state.line.state {
            State::RampOut => Some(End::RampedOut),
            _ if is_over => Some(End::Completed),
            _ => is_stopped.then_some(End::Stopped),
        };
        self.why = self.why.or(why);
        self.why.filter(|_| session.has_ended(state))
    }
}

impl Session<'_> {
    /// Runs along a course until as many cycles of RUN are done, the user stops it, the record
    /// cannot be kept or a cause ends it. Rigs are ramped out, or brought to rest in the safe
    /// state.
    pub fn run<B: Bus>(
        &self,
        course: &mut Course<'_>,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        pace: &mut Pace,
        cycles: u64,
        requests: &Requests,
    ) -> End {
        self.begin_pace(buses, pace);
        let (mut ending, mut notices) = (Ending::default(), Notices::default());
        let mut tick = Tick::default();
        let end = 'run: loop {
            let track = course.track();
            loop {
                let row = self.cycle_on(&track, state, buses, tick);
                // Before the row: what is found in a cycle is written no later than its row.
                self.notify(state, &mut notices, buses.recorder());
                buses.recorder().row(row);
                if requests.is_stopping() {
                    self.stop_by_operator(state);
                }
                let is_stopped = requests.is_ending() || buses.recorder().is_overrun();
                if let Some(end) = ending.take(self, state, cycles, is_stopped) {
                    break 'run end;
                }
                if course.is_passed(&state.line) {
                    break;
                }
                tick = self.wait(state, buses, pace);
            }
            // The commands are sent. Without a track the vehicle stands.
            if course.change().is_err() {
                self.stop(state, None, Cause::fact(Signal::Vehicle, 1.0), Action::Stop);
            }
            tick = self.wait(state, buses, pace);
        };
        self.notify(state, &mut notices, buses.recorder());
        self.close(state, buses, end);
        end
    }

    /// Sets clock and recorder for a loop that begins now.
    pub(super) fn begin_pace<B: Bus>(&self, buses: &mut Buses<'_, '_, B>, pace: &mut Pace) {
        debug_assert_eq!(self.pace, pace.on_the_wire(), "the rigs were given another pace");
        buses.recorder().may_wait = !matches!(pace, Pace::Realtime(_));
        if let Pace::Realtime(pacer) = pace {
            pacer.restart();
        }
    }

    /// Goes on with an orderly end; whether it is done. Where nothing is faded, it is done at once.
    fn has_ended(&self, state: &mut SessionState) -> bool {
        if !self.has_ramps(state) {
            return true;
        }
        state.line.on(Event::End);
        let is_done = self.line.is_faded_out(&state.line);
        if is_done {
            state.line.on(Event::RampDone);
        }
        is_done
    }

    /// Waits for the next cycle, in the way of the pace.
    pub(super) fn wait<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        pace: &mut Pace,
    ) -> Tick {
        match pace {
            Pace::Realtime(pacer) => {
                let tick = pacer.wait();
                state.skipped += tick.skipped;
                tick
            }
            Pace::LockStep if !state.line.is_safe() => {
                if !self.wait_for_echoes(state, buses, self.patience(state)) {
                    self.stop_for_silence(state);
                }
                Tick::default()
            }
            Pace::LockStep | Pace::Fast => Tick::default(),
        }
    }

    /// Stops, or goes on without them, where rigs have not answered the last command.
    pub(crate) fn stop_for_silence(&self, state: &mut SessionState) {
        for (number, port) in self.ports.iter().enumerate() {
            let Some(memory) = state.ports.get(number).filter(|memory| port.owes_an_answer(memory))
            else {
                continue;
            };
            // Frames may come, and none of them is one of this session.
            let is_foreign = memory.hears_only_bad();
            let signal = if is_foreign { Signal::WrongSeal } else { Signal::SilentRig };
            self.on_cause_of_rig(state, number, Cause::fact(signal, 1.0), Action::Stop);
        }
    }

    /// Begins an orderly end, as an operator asks for it.
    pub(crate) fn end_in_order(&self, state: &mut SessionState) {
        let _is_done = self.has_ended(state);
    }

    /// Stops at once, as an operator asks for it.
    pub(crate) fn stop_by_operator(&self, state: &mut SessionState) {
        self.stop(state, None, Cause::fact(Signal::Operator, 1.0), Action::Stop);
    }

    /// Waits until every rig has answered the last command; false when one stays silent.
    fn wait_for_echoes<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        patience: Duration,
    ) -> bool {
        let mut silence = Silence::from(Instant::now());
        // Rigs in virtual time have answered already, and a wait is a cycle of theirs.
        for bus in 0..buses.count() {
            while !buses.has_own_time(bus) && self.receive_next(state, buses, bus) {}
        }
        loop {
            // Read before the buses: a host that was suspended first takes in what has arrived.
            let late = silence.lasts(Instant::now()) > patience;
            if late {
                self.receive(state, buses);
            }
            let mut ports = self.ports.iter().zip(&state.ports);
            let waiting = ports.rfind(|(port, memory)| port.owes_an_answer(memory));
            let Some(bus) = waiting.map(|(port, _)| port.bus) else { return true };
            if late {
                return false;
            }
            // The next cycle takes in what has come behind the answer.
            buses.wait(bus, patience.min(GLANCE));
            self.receive_next(state, buses, bus);
        }
    }

    /// Ends the run for the rigs, and takes in what is still on the way.
    pub(super) fn close<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        end: End,
    ) {
        if end == End::Safe {
            self.say_last(state, buses, RunState::Safe);
            return;
        }
        self.wait_for_echoes(state, buses, SILENCE);
        let ports = self.ports.iter().zip(&mut state.ports);
        for (port, memory) in ports.filter(|(_, memory)| !memory.has_dropped_out()) {
            port.finish(memory);
        }
        // A rig that does not hear of the end would go safe; so one that does not answer is sent it
        // again.
        for _ in 0..FAREWELLS {
            self.say_last(state, buses, RunState::Standby);
            if self.wait_for_echoes(state, buses, FAREWELL) {
                break;
            }
        }
    }

    /// The command that ends the session, to every rig.
    fn say_last<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        run: RunState,
    ) {
        let time_us = self.time_us(state);
        for (port, memory) in self.ports.iter().zip(&mut state.ports) {
            let mut still = state.line.slots[port.slot].command;
            still.velocity_m_per_s = 0.0;
            let told = memory.told(run);
            let frame = port.command(memory, &still, told, time_us);
            buses.send(port.bus, &frame);
        }
    }
}
