//! The rig that the host sees: it answers the arming exchange, takes sealed commands and seals
//! measurements, as a rig of ours does.
//!
//! It has no motion of its own. What the host asks of it goes to the gateway as a [`Heard`], and
//! what the real rig measures comes back through [`Front::measure`].

use crate::bus::WireFrame;
use crate::draw::Draw;
use crate::rig::{Outbox, Says, Session, Timing, follow};
use can_protocol::arming::{
    Limits, Listener, Quiet, Readiness, Requirements, RigArming, RigEvent, RigStatus,
};
use can_protocol::{
    ArmItem, ArmMessage, Command, FaultCode, Frame, HeartbeatFlags, Measurement, MeasurementFlags,
    MessageId, Mode, Node, PROTOCOL_VERSION, Pressure, PressureOff, Profile, RunState,
    SessionHistory, Sync, Trips,
};
use firmware_core::command;
use firmware_core::supervision::{Event, Outcome, State};
use nodes::wire_state;

/// Cycles after which a host that wants to arm asks again while the rig is prepared.
const ASK_AGAIN_CYCLES: u32 = 50;

/// What the host wants of the rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Heard {
    /// Nothing.
    Nothing,
    /// The rig is to be prepared for arming.
    Prepare,
    /// Follow this; it has the host's counter.
    Follow(command::Command, u8),
    /// Hold the place where the reference is.
    Hold(u8),
    /// Come to rest, and be stopped.
    Stop(u8),
    /// Be stopped at once, without a command that could be answered.
    StopNow,
}

/// What is known of the real rig, for the arming exchange.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Known {
    /// Its limits, as far as they are declared.
    pub(super) limits: Limits,
    /// Whether the rig has measured anything yet.
    pub(super) is_heard: bool,
    /// Measured last (m, N).
    pub(super) displacement_m: Option<f64>,
    pub(super) force_n: Option<f64>,
    pub(super) temperature_degc: Option<f64>,
    /// Whether it may be armed: it runs, and what was tried has passed.
    pub(super) is_prepared: bool,
    /// Whether that failed.
    pub(super) is_refused: bool,
}

/// The side of a gateway that the host sees.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Front {
    node: Node,
    timing: Timing,
    session: Session,
    arming: RigArming,
    quiet: Quiet,
    draw: Draw,
    boot: u32,
    machine: State,
    pressure: Pressure,
    outbox: Outbox,
    cycles: u64,
    has_refused: bool,
    /// A session that was offered before the rig was heard.
    offered: Option<Sync>,
}

impl Front {
    pub(super) fn new(node: Node, profile: Profile, mut draw: Draw) -> Self {
        Self {
            node,
            timing: Timing { profile, ..Timing::default() },
            session: Session::new(node),
            arming: RigArming::new(node, SessionHistory::default()),
            quiet: Quiet::new(Listener::Rig(node)),
            boot: draw.number(),
            draw,
            machine: State::Init,
            pressure: Pressure::Ready,
            outbox: Outbox::new(node),
            cycles: 0,
            has_refused: false,
            offered: None,
        }
    }

    /// Takes in a frame of the host.
    pub(super) fn hear(&mut self, frame: &WireFrame, known: &Known) -> Heard {
        let (id, data) = (frame.id(), frame.data());
        self.quiet.hear(id, data);
        match MessageId::from_raw(id) {
            Some(MessageId::Sync) => {
                if let Ok(sync) = Sync::decode(id, data) {
                    self.on_sync(&sync, known);
                }
                Heard::Nothing
            }
            Some(MessageId::Command(_, node)) if node == self.node => {
                if self.session.accept(frame) { self.obey() } else { Heard::Nothing }
            }
            Some(MessageId::ArmRequest(node)) if node == self.node => {
                match ArmMessage::decode(id, data) {
                    Ok(request) => self.on_request(&request, known),
                    Err(_) => Heard::Nothing,
                }
            }
            Some(MessageId::PressureOff(_)) => {
                let request = PressureOff::decode(id, data);
                if request.is_ok_and(|it| it.node.is_none_or(|node| node == self.node)) {
                    self.fail(FaultCode::PressureLost, 0);
                    self.pressure = Pressure::Off;
                    return Heard::StopNow;
                }
                Heard::Nothing
            }
            _ => Heard::Nothing,
        }
    }

    /// One cycle; whether the session ended in it for want of a first command.
    pub(super) fn cycle(&mut self, known: &Known) -> bool {
        self.cycles += 1;
        self.quiet.cycle();
        let has_lapsed = self.arming.cycle() == Some(RigEvent::Lapsed);
        if has_lapsed {
            self.end_session();
            self.enter(Event::Disarm);
        }
        let says = self.says(known);
        self.outbox.slow_messages(self.cycles, self.timing, says);
        has_lapsed
    }

    /// Gives a measurement of the real rig to the host, where a session asks for it. `lost` are
    /// those before it that did not come.
    pub(super) fn measure(
        &mut self,
        lost: u32,
        echo: Option<u8>,
        flags: MeasurementFlags,
        (force_n, displacement_m): (Option<f64>, Option<f64>),
    ) {
        self.session.skip_measurements(lost);
        let Some((profile, seal)) = self.session.next_seal() else { return };
        let measurement = Measurement {
            node: self.node,
            counter: seal.counter(profile),
            state: self.run_state(),
            flags,
            echo,
            force_n,
            displacement_m,
            time_us: Some(self.cycles.wrapping_mul(u64::from(self.timing.period_us)) as u32),
        };
        self.outbox.put(measurement.encode_sealed(profile, seal).0);
        if self.machine == State::Standby {
            self.end_session();
        }
    }

    /// The rig was heard: it agrees to a session that was offered before.
    pub(super) fn agree(&mut self, known: &Known) {
        if let Some(sync) = self.offered.take() {
            self.on_sync(&sync, known);
        }
    }

    /// The rig has stopped by itself, or is to stop: SAFE.
    pub(super) fn stop(&mut self, code: FaultCode, detail: u16) {
        if self.enter(Event::Stop) {
            self.arming.end_session();
            self.outbox.fault(self.run_state(), code, detail);
        }
    }

    /// The rig has failed, or is to fail: FAULT.
    pub(super) fn fail(&mut self, code: FaultCode, detail: u16) {
        if self.enter(Event::Fail) {
            self.arming.end_session();
            self.outbox.fault(self.run_state(), code, detail);
        }
    }

    /// The next frame for the host.
    pub(super) fn take_frame(&mut self) -> Option<Frame> {
        self.outbox.take()
    }

    /// The host's counter of the last command that was accepted.
    pub(super) fn echo(&self) -> Option<u8> {
        self.session.echo()
    }

    /// Whether commands of a session have come.
    pub(super) fn is_commanded(&self) -> bool {
        self.session.is_commanded()
    }

    /// Whether the host holds or moves the rig.
    pub(super) fn is_armed(&self) -> bool {
        self.machine == State::Armed || self.machine.moves()
    }

    /// The run state that the host sees.
    pub(super) fn run_state(&self) -> RunState {
        wire_state(self.machine)
    }

    fn is_latched(&self) -> bool {
        matches!(self.machine, State::Safe | State::Fault)
    }

    /// What an accepted command asks for.
    fn obey(&mut self) -> Heard {
        let (Some(command), Some(counter)) = (self.session.take(), self.session.echo()) else {
            return Heard::Nothing;
        };
        self.arming.commanded();
        let next = follow(self.machine, command.state);
        if self.is_latched() {
            return Heard::Stop(counter);
        }
        let (Some(next), true) = (next, has_value(&command)) else { return Heard::Hold(counter) };
        self.machine = next;
        if self.is_latched() {
            self.arming.end_session();
            return Heard::Stop(counter);
        }
        match (command.mode, command.displacement_m) {
            _ if next == State::Standby => Heard::Stop(counter),
            (Mode::FollowWithVelocity, Some(displacement_m)) if next.moves() => {
                let velocity_m_per_s = command.velocity_m_per_s.unwrap_or(0.0);
                Heard::Follow(command::Command { displacement_m, velocity_m_per_s }, counter)
            }
            (Mode::Follow, Some(displacement_m)) if next.moves() => {
                let velocity_m_per_s = 0.0;
                Heard::Follow(command::Command { displacement_m, velocity_m_per_s }, counter)
            }
            _ => Heard::Hold(counter),
        }
    }

    fn on_request(&mut self, request: &ArmMessage, known: &Known) -> Heard {
        let status = self.status(known);
        // The rig is prepared only for a host that may arm it: one that would be armed otherwise.
        let waits = !known.is_prepared && self.quiet.is_quiet();
        let mut unquiet = Quiet::new(Listener::Rig(self.node));
        let quiet = if waits { &mut unquiet } else { &mut self.quiet };
        let draw = &mut self.draw;
        let (answer, event) = self.arming.receive(request, &status, quiet, || draw.number());
        let mut heard = Heard::Nothing;
        match event {
            Some(RigEvent::Armed(agreement)) => {
                debug_assert!(known.is_prepared, "a rig that is not prepared is armed");
                self.enter(Event::Arm);
                self.session.arm(self.timing.profile, agreement.code());
            }
            Some(RigEvent::Lapsed) => {
                self.enter(Event::Disarm);
                self.end_session();
                heard = Heard::StopNow;
            }
            Some(RigEvent::Reset) => {
                self.enter(Event::Reset);
                self.end_session();
                self.pressure = Pressure::Ready;
                self.outbox.fault(self.run_state(), FaultCode::Cleared, 0);
            }
            None if request.item == ArmItem::Refused => heard = Heard::StopNow,
            None => {}
        }
        if let Some(mut answer) = answer {
            if waits && answer.item == ArmItem::Quiet {
                answer.value = ASK_AGAIN_CYCLES;
                heard = Heard::Prepare;
            }
            self.outbox.answer(&answer);
        }
        heard
    }

    /// What the arming exchange asks about. What the rig's messages do not say counts as good: an
    /// operator has accepted that.
    fn status(&self, known: &Known) -> RigStatus {
        let micro = |value: f64| (value * 1e6).max(0.0) as u32;
        let (stroke_out_um, stroke_in_um) = match (known.limits.stroke_um, known.displacement_m) {
            (_, None) => (0, 0),
            (u32::MAX, Some(_)) => (u32::MAX, u32::MAX),
            (stroke_um, Some(ram_m)) => {
                let stroke_m = f64::from(stroke_um) * 1e-6;
                (micro(stroke_m - ram_m), micro(stroke_m + ram_m))
            }
        };
        RigStatus {
            state: self.run_state(),
            may_reset: !self.is_armed(),
            readiness: Readiness {
                boot: self.boot,
                enabled: !known.is_refused,
                zero_age_s: Some(0),
                shunt_passed: true,
                force_at_rest_n: known.force_n.map(|force_n| force_n.abs().round() as u32),
                stroke_out_um,
                stroke_in_um,
            },
            requirements: Requirements {
                enabled: true,
                zero_age_s: u32::MAX - 1,
                shunt_passed: false,
                force_at_rest_n: u32::MAX - 1,
                stroke_um: 0,
            },
            configuration: self.timing.configuration(known.limits),
        }
    }

    fn on_sync(&mut self, sync: &Sync, known: &Known) {
        self.session.on_sync(sync.time_us);
        let offered = Timing::from(sync);
        // A real rig cannot slow down its oil.
        let is_foreign = sync.version != PROTOCOL_VERSION || offered.slow_down != 1;
        let refuses = is_foreign || (self.is_armed() && offered != self.timing);
        if refuses && !self.has_refused {
            let detail = u16::from(sync.version);
            self.outbox.fault(self.run_state(), FaultCode::ConfigurationMismatch, detail);
        }
        self.has_refused = refuses;
        if refuses {
            return;
        }
        if !known.is_heard {
            // A rig that was not heard yet agrees to nothing; it does with its first measurement.
            self.offered = Some(*sync);
            return;
        }
        if !self.is_latched() {
            self.timing = offered;
        }
        self.enter(Event::Agreed);
        let says = self.says(known);
        self.outbox.heartbeat(says);
    }

    /// Takes an event of the machine; whether it leads anywhere.
    fn enter(&mut self, event: Event) -> bool {
        let Outcome::Enters(state) = self.machine.on(event) else { return false };
        self.machine = state;
        true
    }

    fn end_session(&mut self) {
        self.session.end();
        self.arming.end_session();
    }

    fn says(&self, known: &Known) -> Says {
        let mut flags = HeartbeatFlags::empty();
        flags.set(HeartbeatFlags::ENABLED, !known.is_refused);
        flags.set(HeartbeatFlags::LATCHED, self.is_latched());
        Says {
            state: self.run_state(),
            boot: self.boot,
            flags,
            pressure: self.pressure,
            trips: Trips::empty(),
            temperature_degc: known.temperature_degc,
        }
    }
}

/// Whether a command has every value that its mode needs.
fn has_value(command: &Command) -> bool {
    let follows = matches!(command.mode, Mode::Follow | Mode::FollowWithVelocity);
    !follows || command.displacement_m.is_some()
}
