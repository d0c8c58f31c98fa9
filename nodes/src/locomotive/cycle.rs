//! One cycle with a coupled rig, and how a run ends.

use super::{End, HEARTBEAT_CYCLES, Locomotive, Phase, STOP_CYCLES, SYNC_CYCLES, fault_of};
use crate::wire_state;
use can_protocol::{Fault, Pace, PressureOff, RunState, Sender};
use firmware_core::guard::ForceInput;
use firmware_core::line::Fade;
use firmware_core::supervision::{Action, Cause, Event, Signal, State};
use firmware_core::track::Track;
use firmware_core::vehicle::DAMPER_SLOTS;

/// How often the rig is sent the end of its session at most, and how many ticks each answer may
/// take.
const FAREWELLS: u32 = 4;
const FAREWELL_TICKS: u32 = 20;

/// How often the request to drop the pressure is sent.
const PRESSURE_OFF_TIMES: u8 = 2;

impl Locomotive<'_> {
    /// A tick with a coupled rig: a cycle, unless the rig owes its answer in lock-step.
    pub(super) fn run(&mut self, track: &Track<'_>, skipped: u32) {
        match self.terms.pace {
            Pace::Clock => self.rig.skip(skipped),
            Pace::LockStep if self.state.is_safe() || self.rig.has_echo() => self.silent_ticks = 0,
            Pace::LockStep => {
                self.silent_ticks = self.silent_ticks.saturating_add(1);
                if self.silent_ticks < self.terms.silence_ticks {
                    return;
                }
                // Frames may come, and none of them is one of this session.
                let is_foreign = self.rig.hears_only_bad();
                let signal = if is_foreign { Signal::WrongSeal } else { Signal::SilentRig };
                self.end_motion(Cause::fact(signal, 1.0), Action::Stop);
            }
        }
        self.cycle(track);
    }

    /// One cycle, in the order of the host's.
    pub(super) fn cycle(&mut self, track: &Track<'_>) {
        let input = self.rig.take_input();
        let answer = self.rig.answer(input);
        self.judge(input);
        let (mut forces, mut answers) = ([ForceInput::Missing; DAMPER_SLOTS], [None; DAMPER_SLOTS]);
        let slot = self.terms.slot;
        if let (Some(force), Some(place)) = (forces.get_mut(slot), answers.get_mut(slot)) {
            (*force, *place) = (input, answer);
        }
        self.line.step_on(track, self.state, &forces, &answers);
        if self.state.is_safe() && self.stop.is_none() {
            self.end_motion(Cause::fact(Signal::Vehicle, 1.0), Action::Stop);
        }
        self.watch_growth();
        self.send_command();
        self.announce();
        self.hash = self.state.hashed(self.hash, self.line.vehicle);
        self.come_to_an_end();
    }

    /// Ends the run on the causes that the rig has given, and on another host.
    fn judge(&mut self, input: ForceInput) {
        let slot = self.terms.slot;
        let Some(memory) = self.state.slots.get(slot) else { return };
        let (model_n, has_run_away) = (memory.damper.force_n(), memory.compensator.has_run_away());
        if self.state.state == State::Run {
            self.rig.judge_residual(input, model_n);
        }
        if let Some(id) = self.overheard.judge() {
            self.end_motion(Cause::fact(Signal::SecondSender, f64::from(id)), Action::Stop);
        }
        self.rig.judge_compensation(has_run_away);
        let Some((cause, action)) = self.rig.cause() else { return };
        if cause.signal.is_of_force()
            && let Some(memory) = self.state.slots.get_mut(slot)
        {
            memory.is_force_believed = false;
        }
        self.end_motion(cause, action);
    }

    /// Ramps out where hunting will reach the end of the stroke.
    fn watch_growth(&mut self) {
        let Some(slot) = self.state.slots.get(self.terms.slot) else { return };
        if self.state.state != State::Run {
            return;
        }
        let limit = slot.limits.stroke_m;
        if let Some(value) = self.growth.take(slot.command.displacement_m, limit) {
            let action = Action::RampOut;
            self.end_motion(Cause { signal: Signal::Growth, value, limit, action }, action);
        }
    }

    fn send_command(&mut self) {
        let (run, time_us) = (wire_state(self.state.state), self.time_us());
        let Some(command) = self.state.slots.get(self.terms.slot).map(|slot| slot.command) else {
            return;
        };
        if let Some(frame) = self.rig.command(&command, run, time_us) {
            self.put(frame);
        }
    }

    /// The slow messages, in the cycles that the protocol gives them.
    fn announce(&mut self) {
        let cycle = self.state.cycle;
        let is_due = |period: u64| cycle.saturating_sub(1).is_multiple_of(period);
        if is_due(HEARTBEAT_CYCLES) {
            self.put_heartbeat();
        }
        if let Some(stop) = self.stop {
            let (code, detail) = fault_of(&stop.cause);
            let state = wire_state(self.state.state);
            if !self.is_announced {
                let fault = Fault { sender: Sender::Host, counter: 0, state, code, detail };
                self.put(fault.encode().0);
                self.is_announced = true;
            }
            if let Some(counter) = self.pressure_off.filter(|sent| *sent < PRESSURE_OFF_TIMES) {
                let node = Some(self.terms.node);
                self.put(PressureOff { node, counter, state, code, detail }.encode().0);
                self.pressure_off = Some(counter + 1);
            }
        }
        if is_due(SYNC_CYCLES) {
            self.put_sync();
        }
    }

    /// Looks at the state after a cycle: begins an end that is due, and leaves once it is done.
    fn come_to_an_end(&mut self) {
        if self.state.is_safe() {
            let since = *self.safe_since.get_or_insert(self.state.cycle);
            if self.state.cycle >= since + STOP_CYCLES {
                self.say_last(RunState::Safe);
                self.phase = Phase::Over(End::Safe);
            }
            return;
        }
        let is_over = self.state.run_cycles() >= self.terms.cycles;
        let why = match self.state.state {
            State::RampOut => Some(End::RampedOut),
            State::Run if is_over => Some(End::Completed),
            _ => self.is_asked_to_end.then_some(End::Stopped),
        };
        self.why = self.why.or(why);
        if let Some(end) = self.why
            && self.has_faded_out()
        {
            self.phase = Phase::Leaving(end, 0, 0);
        }
    }

    /// Goes on with an orderly end; whether it is done. Where nothing is faded, it is done at once.
    fn has_faded_out(&mut self) -> bool {
        if self.state.fade == Fade::default() {
            return true;
        }
        self.state.on(Event::End);
        let is_done = self.line.is_faded_out(self.state);
        if is_done {
            self.state.on(Event::RampDone);
        }
        is_done
    }

    /// Sends the end of the session until the rig answers: one that does not hear of it would go
    /// safe.
    pub(super) fn leave(&mut self, end: End, sent: u32, waited: u32) {
        let patience = if sent == 0 { self.terms.silence_ticks } else { FAREWELL_TICKS };
        let is_answered = self.rig.has_echo();
        self.phase = if is_answered && sent > 0 || sent >= FAREWELLS && waited >= patience {
            Phase::Over(end)
        } else if is_answered || waited >= patience {
            self.say_last(RunState::Standby);
            Phase::Leaving(end, sent + 1, 0)
        } else {
            Phase::Leaving(end, sent, waited + 1)
        };
    }

    /// The command that ends the session.
    fn say_last(&mut self, run: RunState) {
        let time_us = self.time_us();
        let Some(command) = self.state.slots.get(self.terms.slot).map(|slot| slot.command) else {
            return;
        };
        let still = firmware_core::command::Command { velocity_m_per_s: 0.0, ..command };
        if let Some(frame) = self.rig.command(&still, run, time_us) {
            self.put(frame);
        }
    }
}
