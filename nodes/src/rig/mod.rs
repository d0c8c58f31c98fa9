//! The rig: the other end of the bus.
//!
//! [`RigNode`] is a rig as the bus sees it, around any [`Plant`]. The same code runs in line on the
//! memory bus of the host, in a process of its own and on a board. The same frames get the same
//! answers, bit for bit.
//!
//! **States.** A rig runs the machine of [`firmware_core::supervision::State`]. A sync leads it
//! from INIT to STANDBY, the arming exchange ([`can_protocol::arming`]) to ARMED. From there on it
//! enters the state that sealed commands name, where that can follow from its own:
//!
//! | the rig is in | and |
//! | --- | --- |
//! | INIT, STANDBY | takes no command and sends no measurement |
//! | ARMED | holds; measures from its first accepted command on |
//! | `RAMP_IN`, RUN, `RAMP_OUT`, `OPEN_LOOP` | follows: displacement, with or without velocity; HOLD; CENTRE |
//! | SAFE, FAULT | decelerates and holds; latched |
//!
//! It goes to SAFE by itself when it was commanded and accepts nothing valid for
//! [`WATCHDOG_CYCLES`] cycles, when there is evidence that somebody else sends under the id of its
//! commands ([`firmware_core::supervision::SecondSender`]), when two commands in a row step further
//! than the agreed speed allows, neither of which it follows (`rig/net.rs`), and when its key
//! switch no longer enables motion. A pressure-off request leads from any state to FAULT. SAFE and
//! FAULT are left by a reset alone: by key at the rig ([`RigNode::reset`]) or by the exchange of
//! `yawbench rig-reset`. A command STANDBY ends the session; the plant (ram, fixture, damper) stays
//! as it is.
//!
//! **Cycles.** In lock-step a new valid command is a cycle and gets its answer. In clock pace the
//! owner calls [`RigNode::cycle`] once per period; the newest valid command counts, and in a cycle
//! without one the reference runs on at its last velocity. A frame that is not valid and new
//! changes a counter and nothing else. A command without what its mode needs, or with a state that
//! cannot follow from the rig's, is a cycle (and is answered in lock-step), but does not reset the
//! watchdog. While nobody commands, a lock-step rig has no cycles of its own: its owner lets them
//! pass ([`RigNode::idle`]).
//!
//! **Handshake.** Every sync is answered at once with a heartbeat. It sets period, slow-down, pace
//! and profile of a rig that is in INIT or STANDBY. It is refused with a fault and without a
//! heartbeat where it would change those of an armed rig, or where its version is unknown. In
//! lock-step a sync that does not follow on is that of another host, or of the same one started
//! anew: a rig in motion goes to SAFE.

mod condition;
mod model;
mod net;
mod outbox;
mod plant;
mod ram;
mod servo;
mod servo_bench;
mod session;
mod set_point;
mod states;
mod view;

pub use condition::Condition;
pub use model::{ModelRig, ModelSetup, ModelState, SUBSTEPS};
pub use outbox::{Outbox, Says};
pub use plant::{Limits, Plant, Reading, Reference, Target};
pub use ram::{CENTRING_M_PER_S, DECELERATION_M_PER_S2, Ram, RamState};
pub use servo::{ServoRig, ServoSetup, ServoState};
pub use servo_bench::ServoBench;
pub use session::{FrameCounts, Session, Timing};
pub use set_point::{BLIND_CYCLES, SETTLE_CYCLES, STILL_M, Sensed, ServoInterface, SetPoint};
pub use states::follow;

use crate::{WATCHDOG_CYCLES, WireFrame};
use can_protocol::arming::{Listener, Quiet, RigArming, RigEvent, RigStatus};
use can_protocol::{
    ArmMessage, Command, FaultCode, Frame, HeartbeatFlags, MeasurementFlags, MessageId, Mode, Node,
    PROTOCOL_VERSION, Pace, Pressure, PressureOff, Profile, RunState, SessionHistory, Sync, Trips,
};
use firmware_core::supervision::{Event, Outcome, State};
use net::StepNet;

/// A source of 32-bit numbers that nobody can foresee, or of the same ones where a run is to be
/// repeated.
pub trait Numbers: Clone {
    /// Always the same numbers; streams of one seed are independent (one per rig).
    fn seeded(seed: u64, stream: u64) -> Self;

    /// The next number.
    fn number(&mut self) -> u32;
}

/// Distance between command and ram at which the rig reports that it lags (m).
pub const LAGGING_M: f64 = 2e-3;

/// A rig on the bus. A clone is a snapshot; comparing two compares everything they remember.
#[derive(Debug, Clone, PartialEq)]
pub struct RigNode<P: Plant, N> {
    node: Node,
    timing: Timing,
    plant: P,
    condition: Condition,
    session: Session,
    arming: RigArming,
    quiet: Quiet,
    draw: N,
    boot: u32,
    state: P::State,
    machine: State,
    target: Target,
    net: StepNet,
    silent_cycles: u32,
    cycles: u64,
    runs: u64,
    safe_events: u64,
    refused: bool,
    pressure: Pressure,
    trips: Trips,
    last: Option<Reading>,
    outbox: Outbox,
}

impl<P: Plant, N: Numbers> RigNode<P, N> {
    /// A rig that has just started and has heard nothing yet: INIT, clock pace, 1 ms. Its numbers
    /// are seeded.
    pub fn new(setup: &P::Setup, node: Node, profile: Profile) -> Self {
        let timing = Timing { profile, ..Timing::default() };
        let plant = P::new(setup, timing.period_s(), u64::from(node.number()));
        let mut draw = N::seeded(P::seed(setup), u64::from(node.number()));
        Self {
            node,
            timing,
            state: plant.start_at(0.0),
            plant,
            condition: P::condition(setup),
            session: Session::new(node),
            arming: RigArming::new(node, SessionHistory::default()),
            quiet: Quiet::new(Listener::Rig(node)),
            boot: draw.number(),
            draw,
            machine: State::Init,
            target: Target::Hold,
            net: StepNet::default(),
            silent_cycles: 0,
            cycles: 0,
            runs: 0,
            safe_events: 0,
            refused: false,
            pressure: Pressure::Ready,
            trips: Trips::empty(),
            last: None,
            outbox: Outbox::new(node),
        }
    }

    /// The same rig with its ram at rest somewhere else (m).
    #[must_use]
    pub fn with_ram_at(self, ram_m: f64) -> Self {
        Self { state: self.plant.start_at(ram_m), ..self }
    }

    /// The same rig in another condition.
    #[must_use]
    pub fn with_condition(self, condition: Condition) -> Self {
        Self { condition, ..self }
    }

    /// The same rig, just started, with another source of numbers.
    #[must_use]
    pub fn with_draw(self, mut draw: N) -> Self {
        Self { boot: draw.number(), draw, ..self }
    }

    /// Takes in any frame of the bus. In lock-step a new valid command is executed at once.
    pub fn on_frame(&mut self, frame: &WireFrame) {
        let (id, data) = (frame.id(), frame.data());
        self.quiet.hear(id, data);
        match MessageId::from_raw(id) {
            Some(MessageId::Sync) => {
                if let Ok(sync) = Sync::decode(id, data) {
                    self.on_sync(&sync);
                }
            }
            Some(MessageId::Command(_, node)) if node == self.node => {
                let taken = self.session.accept(frame);
                if taken && self.timing.pace == Pace::LockStep {
                    self.cycle();
                }
            }
            Some(MessageId::ArmRequest(node)) if node == self.node => {
                if let Ok(request) = ArmMessage::decode(id, data) {
                    self.on_request(&request);
                }
            }
            Some(MessageId::PressureOff(_)) => {
                if let Ok(request) = PressureOff::decode(id, data)
                    && request.node.is_none_or(|node| node == self.node)
                {
                    self.drop_pressure();
                }
            }
            _ => {}
        }
    }

    /// One cycle with the newest valid command, or without one.
    pub fn cycle(&mut self) {
        self.pass_time();
        let command = self.session.take();
        if let Some(command) = &command {
            self.arming.commanded();
            if self.session.is_new() {
                self.plant.begin(&mut self.state);
            }
            if self.obey(command) {
                self.silent_cycles = 0;
            } else {
                self.silent_cycles = self.silent_cycles.saturating_add(1);
            }
        } else {
            self.silent_cycles = self.silent_cycles.saturating_add(1);
            self.session.note_no_frame();
            self.run_on();
        }
        if self.is_watched() && self.silent_cycles >= WATCHDOG_CYCLES {
            self.lose_host(self.silent_cycles);
        }
        if self.session.has_second_sender() && self.is_watched() && self.enter(Event::Stop) {
            let id = MessageId::Command(self.timing.profile, self.node).raw();
            self.report(FaultCode::Protection, id);
        }
        if !self.condition.enabled && (self.machine == State::Armed || self.machine.moves()) {
            self.enter(Event::Stop);
        }
        let reading = self.advance();
        self.answer(&reading);
        if self.machine == State::Standby {
            self.end_session();
        }
    }

    /// One cycle of a rig that nobody commands: a lock-step rig has no other then. Does nothing in
    /// a session, once its first command is accepted.
    pub fn idle(&mut self) {
        if self.is_idle() {
            self.rest();
        }
    }

    /// The same of a rig that may be latched too: where the owner's clock is the only one.
    pub fn rest_if_uncommanded(&mut self) {
        if self.is_idle() || self.is_latched() {
            self.rest();
        }
    }

    /// One cycle without a command and without a measurement.
    fn rest(&mut self) {
        self.pass_time();
        self.advance();
        self.outbox.slow_messages(self.cycles, self.timing, self.says());
    }

    /// The host was silent for so long that the owner considers it lost: how a lock-step rig, which
    /// has no time of its own, goes safe. Does nothing unless it was commanded.
    pub fn host_is_silent(&mut self, cycles: u32) {
        if self.is_watched() {
            self.lose_host(cycles);
        }
    }

    /// Resets a latched rig whose ram stands still, as the key at the rig does; whether it did.
    pub fn reset(&mut self) -> bool {
        let may_reset = self.is_at_rest() && self.condition.enabled;
        may_reset && self.is_latched() && self.leave_latch()
    }

    /// Turns the key switch at the rig.
    pub fn enable(&mut self, enabled: bool) {
        self.condition.enabled = enabled;
    }

    /// The next frame to send.
    pub fn take_frame(&mut self) -> Option<Frame> {
        self.outbox.take()
    }

    /// The clocks of arming and quiet.
    fn pass_time(&mut self) {
        self.quiet.cycle();
        if let Some(event) = self.arming.cycle() {
            self.on_event(event);
        }
    }

    /// The plant for a cycle.
    fn advance(&mut self) -> Reading {
        let target = if self.machine.moves() { self.target } else { Target::Hold };
        let is_stopping = self.is_latched() && !self.is_at_rest();
        let has_power = self.machine == State::Armed || self.machine.moves() || is_stopping;
        self.plant.power(&mut self.state, has_power && self.pressure == Pressure::Ready);
        let reading = self.plant.cycle(&mut self.state, target);
        if self.plant.has_lost_power(&self.state) {
            self.drop_pressure();
        }
        self.cycles += 1;
        self.last = Some(reading);
        reading
    }

    /// The reference runs on at its last velocity, as in a cycle without a command.
    fn run_on(&mut self) {
        if let Target::Follow(reference) = &mut self.target {
            *reference = reference.after(self.plant.period_s());
        }
    }

    /// Whether a command to follow steps further than the ram may go; then it is not followed, and
    /// a second one in a row leads to SAFE.
    fn is_too_far(&mut self, command: &Command) -> bool {
        let follows = matches!(command.mode, Mode::Follow | Mode::FollowWithVelocity);
        let (true, Some(x_m), Some(cycle)) =
            (follows, command.displacement_m, self.session.commanded_cycle())
        else {
            return false;
        };
        let Some(times) = self.net.refuses(cycle, x_m, P::eyes_m(&self.state)) else {
            return false;
        };
        self.session.note_too_far();
        self.run_on();
        if self.net.is_torn() && self.enter(Event::Stop) {
            self.trips |= Trips::VELOCITY_LIMIT;
            let per_mille = (1000.0 * times).min(f64::from(u16::MAX)) as u16;
            self.report(FaultCode::VelocityLimit, per_mille);
        }
        true
    }

    /// Whether a command was obeyed: it has the values that its mode needs, and a state that can
    /// follow from the rig's.
    fn obey(&mut self, command: &Command) -> bool {
        let Some(next) = follow(self.machine, command.state) else { return false };
        if self.is_latched() {
            return true;
        }
        if !has_value(command) || (next.moves() && self.is_too_far(command)) {
            return false;
        }
        if next.moves() && !self.machine.moves() {
            self.plant.begin(&mut self.state);
            self.trips = Trips::empty();
            self.runs += 1;
        }
        self.machine = next;
        if self.is_latched() {
            self.arming.end_session();
        }
        self.target = match (command.mode, command.displacement_m) {
            (Mode::Centre, _) => Target::Centre,
            (Mode::Follow, Some(displacement_m)) => {
                Target::Follow(Reference { displacement_m, velocity_m_per_s: 0.0 })
            }
            (Mode::FollowWithVelocity, Some(displacement_m)) => {
                let velocity_m_per_s = command.velocity_m_per_s.unwrap_or(0.0);
                Target::Follow(Reference { displacement_m, velocity_m_per_s })
            }
            (Mode::Hold, _) | (_, None) => Target::Hold,
        };
        true
    }

    fn on_request(&mut self, request: &ArmMessage) {
        let status = self.status();
        let (arming, draw) = (&mut self.arming, &mut self.draw);
        let (answer, event) = arming.receive(request, &status, &mut self.quiet, || draw.number());
        if let Some(event) = event {
            self.on_event(event);
        }
        if let Some(answer) = answer {
            self.outbox.answer(&answer);
        }
    }

    fn on_event(&mut self, event: RigEvent) {
        match event {
            RigEvent::Armed(agreement) => {
                self.enter(Event::Arm);
                self.session.arm(self.timing.profile, agreement.code());
                self.net = StepNet::new(agreement.configuration.limits, self.timing.period_s());
                (self.silent_cycles, self.target) = (0, Target::Hold);
            }
            RigEvent::Lapsed => {
                self.enter(Event::Disarm);
                self.end_session();
            }
            RigEvent::Reset => {
                self.leave_latch();
            }
        }
    }

    /// What the arming exchange asks about.
    fn status(&self) -> RigStatus {
        let way = (self.plant.stroke_m(), P::ram_m(&self.state));
        let force_n = P::force_n(&self.state);
        let readiness = self.condition.readiness(self.boot, way, force_n);
        RigStatus {
            state: self.run_state(),
            may_reset: self.condition.may_reset && self.is_at_rest(),
            readiness,
            requirements: Condition::requirements(),
            configuration: self.timing.configuration(self.condition.limits),
        }
    }

    /// Takes an event of the machine; whether it leads anywhere.
    fn enter(&mut self, event: Event) -> bool {
        let Outcome::Enters(state) = self.machine.on(event) else { return false };
        self.machine = state;
        if self.is_latched() {
            // The host still hears of it, sealed; nobody can arm before a reset.
            self.arming.end_session();
            self.safe_events += 1;
        }
        true
    }

    fn lose_host(&mut self, cycles: u32) {
        if self.enter(Event::PeerLost) {
            self.trips |= Trips::WATCHDOG;
            self.report(FaultCode::PeerSilent, u16::try_from(cycles).unwrap_or(u16::MAX));
        }
    }

    fn drop_pressure(&mut self) {
        self.pressure = Pressure::Off;
        if self.enter(Event::Fail) {
            self.report(FaultCode::PressureLost, 0);
        }
    }

    fn leave_latch(&mut self) -> bool {
        let has_left = self.enter(Event::Reset);
        if has_left {
            self.end_session();
            (self.pressure, self.trips) = (Pressure::Ready, Trips::empty());
            self.report(FaultCode::Cleared, 0);
        }
        has_left
    }

    fn end_session(&mut self) {
        self.session.end();
        self.arming.end_session();
    }

    fn on_sync(&mut self, sync: &Sync) {
        let is_foreign_host = self.session.on_sync(sync.time_us);
        // In clock pace a host cannot come back before the watchdog: there its time proves nothing.
        if is_foreign_host && self.timing.pace == Pace::LockStep && self.machine.moves() {
            self.lose_host(0);
        }
        let offered = Timing::from(sync);
        let foreign = sync.version != PROTOCOL_VERSION;
        let is_other = offered != self.timing;
        let is_bound = self.machine == State::Armed || self.machine.moves();
        let refused = foreign || (is_bound && is_other);
        if refused && !self.refused {
            self.report(FaultCode::ConfigurationMismatch, u16::from(sync.version));
        }
        self.refused = refused;
        if refused {
            return;
        }
        if is_other && !self.is_latched() {
            if offered.period_us != self.timing.period_us {
                self.plant = self.plant.clone().with_period(offered.period_s());
            }
            self.timing = offered;
        }
        self.enter(Event::Agreed);
        self.outbox.heartbeat(self.says());
    }

    fn answer(&mut self, reading: &Reading) {
        let mut flags = MeasurementFlags::empty();
        flags.set(MeasurementFlags::LIMIT_REACHED, reading.limits.any());
        flags.set(MeasurementFlags::ACTUATOR_LAGGING, reading.behind_m.abs() > LAGGING_M);
        flags.set(MeasurementFlags::SENSOR_INVALID, !self.plant.is_measured(&self.state));
        let tripped = [
            (reading.limits.stroke, Trips::STROKE_LIMIT),
            (reading.limits.rate, Trips::VELOCITY_LIMIT),
            (reading.behind_m.abs() > LAGGING_M, Trips::TRACKING),
        ];
        for (_, trip) in tripped.into_iter().filter(|(tripped, _)| *tripped) {
            self.trips |= trip;
        }
        self.outbox.slow_messages(self.cycles, self.timing, self.says());
        if let Some(sealed) = self.session.next_seal() {
            let (state, echo) = (self.run_state(), self.session.echo());
            let time_us = self.cycles.wrapping_mul(u64::from(self.timing.period_us)) as u32;
            self.outbox.measurement(sealed, state, flags, echo, reading, time_us);
        }
    }

    fn says(&self) -> Says {
        let mut flags = HeartbeatFlags::empty();
        flags.set(HeartbeatFlags::ENABLED, self.condition.enabled);
        flags.set(HeartbeatFlags::LATCHED, self.is_latched());
        Says {
            state: self.run_state(),
            boot: self.boot,
            flags,
            pressure: self.pressure,
            trips: self.trips,
            temperature_degc: P::temperature_degc(&self.state),
        }
    }

    fn report(&mut self, code: FaultCode, detail: u16) {
        self.outbox.fault(self.run_state(), code, detail);
    }

    /// Whether the watchdog watches: a host holds or moves the ram.
    fn is_watched(&self) -> bool {
        self.session.is_commanded() && (self.machine == State::Armed || self.machine.moves())
    }
}

/// Whether a command has every value that its mode needs.
fn has_value(command: &Command) -> bool {
    let follows = matches!(command.mode, Mode::Follow | Mode::FollowWithVelocity);
    let moves = matches!(
        command.state,
        RunState::OpenLoop | RunState::RampIn | RunState::Run | RunState::RampOut
    );
    !moves || !follows || command.displacement_m.is_some()
}
