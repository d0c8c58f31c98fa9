//! One control cycle, drawn as a line of arrows.

use super::buses::Buses;
use super::port::PortState;
use super::session::{Session, SessionState};
use super::stopwatch::{Stage, Stopwatch};
use crate::bus::{Bus, Sent};
use crate::clock::Tick;
use crate::record::{FrameBytes, InputKind, Row};
use can_protocol::Frame;
use core::time::Duration;
use firmware_core::compensation::Answer;
use firmware_core::guard::ForceInput;
use firmware_core::line::{Arrow, Slot};
use firmware_core::supervision::{Action, Cause, Signal, State};
use firmware_core::track::Track;
use firmware_core::vehicle::DAMPER_SLOTS;
use heapless::Vec;
use nodes::wire_state;
use std::time::Instant;

/// Time between two frames with the residual of a watched rig (s).
const RESIDUAL_S: f64 = 0.05;

/// Time between two heartbeats (s).
pub(super) const HEARTBEAT_S: f64 = 0.02;

/// Cycles in a row in which the bus has no room, after which the session ends.
const MOST_LATE_IN_A_ROW: u32 = 2;

/// Time between two syncs (s).
pub(super) const SYNC_S: f64 = 0.1;

/// What arrived for the damper slots in a cycle.
pub(super) struct Inputs {
    /// What the guard gets.
    pub(super) force: [ForceInput; DAMPER_SLOTS],
    /// What the compensator gets: the measured displacement that came with the force.
    pub(super) answer: [Option<Answer>; DAMPER_SLOTS],
    /// What the record gets.
    pub(super) kind: [InputKind; DAMPER_SLOTS],
    /// Payload of the frame that each input came from.
    pub(super) frame: [FrameBytes; DAMPER_SLOTS],
}

/// How long a cycle took and how it began.
pub(super) struct Timing {
    pub(super) compute: Duration,
    pub(super) cycle: Duration,
    pub(super) tick: Tick,
}

impl Session<'_> {
    /// One cycle, as README draws it, on the first stretch of the track; returns the row for the
    /// record. A loop that may leave that stretch follows a [`Course`](super::Course).
    pub fn cycle<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        tick: Tick,
    ) -> Row {
        self.cycle_on(self.line.track, state, buses, tick)
    }

    /// The same on any stretch of the track that holds the whole vehicle.
    pub fn cycle_on<B: Bus>(
        &self,
        track: &Track<'_>,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        tick: Tick,
    ) -> Row {
        self.timed_cycle_on(track, state, buses, tick, &mut ())
    }

    /// The same under a stopwatch.
    pub(crate) fn timed_cycle_on<B: Bus>(
        &self,
        track: &Track<'_>,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        tick: Tick,
        watch: &mut impl Stopwatch,
    ) -> Row {
        self.cycle_of((state, buses), tick, watch, |session, state, inputs, watch| {
            session.guard_step_and_compensate(track, state, inputs, watch)
        })
    }

    /// The same around any `step`, which leaves a command in the slot of every rig and gives the
    /// time that it took.
    pub(super) fn cycle_of<B: Bus, W: Stopwatch>(
        &self,
        (state, buses): (&mut SessionState, &mut Buses<'_, '_, B>),
        tick: Tick,
        watch: &mut W,
        step: impl FnOnce(&Self, &mut SessionState, &Inputs, &mut W) -> Duration,
    ) -> Row {
        let woken = Instant::now();
        if tick.skipped > 0 {
            state.skips.skip(state.line.cycle, tick.skipped);
            let cycles = u32::try_from(tick.skipped).unwrap_or(u32::MAX);
            for (port, memory) in self.ports.iter().zip(&mut state.ports) {
                if buses.has_own_time(port.bus) {
                    memory.belief.skip(cycles);
                }
            }
        }
        self.receive(state, buses);
        watch.lap(Stage::Receive);
        let inputs = self.decode(state);
        watch.lap(Stage::Decode);
        self.judge(state, &inputs);
        let compute = step(self, state, &inputs, watch);
        self.judge_commands(state);
        self.measure_delay(state, &inputs);
        self.watch_growth(state);
        watch.lap(Stage::Compensate);
        let commands = self.encode(state);
        watch.lap(Stage::Encode);
        self.send(state, buses, &commands);
        watch.lap(Stage::Send);
        self.watch(state, &inputs);
        self.announce(state, buses);
        state.hash = state.line.hashed(state.hash, self.line.vehicle);
        let row = self.row(state, &inputs, &Timing { compute, cycle: woken.elapsed(), tick });
        watch.lap(Stage::Record);
        row
    }

    /// Receive: drains every bus. Each port keeps its newest measurement.
    pub(crate) fn receive<B: Bus>(&self, state: &mut SessionState, buses: &mut Buses<'_, '_, B>) {
        for bus in 0..buses.count() {
            while self.receive_next(state, buses, bus) {}
        }
    }

    /// Receive: the next frame of one bus; false where there is none.
    pub(super) fn receive_next<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        bus: usize,
    ) -> bool {
        let Some(frame) = buses.receive(bus) else { return false };
        let mut ports = self.ports.iter().zip(&mut state.ports);
        if !ports.any(|(port, memory)| port.bus == bus && port.take_frame(memory, &frame))
            && let Some(overheard) = state.overheard.get_mut(bus)
        {
            overheard.take(&frame);
        }
        true
    }

    /// Decode: the newest measurement of every rig, or why there is none.
    fn decode(&self, state: &mut SessionState) -> Inputs {
        let mut inputs = Inputs {
            force: [ForceInput::Missing; DAMPER_SLOTS],
            answer: [None; DAMPER_SLOTS],
            kind: [InputKind::NoRig; DAMPER_SLOTS],
            frame: [FrameBytes::default(); DAMPER_SLOTS],
        };
        for (port, memory) in self.ports.iter().zip(&mut state.ports) {
            let (force, frame) = port.take_input(memory);
            inputs.force[port.slot] = force;
            inputs.answer[port.slot] = memory.answer(force);
            inputs.kind[port.slot] = force.into();
            inputs.frame[port.slot] = frame;
        }
        let modelled = inputs.kind.iter().zip(&self.line.slots);
        debug_assert!(
            modelled.into_iter().all(|(kind, slot)| {
                (*kind != InputKind::NoRig) == matches!(slot, Slot::Rig(_))
            }),
            "inputs and rig slots do not fit each other"
        );
        inputs
    }

    /// Ends the run on the causes that the rigs have given, and on another host.
    fn judge(&self, state: &mut SessionState, inputs: &Inputs) {
        if state.line.state == State::Run {
            for (port, memory) in self.ports.iter().zip(&mut state.ports) {
                if memory.has_dropped_out() {
                    continue;
                }
                let model_n = state.line.slots[port.slot].damper.force_n();
                port.judge_residual(memory, inputs.force[port.slot], model_n);
            }
        }
        for bus in 0..state.overheard.len() {
            if let Some(id) = state.overheard[bus].judge() {
                let cause = Cause::fact(Signal::SecondSender, f64::from(id));
                self.stop(state, None, cause, Action::Stop);
            }
        }
        for (port, memory) in self.ports.iter().zip(&mut state.ports) {
            port.judge_compensation(memory, &state.line.slots[port.slot].compensator);
        }
        for (number, port) in self.ports.iter().enumerate() {
            let Some((cause, action)) =
                state.ports.get(number).and_then(|memory| port.cause(memory))
            else {
                continue;
            };
            if cause.signal.is_of_force() {
                state.line.slots[port.slot].is_force_believed = false;
            }
            self.on_cause_of_rig(state, number, cause, action);
        }
    }

    /// Guard, vehicle step, compensate: the three arrows of [`firmware_core::line`].
    fn guard_step_and_compensate(
        &self,
        track: &Track<'_>,
        state: &mut SessionState,
        inputs: &Inputs,
        watch: &mut impl Stopwatch,
    ) -> Duration {
        let (begin, cycle) = (Instant::now(), state.line.cycle);
        let done = |arrow: Arrow| watch.lap(arrow.into());
        self.line.step_in_arrows(track, &mut state.line, &inputs.force, &inputs.answer, done);
        debug_assert_eq!(state.line.cycle, cycle + 1, "a step is one cycle");
        if state.line.is_safe() && state.stop.is_none() {
            self.stop(state, None, Cause::fact(Signal::Vehicle, 1.0), Action::Stop);
        }
        begin.elapsed()
    }

    /// Stops where a limit has changed a command, if that is chosen.
    fn judge_commands(&self, state: &mut SessionState) {
        for port in &self.ports {
            if let Some(cause) = port.beyond_limits(state.line.slots[port.slot].limited) {
                self.stop(state, Some(port.node.number()), cause, cause.action);
            }
        }
    }

    /// Ramps out where hunting will reach the end of a stroke.
    fn watch_growth(&self, state: &mut SessionState) {
        if state.line.state != State::Run {
            return;
        }
        for (number, port) in self.ports.iter().enumerate() {
            let (slot, Some(memory)) = (&state.line.slots[port.slot], state.ports.get_mut(number))
            else {
                continue;
            };
            if memory.has_dropped_out() {
                continue;
            }
            let (limit, displacement_m) = (slot.limits.stroke_m, slot.command.displacement_m);
            if let Some(value) = memory.growth.take(displacement_m, limit) {
                let action = Action::RampOut;
                let cause = Cause { signal: Signal::Growth, value, limit, action };
                self.stop(state, Some(port.node.number()), cause, action);
            }
        }
    }

    /// Encode: one command per port.
    fn encode(&self, state: &mut SessionState) -> Vec<Frame, DAMPER_SLOTS> {
        let (run, time_us) = (wire_state(state.line.state), self.time_us(state));
        let slots = &state.line.slots;
        let ports = self.ports.iter().zip(&mut state.ports);
        ports
            .map(|(port, memory)| {
                memory.commands += u64::from(!memory.has_dropped_out());
                let told = memory.told(run);
                port.command(memory, &slots[port.slot].command, told, time_us)
            })
            .collect()
    }

    /// Send: every command to the bus of its port.
    fn send<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        commands: &[Frame],
    ) {
        debug_assert_eq!(commands.len(), self.ports.len(), "a port without a command");
        let mut is_late = false;
        for (number, (port, command)) in self.ports.iter().zip(commands).enumerate() {
            let sent = buses.send(port.bus, command);
            // A bus that has lost its only rig has nobody who acknowledges.
            if sent == Sent::Away || state.ports.get(number).is_some_and(PortState::has_dropped_out)
            {
                continue;
            }
            state.late += 1;
            is_late |= sent == Sent::Dropped;
            if sent == Sent::Down {
                self.on_cause_of_rig(
                    state,
                    number,
                    Cause::fact(Signal::BusDown, 1.0),
                    Action::Stop,
                );
            }
        }
        state.late_in_a_row = if is_late { state.late_in_a_row.saturating_add(1) } else { 0 };
        if state.late_in_a_row >= MOST_LATE_IN_A_ROW {
            let (value, limit) = (f64::from(state.late_in_a_row), f64::from(MOST_LATE_IN_A_ROW));
            let action = Action::RampOut;
            let cause = Cause { signal: Signal::BusQueue, value, limit, action };
            self.stop(state, None, cause, action);
        }
    }

    /// Compares every watched rig with its model. Nothing waits for this: the commands are sent.
    fn watch(&self, state: &mut SessionState, inputs: &Inputs) {
        let ports = self.ports.iter().zip(&mut state.ports);
        for (port, memory) in ports.filter(|(_, memory)| !memory.has_dropped_out()) {
            port.watch(memory, inputs.force[port.slot]);
        }
    }

    /// The host's slow messages, in the cycles that the protocol gives them.
    fn announce<B: Bus>(&self, state: &mut SessionState, buses: &mut Buses<'_, '_, B>) {
        let is_due = |period_s: f64| state.line.cycle % self.cycles(period_s) == 1;
        let (residuals, sync) = (is_due(RESIDUAL_S), is_due(SYNC_S));
        if is_due(HEARTBEAT_S) {
            let heartbeat = self.heartbeat(state);
            buses.send_to_all(&heartbeat);
        }
        if let Some(stop) = state.stop.filter(|_| !state.is_announced) {
            buses.send_to_all(&stop.fault(0, wire_state(state.line.state)));
            state.is_announced = true;
        }
        let run = wire_state(state.line.state);
        if let Some(request) = state.pressure_off.as_mut().and_then(|request| request.next(run)) {
            buses.send_to_all(&request);
        }
        self.announce_pressure_off(state, buses);
        if residuals {
            let ports = self.ports.iter().zip(&mut state.ports);
            for (port, memory) in ports.filter(|(_, memory)| !memory.has_dropped_out()) {
                if let Some(frame) = port.residual(memory, run) {
                    buses.send(port.bus, &frame);
                }
            }
        }
        if sync {
            buses.send_to_all(&self.sync(state));
        }
    }
}
