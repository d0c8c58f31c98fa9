//! Before the first cycle: the rig agrees to the session, is armed, and shows where its ram stands.

use super::limits;
use super::rig_end::RigEnd;
use super::{End, HEARTBEAT_CYCLES, Locomotive, NotArmed, Phase, SYNC_CYCLES, Terms, period_us};
use crate::{WATCHDOG_CYCLES, WireFrame};
use can_protocol::arming::{Agreement, Configuration, HostArming, HostOutcome, HostPlan};
use can_protocol::{ArmMessage, Error, PROTOCOL_VERSION, Pace, RunState, SessionHistory};
use firmware_core::command::Command;
use firmware_core::line::{Line, RigSlot, Slot};
use firmware_core::supervision::Event;
use firmware_core::track::Track;
use firmware_core::vehicle::DAMPER_SLOTS;

/// Ticks in which an armed rig has to measure its displacement.
const MEASURES_WITHIN_TICKS: u32 = 500;

/// The exchange with a rig; none where its slot has none.
pub(super) fn exchange(line: &Line<'_>, rig: &RigEnd, terms: &Terms) -> Option<HostArming> {
    let asked = rig.asked(&slot(line, terms)?.limits);
    let plan = HostPlan {
        node: terms.node,
        number: terms.number,
        asked,
        needed: limits::needed(asked),
        requirements: terms.requirements,
        configuration: Configuration {
            profile: terms.profile,
            pace: terms.pace,
            period_us: period_us(line),
            slow_down: terms.slow_down,
            watchdog_cycles: WATCHDOG_CYCLES as u16,
            limits: asked,
        },
        patience: terms.patience,
    };
    Some(HostArming::new(plan, SessionHistory::default()))
}

fn slot<'l>(line: &'l Line<'l>, terms: &Terms) -> Option<&'l RigSlot<'l>> {
    match line.slots.get(terms.slot) {
        Some(Slot::Rig(rig)) => Some(rig),
        _ => None,
    }
}

impl Locomotive<'_> {
    /// Announces the session, ten times a second.
    pub(super) fn announce_session(&mut self) {
        if self.ticks.is_multiple_of(SYNC_CYCLES) {
            self.put_sync();
            self.put_heartbeat();
        }
    }

    /// Takes a frame before the rig has agreed: its heartbeat answers the announcement.
    pub(super) fn hear_of_agreement(&mut self, frame: &WireFrame) {
        self.quiet.hear(frame.id(), frame.data());
        // A rig may be in STANDBY from an earlier session: before this one has been announced it
        // has not agreed to it.
        if self.ticks == 0 {
            return;
        }
        let heartbeat = match self.rig.heartbeat(frame) {
            Some(Ok(heartbeat)) => heartbeat,
            Some(Err(Error::Length { .. })) => return self.refuse(NotArmed::Version),
            Some(Err(_)) | None => return,
        };
        match heartbeat.state {
            _ if heartbeat.version != PROTOCOL_VERSION => self.refuse(NotArmed::Version),
            RunState::Safe | RunState::Fault => self.refuse(NotArmed::Latched),
            // Its own heartbeat, before it has heard of this session.
            RunState::Init => {}
            _ => {
                self.state.on(Event::Agreed);
                self.phase = Phase::Arming;
            }
        }
    }

    /// Takes a frame while the rig is asked or held.
    pub(super) fn hear_answer(&mut self, frame: &WireFrame) {
        self.quiet.hear(frame.id(), frame.data());
        if let Ok(answer) = ArmMessage::decode(frame.id(), frame.data()) {
            self.exchange.receive(&answer);
        }
        if self.rig.is_armed() {
            self.rig.take_frame(frame);
        }
    }

    /// One tick of the exchange; couples the rig once its ram is known.
    pub(super) fn arm(&mut self, track: &Track<'_>) {
        self.quiet.cycle();
        match self.exchange.outcome() {
            HostOutcome::Armed(agreement) if !self.rig.is_armed() => self.begin_sealed(&agreement),
            HostOutcome::Refused(refusal) => {
                // The rig is sent that its exchange is over.
                if let Some(last) = self.exchange.cycle(&self.quiet) {
                    self.put(last.encode().0);
                }
                return self.refuse(NotArmed::Refused(refusal));
            }
            HostOutcome::Armed(_) | HostOutcome::Pending(_) | HostOutcome::Reset => {}
        }
        if self.rig.is_armed() {
            let has_answered = self.terms.pace == Pace::Clock || self.rig.has_echo();
            self.armed_ticks += 1;
            match self.rig.stands_m() {
                Some(ram_m) if has_answered || self.armed_ticks > MEASURES_WITHIN_TICKS => {
                    return self.couple(track, ram_m);
                }
                None if self.armed_ticks > MEASURES_WITHIN_TICKS => {
                    return self.refuse(NotArmed::NoDisplacement);
                }
                _ => {}
            }
        }
        self.ask_or_hold();
    }

    /// What is due in a tick: the next question, or a command that holds an armed rig.
    fn ask_or_hold(&mut self) {
        if self.ticks.is_multiple_of(HEARTBEAT_CYCLES) {
            self.put_heartbeat();
        }
        if self.ticks % SYNC_CYCLES == SYNC_CYCLES - 1 {
            self.put_sync();
        }
        let frame = if !self.rig.is_armed() {
            self.exchange.cycle(&self.quiet).map(|question| question.encode().0)
        } else if self.terms.pace == Pace::Clock || self.rig.has_echo() || self.rig.is_new() {
            self.rig.command(&Command::default(), RunState::Armed, 0)
        } else {
            // In lock-step the next command waits for the answer to the last.
            None
        };
        if let Some(frame) = frame {
            self.put(frame);
        }
    }

    fn begin_sealed(&mut self, agreement: &Agreement) {
        let Some(rig) = slot(self.line, &self.terms) else { return };
        let asked = self.rig.asked(&rig.limits);
        self.rig.arm(agreement);
        let agreed = limits::tighter(agreement.configuration.limits, asked);
        if let Some(memory) = self.state.slots.get_mut(self.terms.slot) {
            memory.limits = memory.limits.tighter(agreed);
        }
    }

    /// Couples the rig where its ram stands, and runs the first cycle.
    fn couple(&mut self, track: &Track<'_>, ram_m: f64) {
        self.state.on(Event::Arm);
        let mut rams_m = [0.0; DAMPER_SLOTS];
        if let Some(place) = rams_m.get_mut(self.terms.slot) {
            *place = ram_m;
        }
        if self.line.couple(self.state, rams_m).is_err() {
            return self.refuse(NotArmed::TooFar);
        }
        if let Some(memory) = self.state.slots.get(self.terms.slot) {
            self.rig.begin(memory.command);
        }
        self.phase = Phase::Running;
        self.cycle(track);
    }

    /// Gives up; a rig that is armed is told.
    pub(super) fn refuse(&mut self, why: NotArmed) {
        if let Some(frame) = self.rig.command(&Command::default(), RunState::Standby, 0) {
            self.put(frame);
        }
        self.phase = Phase::Over(End::NotArmed(why));
    }
}
