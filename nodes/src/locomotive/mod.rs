//! The locomotive: the host's end of the bus, as a node with one rig.
//!
//! ```text
//! Meeting -> Arming -> Running -> Leaving -> Over
//!               |         |  a cause: SAFE, 200 cycles of stop -> Over
//!               |  a refusal: STANDBY -> Over
//! ```
//!
//! [`Locomotive`] announces the session until its rig agrees, arms it with the exchange of
//! [`can_protocol::arming`], and couples it where its ram stands. From then on every cycle is the
//! one of the host: measurement, guard, vehicle step, compensation, command, with the checks of
//! [`firmware_core::supervision::Belief`] and the same causes and ends. Frames go in by
//! [`Locomotive::hear`], a tick of a timer is [`Locomotive::tick`], frames come out of
//! [`Locomotive::take_frame`]. In clock pace a tick is a cycle; in lock-step one in which the rig
//! still owes its answer is none.
//!
//! A run gives the trajectory hash of the host's: a test of `hil-host` compares the two.
//!
//! Limits, against the host: one rig on one bus; no watch over the damper, no gate on the delay, no
//! wear in software, no slot that goes on without its rig, no stand-in; a command beyond a limit is
//! limited and ends nothing. It keeps no record.

mod cycle;
mod fault;
mod greeting;
pub mod limits;
pub mod news;
mod overheard;
mod rig_end;

pub use fault::fault_of;
pub use overheard::Overheard;
pub use rig_end::{MAX_DELTA, answer, command_message, measured};

use crate::track::{Reader, TrackFault};
use crate::{WireFrame, wire_state};
use can_protocol::arming::{HostArming, Listener, Patience, Quiet, Refusal, Requirements};
use can_protocol::{Frame, Heartbeat, Node, PROTOCOL_VERSION, Pace, Profile, Sender, Sync};
use core::num::{NonZeroU8, NonZeroU16};
use firmware_core::fnv;
use firmware_core::line::{Fade, Line, LineState};
use firmware_core::supervision::{Action, Cause, Checks, Event, Growth, Signal};
use firmware_core::track::Track;
use heapless::Deque;
use rig_end::RigEnd;

/// Cycles between two heartbeats: 50 Hz.
const HEARTBEAT_CYCLES: u64 = 20;

/// Cycles between two syncs: 10 Hz.
const SYNC_CYCLES: u64 = 100;

/// Cycles of the safe stop before a session ends.
pub const STOP_CYCLES: u64 = 200;

/// Ticks after which a rig that owes an answer is usually lost: a second at 1 kHz.
pub const SILENCE_TICKS: u32 = 1000;

/// Ticks in a row in which the bus has no room, after which the run ends.
const MOST_LATE_IN_A_ROW: u32 = 2;

/// Frames that wait to be taken: a tick has at most five.
const FRAMES: usize = 8;

/// What a locomotive is given besides its line.
#[derive(Debug, Clone, PartialEq)]
pub struct Terms {
    /// The rig's node.
    pub node: Node,
    /// The damper slot that it serves.
    pub slot: usize,
    /// The profile on the wire.
    pub profile: Profile,
    /// Who waits for whom.
    pub pace: Pace,
    /// Real time over model time.
    pub slow_down: NonZeroU8,
    /// The number of this session, which nobody can foresee on a real bus.
    pub number: u32,
    /// The number of this start.
    pub boot: u32,
    /// What is required of the rig before it is armed.
    pub requirements: Requirements,
    /// What is checked of its measurements.
    pub checks: Checks,
    /// How long it may leave a question of the exchange unanswered.
    pub patience: Patience,
    /// Ticks after which a rig that owes an answer in lock-step is lost, as [`SILENCE_TICKS`].
    pub silence_ticks: u32,
    /// Cycles of RUN.
    pub cycles: u64,
}

/// How a session ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// All cycles were run.
    Completed,
    /// Somebody asked for an end.
    Stopped,
    /// A limit asked for an orderly end: coupling and motion were faded out.
    RampedOut,
    /// A cause asked for a stop: the rig was brought to rest.
    Safe,
    /// It never began.
    NotArmed(NotArmed),
}

/// Why a session never began.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NotArmed {
    /// The rig is latched in SAFE or FAULT.
    Latched,
    /// The rig has another version of the protocol.
    Version,
    /// The exchange was refused.
    Refused(Refusal),
    /// The rig does not measure its displacement.
    NoDisplacement,
    /// Its ram stands too far away.
    TooFar,
    /// There is no track to run on.
    Track(TrackFault),
}

/// What ended the motion: the first cause, in its cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Cycle of the line in which it was found.
    pub cycle: u64,
    /// What it was.
    pub cause: Cause,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// The rig has not agreed to the session.
    Meeting,
    /// It is asked, item by item, and then held until its ram is known.
    Arming,
    /// It moves, or is brought to rest.
    Running,
    /// It is sent the end of its session, so many times, the last so many ticks ago.
    Leaving(End, u32, u32),
    /// Nothing is left to do.
    Over(End),
}

/// A locomotive on the bus.
#[derive(Debug)]
pub struct Locomotive<'a> {
    line: &'a Line<'a>,
    state: &'a mut LineState,
    terms: Terms,
    rig: RigEnd,
    exchange: HostArming,
    quiet: Quiet,
    overheard: Overheard,
    phase: Phase,
    /// Ticks of this phase.
    ticks: u64,
    /// Ticks in which an armed rig did not measure its displacement.
    armed_ticks: u32,
    /// Ticks that the rig has owed its answer for.
    silent_ticks: u32,
    /// Ticks in a row in which the bus had no room for a frame.
    late_ticks: u32,
    /// Ticks that the track has been late.
    trackless_ticks: u32,
    growth: Growth,
    is_asked_to_end: bool,
    /// Why the run ends in order.
    why: Option<End>,
    safe_since: Option<u64>,
    stop: Option<Stop>,
    is_announced: bool,
    /// How often the rig has been asked to drop its pressure; none while it need not.
    pressure_off: Option<u8>,
    heartbeat_counter: u8,
    frames: Deque<Frame, FRAMES>,
    hash: u64,
}

impl<'a> Locomotive<'a> {
    /// A locomotive that is going to announce itself, on a line in its start state. None where the
    /// slot has no rig.
    pub fn new(line: &'a Line<'a>, state: &'a mut LineState, terms: Terms) -> Option<Self> {
        let rig = RigEnd::new(terms.node, terms.profile, terms.checks)?;
        let exchange = greeting::exchange(line, &rig, &terms)?;
        Some(Self {
            line,
            state,
            rig,
            exchange,
            terms,
            quiet: Quiet::new(Listener::Host),
            overheard: Overheard::default(),
            phase: Phase::Meeting,
            ticks: 0,
            armed_ticks: 0,
            silent_ticks: 0,
            late_ticks: 0,
            trackless_ticks: 0,
            growth: Growth::default(),
            is_asked_to_end: false,
            why: None,
            safe_since: None,
            stop: None,
            is_announced: false,
            pressure_off: None,
            heartbeat_counter: 0,
            frames: Deque::new(),
            hash: fnv::START,
        })
    }

    /// Takes in any frame of the bus.
    pub fn hear(&mut self, frame: &WireFrame) {
        match self.phase {
            Phase::Meeting => self.hear_of_agreement(frame),
            Phase::Arming => self.hear_answer(frame),
            Phase::Running | Phase::Leaving(..) => {
                if !self.rig.take_frame(frame) {
                    self.overheard.take(frame);
                }
            }
            Phase::Over(_) => {}
        }
    }

    /// One tick of the timer, on the line's track.
    pub fn tick(&mut self, skipped: u32) {
        self.tick_on(self.line.track, skipped);
    }

    /// The same on any stretch of it that holds the whole vehicle; `skipped` ticks before this one
    /// were missed.
    pub fn tick_on(&mut self, track: &Track<'_>, skipped: u32) {
        let before = core::mem::discriminant(&self.phase);
        match self.phase {
            Phase::Meeting => self.announce_session(),
            Phase::Arming => self.arm(track),
            Phase::Running => self.run(track, skipped),
            Phase::Leaving(end, sent, waited) => self.leave(end, sent, waited),
            Phase::Over(_) => {}
        }
        let goes_on = core::mem::discriminant(&self.phase) == before;
        self.ticks = if goes_on { self.ticks + 1 } else { 0 };
    }

    /// The same on a track that comes by messages. It greets its rig when it has its track. In
    /// lock-step it waits for a late one too, as long as for a silent rig; in clock pace a late
    /// track ends the run in SAFE, and in both a track that has become another one.
    pub fn tick_reading<const N: usize>(&mut self, reader: &mut Reader<N>, skipped: u32) {
        let needs_track = match self.phase {
            Phase::Meeting | Phase::Arming => true,
            Phase::Running => !self.state.is_safe(),
            Phase::Leaving(..) | Phase::Over(_) => false,
        };
        let has_track = needs_track && reader.tick(self.state.vehicle.distance_m.lane(0));
        if let (Phase::Meeting | Phase::Arming, false) = (self.phase, has_track) {
            // Nobody is armed for a vehicle without a track.
            if let Some(fault) = reader.fault() {
                self.refuse(NotArmed::Track(fault));
            }
            return;
        }
        self.trackless_ticks =
            if has_track || !needs_track { 0 } else { self.trackless_ticks.saturating_add(1) };
        if self.trackless_ticks > 0 {
            let waits = self.terms.pace == Pace::LockStep && reader.fault().is_none();
            if waits && self.trackless_ticks < self.terms.silence_ticks {
                return;
            }
            let cause = Cause::fact(Signal::Track, f64::from(self.trackless_ticks));
            self.end_motion(cause, Action::Stop);
        }
        let irregularity = reader.view();
        let track = Track { layout: self.line.track.layout.clone(), irregularity };
        self.tick_on(&track, skipped);
    }

    /// The next frame to send.
    pub fn take_frame(&mut self) -> Option<Frame> {
        self.frames.pop_front()
    }

    /// Takes notice whether the bus had room for the frames of a tick; twice in a row without ends
    /// the run in order.
    pub fn note_room(&mut self, had_room: bool) {
        self.late_ticks = if had_room { 0 } else { self.late_ticks.saturating_add(1) };
        if self.late_ticks >= MOST_LATE_IN_A_ROW && self.phase == Phase::Running {
            let (value, limit) = (f64::from(self.late_ticks), f64::from(MOST_LATE_IN_A_ROW));
            let action = Action::RampOut;
            self.end_motion(Cause { signal: Signal::BusQueue, value, limit, action }, action);
        }
    }

    /// Begins an orderly end, as an operator asks for it.
    pub fn ask_to_end(&mut self) {
        self.is_asked_to_end = true;
    }

    /// How the session has ended; none while it goes on.
    pub fn end(&self) -> Option<End> {
        match self.phase {
            Phase::Over(end) => Some(end),
            _ => None,
        }
    }

    /// The first cause that ended the motion.
    pub fn stop(&self) -> Option<Stop> {
        self.stop
    }

    /// The trajectory hash of the cycles so far.
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// The state of its line.
    pub fn state(&self) -> &LineState {
        self.state
    }

    /// Ends the motion as an action asks for, and keeps the first cause.
    fn end_motion(&mut self, cause: Cause, action: Action) {
        // Without a ramp the only way to rest is a stop.
        let is_orderly = action == Action::RampOut && self.state.fade != Fade::default();
        self.state.on(if is_orderly { Event::End } else { Event::Stop });
        if action == Action::PowerOff {
            self.pressure_off.get_or_insert(0);
        }
        self.stop.get_or_insert(Stop { cycle: self.state.cycle, cause });
    }

    /// A locomotive that nobody takes frames from loses them, the newest first.
    fn put(&mut self, frame: Frame) {
        let _full = self.frames.push_back(frame);
    }

    fn put_sync(&mut self) {
        let sync = Sync {
            version: PROTOCOL_VERSION,
            profile: self.terms.profile,
            pace: self.terms.pace,
            period_us: period_us(self.line),
            slow_down: self.terms.slow_down,
            time_us: self.time_us(),
        };
        self.put(sync.encode());
    }

    fn put_heartbeat(&mut self) {
        let (counter, run) = (self.heartbeat_counter, wire_state(self.state.state));
        self.heartbeat_counter = Profile::Classical.next_counter(counter);
        self.put(Heartbeat::new(Sender::Host, counter, run, self.terms.boot).encode().0);
    }

    fn time_us(&self) -> u32 {
        // Wraps after 71.6 minutes, as the field on the wire does.
        (self.state.cycle as f64 * self.line.cycle_s * 1e6) as u64 as u32
    }
}

/// Length of a cycle in the model.
fn period_us(line: &Line<'_>) -> NonZeroU16 {
    NonZeroU16::new(libm::round(line.cycle_s * 1e6) as u16).unwrap_or(NonZeroU16::MIN)
}
