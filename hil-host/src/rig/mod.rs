//! The rig: the other end of the bus.
//!
//! [`RigNode`] is a rig as the bus sees it, around the physics of an [`Emulator`]. The same code
//! serves in line on the memory bus and in its own process (`process`); given the same frames it
//! gives the same answers, bit for bit.
//!
//! **States.** A rig starts in INIT. It takes on the state that the host commands, with one
//! exception: SAFE by itself.
//!
//! | host commands | the rig |
//! | --- | --- |
//! | RUN, coming from another state | puts the ram in the middle, the damper at rest, the noise to cycle 0, and follows from this command on |
//! | RUN | follows: displacement, or displacement and velocity; HOLD; CENTRE |
//! | any other state | decelerates and holds |
//! | nothing valid for [`WATCHDOG_CYCLES`] cycles | goes SAFE: decelerates, holds, sends one fault, keeps answering |
//! | RUN after that | stays SAFE: only another state releases it, then RUN arms anew |
//!
//! **Cycles.** In lock-step a new valid command is a cycle and gets its answer. In clock pace the
//! owner calls [`RigNode::cycle`] once per period; the newest valid command counts, and in a cycle
//! without one the reference runs on at its last velocity. A frame that is not valid and new
//! changes a counter and nothing else. A command that says RUN and follow without a displacement is
//! a cycle (and is answered in lock-step), but does not feed the watchdog.
//!
//! **Handshake.** Every sync is answered at once with a heartbeat. A sync after a silence begins a
//! new session: counters may start anywhere. It also sets period, slow-down, pace and profile,
//! unless the rig is coupled; then, or when its version is foreign, it is refused with a fault. A
//! host that starts sends sync until it has the heartbeat, then ARMED until it has the echo, then
//! RUN.

pub mod actuator;
pub mod emulator;
pub mod noise;
mod session;

pub use emulator::{Emulator, EmulatorState, Reading, Target};
pub use session::{FrameCounts, Timing};

use crate::bus::WireFrame;
use actuator::Reference;
use can_protocol::{
    Command, Fault, FaultCode, Frame, Heartbeat, Measurement, MeasurementFlags, MessageId, Mode,
    Node, PROTOCOL_VERSION, Pace, Pressure, Profile, RunState, Sender, Sync, Telemetry, Trips,
};
use heapless::Deque;
use scenario::rig::RigSetup;
use session::Session;

/// Cycles without a valid command after which a coupled rig goes safe.
pub const WATCHDOG_CYCLES: u32 = 5;

/// Distance between command and ram at which the rig says that it lags (m).
pub const LAGGING_M: f64 = 2e-3;

/// Frames that wait to be taken: one cycle has at most five.
const OUTBOX: usize = 8;

/// A rig on the bus. A clone is a snapshot; comparing two compares everything they remember.
#[derive(Debug, Clone, PartialEq)]
pub struct RigNode {
    node: Node,
    timing: Timing,
    emulator: Emulator,
    session: Session,
    state: EmulatorState,
    run_state: RunState,
    /// SAFE by itself, until the host commands something other than RUN.
    latched: bool,
    target: Target,
    silent_cycles: u32,
    heard: bool,
    cycles: u64,
    runs: u64,
    safe_events: u64,
    refused: bool,
    trips: Trips,
    counter: u8,
    fault_counter: u8,
    telemetry_counter: u8,
    last: Option<Reading>,
    outbox: Deque<Frame, OUTBOX>,
}

impl RigNode {
    /// A rig that has heard nothing yet: INIT, clock pace, 1 ms.
    pub fn new(setup: &RigSetup, node: Node, profile: Profile) -> Self {
        let timing = Timing { profile, ..Timing::default() };
        let emulator = Emulator::new(setup, timing.period_s(), u64::from(node.number()));
        let state = emulator.start();
        Self {
            node,
            timing,
            emulator,
            session: Session::new(profile, node),
            state,
            run_state: RunState::Init,
            latched: false,
            target: Target::Hold,
            silent_cycles: 0,
            heard: false,
            cycles: 0,
            runs: 0,
            safe_events: 0,
            refused: false,
            trips: Trips::empty(),
            counter: 0,
            fault_counter: 0,
            telemetry_counter: 0,
            last: None,
            outbox: Deque::new(),
        }
    }

    /// Takes in any frame of the bus. In lock-step a new valid command is worked off at once.
    pub fn on_frame(&mut self, frame: &WireFrame) {
        match MessageId::from_raw(frame.id()) {
            Some(MessageId::Sync) => {
                if let Ok(sync) = Sync::decode(frame.id(), frame.data()) {
                    self.on_sync(&sync);
                }
            }
            Some(MessageId::Command(_, node)) if node == self.node => {
                let taken = self.session.accept(frame);
                if taken && self.timing.pace == Pace::LockStep {
                    self.cycle();
                }
            }
            _ => {}
        }
    }

    /// One cycle with the newest valid command, or without one.
    pub fn cycle(&mut self) {
        let command = self.session.take();
        match &command {
            Some(command) if has_value(command) => {
                self.silent_cycles = 0;
                self.heard = true;
                self.obey(command);
            }
            _ => {
                self.silent_cycles = self.silent_cycles.saturating_add(1);
                if command.is_none() {
                    self.session.note_no_frame();
                }
                if let Target::Follow(reference) = &mut self.target {
                    *reference = reference.after(self.emulator.period_s());
                }
            }
        }
        if self.is_coupled() && self.silent_cycles >= WATCHDOG_CYCLES {
            self.go_safe(self.silent_cycles);
        }
        let target = if self.run_state == RunState::Run { self.target } else { Target::Hold };
        let reading = self.emulator.cycle(&mut self.state, target);
        self.cycles += 1;
        self.last = Some(reading);
        self.answer(&reading);
        self.send_slow_messages();
    }

    /// The host has said nothing for so long that the owner gives it up: how a lock-step rig, which
    /// has no time of its own, goes safe. Does nothing unless coupled.
    pub fn host_is_silent(&mut self, cycles: u32) {
        if self.is_coupled() {
            self.go_safe(cycles);
        }
    }

    /// The next frame to send.
    pub fn take_frame(&mut self) -> Option<Frame> {
        self.outbox.pop_front()
    }

    fn obey(&mut self, command: &Command) {
        let commanded = match command.state {
            RunState::Fault => RunState::Safe,
            state => state,
        };
        if commanded == RunState::Run {
            if self.latched || self.refused {
                return;
            }
            if self.run_state != RunState::Run {
                self.state = self.emulator.start();
                self.trips = Trips::empty();
                self.runs += 1;
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
        } else if self.latched {
            self.latched = false;
            self.run_state = commanded;
            self.report(FaultCode::Cleared, 0);
        }
        self.run_state = commanded;
    }

    fn go_safe(&mut self, cycles: u32) {
        self.run_state = RunState::Safe;
        self.latched = true;
        self.safe_events += 1;
        self.trips |= Trips::WATCHDOG;
        self.report(FaultCode::PeerSilent, u16::try_from(cycles).unwrap_or(u16::MAX));
    }

    fn on_sync(&mut self, sync: &Sync) {
        let offered = Timing::from(sync);
        let foreign = sync.version != PROTOCOL_VERSION;
        let refused = foreign || (self.is_coupled() && offered != self.timing);
        if refused && !self.refused {
            self.report(FaultCode::ConfigurationMismatch, u16::from(sync.version));
        }
        self.refused = refused;
        if refused {
            return;
        }
        if offered.period_us != self.timing.period_us {
            self.emulator = self.emulator.clone().with_period(offered.period_s());
        }
        if offered.profile != self.timing.profile {
            self.session.change_profile(offered.profile);
            self.counter = 0;
        }
        self.timing = offered;
        self.session.on_sync();
        self.send_heartbeat();
    }

    fn answer(&mut self, reading: &Reading) {
        self.trips.set(
            Trips::STROKE_LIMIT,
            self.trips.contains(Trips::STROKE_LIMIT) || reading.limits.stroke,
        );
        self.trips.set(
            Trips::VELOCITY_LIMIT,
            self.trips.contains(Trips::VELOCITY_LIMIT) || reading.limits.rate,
        );
        let mut flags = MeasurementFlags::empty();
        flags.set(MeasurementFlags::LIMIT_REACHED, reading.limits.any());
        if reading.behind_m.abs() > LAGGING_M {
            flags |= MeasurementFlags::ACTUATOR_LAGGING;
            self.trips |= Trips::TRACKING;
        }
        let idle = matches!(self.run_state, RunState::Init | RunState::Standby);
        let recent = self.heard && self.silent_cycles < WATCHDOG_CYCLES;
        if idle && !recent {
            return;
        }
        let measurement = Measurement {
            node: self.node,
            counter: self.counter,
            state: self.run_state,
            flags,
            echo: self.session.echo(),
            force_n: Some(reading.force_n),
            displacement_m: Some(reading.displacement_m),
            time_us: Some(self.cycles.wrapping_mul(u64::from(self.timing.period_us)) as u32),
        };
        let profile = self.timing.profile;
        self.put(measurement.encode(profile).0);
        self.counter = profile.next_counter(self.counter);
    }

    fn send_slow_messages(&mut self) {
        let sender = Sender::Rig(self.node);
        if self.is_due(MessageId::Telemetry(self.node)) {
            let telemetry = Telemetry {
                node: self.node,
                counter: self.telemetry_counter,
                state: self.run_state,
                temperature_degc: None,
                pressure: Pressure::Unknown,
                trips: self.trips,
            };
            self.put(telemetry.encode().0);
            self.telemetry_counter = Profile::Classical.next_counter(self.telemetry_counter);
        }
        if self.is_due(MessageId::Heartbeat(sender)) {
            self.send_heartbeat();
        }
    }

    /// Whether a slow message is due in this cycle, by its period in the protocol.
    fn is_due(&self, message: MessageId) -> bool {
        let period_us = u64::from(message.nominal_period_us().unwrap_or(u32::MAX));
        let cycles = (period_us / u64::from(self.timing.period_us.max(1))).max(1);
        self.cycles.is_multiple_of(cycles)
    }

    fn send_heartbeat(&mut self) {
        let sender = Sender::Rig(self.node);
        self.put(Heartbeat { sender, state: self.run_state }.encode());
    }

    fn report(&mut self, code: FaultCode, detail: u16) {
        let (counter, state) = (self.fault_counter, self.run_state);
        let fault = Fault { sender: Sender::Rig(self.node), counter, state, code, detail };
        self.put(fault.encode().0);
        self.fault_counter = Profile::Classical.next_counter(counter);
    }

    /// An owner that takes nothing out loses frames, the newest first, and no more than frames.
    fn put(&mut self, frame: Frame) {
        let _full = self.outbox.push_back(frame);
    }
}

/// What the rig can be asked.
impl RigNode {
    /// Its number.
    pub fn node(&self) -> Node {
        self.node
    }

    /// Period, slow-down, pace and profile, as the last sync set them.
    pub fn timing(&self) -> Timing {
        self.timing
    }

    /// Who waits for whom.
    pub fn pace(&self) -> Pace {
        self.timing.pace
    }

    /// Its run state.
    pub fn run_state(&self) -> RunState {
        self.run_state
    }

    /// Whether the watchdog watches: the host moves the ram, or is about to.
    pub fn is_coupled(&self) -> bool {
        matches!(self.run_state, RunState::RampIn | RunState::Run | RunState::RampOut)
    }

    /// Whether the ram stands still.
    pub fn is_at_rest(&self) -> bool {
        self.state.ram().velocity_m_per_s == 0.0
    }

    /// Cycles since it exists.
    pub fn cycles(&self) -> u64 {
        self.cycles
    }

    /// How often it was armed and set running.
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// How often it went safe by itself.
    pub fn safe_events(&self) -> u64 {
        self.safe_events
    }

    /// What became of the commands.
    pub fn frames(&self) -> FrameCounts {
        self.session.counts()
    }

    /// What its sensors showed last.
    pub fn last(&self) -> Option<Reading> {
        self.last
    }

    /// The physics: what the sensors would show without noise.
    pub fn physics(&self) -> &EmulatorState {
        &self.state
    }
}

/// Whether a command says all that its mode needs.
fn has_value(command: &Command) -> bool {
    let follows = matches!(command.mode, Mode::Follow | Mode::FollowWithVelocity);
    command.state != RunState::Run || !follows || command.displacement_m.is_some()
}
