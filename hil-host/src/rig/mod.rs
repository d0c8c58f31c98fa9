//! The rig: the other end of the bus.
//!
//! [`RigNode`] is a rig as the bus sees it, around the physics of an [`Emulator`]. The same code
//! runs in line on the memory bus and in its own process ([`process`]). The same frames get the
//! same answers, bit for bit.
//!
//! **States.** A rig starts in INIT. It enters the state that the host commands, with one
//! exception: it enters SAFE by itself.
//!
//! | host commands | the rig |
//! | --- | --- |
//! | RAMP_IN or RUN, from a state at rest | begins where the ram stands, and follows |
//! | RAMP_IN, RUN or RAMP_OUT | follows: displacement, or displacement and velocity; HOLD; CENTRE |
//! | any other state | decelerates and holds |
//! | nothing valid for [`WATCHDOG_CYCLES`] cycles | SAFE: decelerates, holds, sends one fault, answers |
//! | RAMP_IN or RUN after that | stays SAFE: only a state at rest releases it |
//!
//! The plant (ram, fixture, damper) stays as it is from session to session.
//!
//! **Cycles.** In lock-step a new valid command is a cycle and gets its answer. In clock pace the
//! owner calls [`RigNode::cycle`] once per period; the newest valid command counts, and in a cycle
//! without one the reference runs on at its last velocity. A frame that is not valid and new
//! changes a counter and nothing else. A command RUN and follow without a displacement is a cycle
//! (and is answered in lock-step), but does not reset the watchdog.
//!
//! **Handshake.** Every sync is answered at once with a heartbeat. A sync begins a new session when
//! no command came since the last sync, or when its time does not continue that of the last one. In
//! a new session counters may start anywhere, and a lock-step rig that was still coupled to an
//! earlier host returns to INIT. A sync also sets period, slow-down, pace and profile. It is
//! refused with a fault and without a heartbeat where it would change those of a coupled rig, or
//! where its version is unknown.

mod account;
mod actuator;
mod emulator;
mod noise;
mod outbox;
pub mod process;
mod session;

pub use actuator::{DECELERATION_M_PER_S2, Limits, RamState, Reference};
pub use emulator::{Emulator, EmulatorState, Reading, Target};
pub use session::{FrameCounts, Timing};

use crate::bus::WireFrame;
use can_protocol::{
    Command, FaultCode, Frame, MeasurementFlags, MessageId, Mode, Node, PROTOCOL_VERSION, Pace,
    Profile, RunState, Sync, Trips,
};
use outbox::Outbox;
use scenario::rig::RigSetup;
use session::Session;

/// Cycles without a valid command after which a coupled rig goes safe.
pub const WATCHDOG_CYCLES: u32 = 5;

/// Distance between command and ram at which the rig reports that it lags (m).
pub const LAGGING_M: f64 = 2e-3;

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
    last: Option<Reading>,
    outbox: Outbox,
}

impl RigNode {
    /// A rig that has heard nothing yet: INIT, clock pace, 1 ms.
    pub fn new(setup: &RigSetup, node: Node, profile: Profile) -> Self {
        let timing = Timing { profile, ..Timing::default() };
        let emulator = Emulator::new(setup, timing.period_s(), u64::from(node.number()));
        let state = emulator.start();
        Self::with_plant(timing, emulator, state, node)
    }

    /// The same rig with its ram at rest somewhere else (m).
    #[must_use]
    pub fn with_ram_at(self, ram_m: f64) -> Self {
        Self { state: self.emulator.start_at(ram_m), ..self }
    }

    fn with_plant(timing: Timing, emulator: Emulator, state: EmulatorState, node: Node) -> Self {
        Self {
            node,
            timing,
            emulator,
            session: Session::new(timing.profile, node),
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
            last: None,
            outbox: Outbox::new(node),
        }
    }

    /// Takes in any frame of the bus. In lock-step a new valid command is executed at once.
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
        let target = if self.is_coupled() { self.target } else { Target::Hold };
        let reading = self.emulator.cycle(&mut self.state, target);
        self.cycles += 1;
        self.last = Some(reading);
        self.answer(&reading);
    }

    /// The host was silent for so long that the owner considers it lost: how a lock-step rig, which
    /// has no time of its own, goes safe. Does nothing unless coupled.
    pub fn host_is_silent(&mut self, cycles: u32) {
        if self.is_coupled() {
            self.go_safe(cycles);
        }
    }

    /// The next frame to send.
    pub fn take_frame(&mut self) -> Option<Frame> {
        self.outbox.take()
    }

    fn obey(&mut self, command: &Command) {
        let commanded = match command.state {
            RunState::Fault => RunState::Safe,
            state => state,
        };
        if is_coupled(commanded) {
            // What is refused is coupling; a rig that runs keeps to its own timing.
            if self.latched || (self.refused && !self.is_coupled()) {
                return;
            }
            if !self.is_coupled() {
                self.emulator.begin(&mut self.state);
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
        // In clock pace a host cannot come back before the watchdog: there its time proves nothing.
        let follows = self.timing.pace == Pace::Clock && self.is_coupled();
        if self.session.on_sync(sync.time_us) && !follows {
            self.session.restart();
            if self.is_coupled() {
                self.run_state = RunState::Init;
            }
        }
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
            self.outbox.change_profile();
        }
        self.timing = offered;
        self.outbox.heartbeat(self.run_state);
    }

    fn answer(&mut self, reading: &Reading) {
        let mut flags = MeasurementFlags::empty();
        flags.set(MeasurementFlags::LIMIT_REACHED, reading.limits.any());
        flags.set(MeasurementFlags::ACTUATOR_LAGGING, reading.behind_m.abs() > LAGGING_M);
        let tripped = [
            (reading.limits.stroke, Trips::STROKE_LIMIT),
            (reading.limits.rate, Trips::VELOCITY_LIMIT),
            (reading.behind_m.abs() > LAGGING_M, Trips::TRACKING),
        ];
        for (_, trip) in tripped.into_iter().filter(|(tripped, _)| *tripped) {
            self.trips |= trip;
        }
        let idle = matches!(self.run_state, RunState::Init | RunState::Standby);
        let recent = self.heard && self.silent_cycles < WATCHDOG_CYCLES;
        if recent || !idle {
            let (profile, echo) = (self.timing.profile, self.session.echo());
            let time_us = self.cycles.wrapping_mul(u64::from(self.timing.period_us)) as u32;
            self.outbox.measurement(profile, self.run_state, flags, echo, reading, time_us);
        }
        self.outbox.slow_messages(self.cycles, self.timing, self.run_state, self.trips);
    }

    fn report(&mut self, code: FaultCode, detail: u16) {
        self.outbox.fault(self.run_state, code, detail);
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
        is_coupled(self.run_state)
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

    /// How the commands were received.
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

/// Whether a rig follows commands in a state.
const fn is_coupled(state: RunState) -> bool {
    matches!(state, RunState::RampIn | RunState::Run | RunState::RampOut)
}

/// Whether a command has every value that its mode needs.
fn has_value(command: &Command) -> bool {
    let follows = matches!(command.mode, Mode::Follow | Mode::FollowWithVelocity);
    !is_coupled(command.state) || !follows || command.displacement_m.is_some()
}
