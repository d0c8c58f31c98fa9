//! `yawbench rig`: a rig in its own process and time.
//!
//! In clock pace it runs by its own clock, once per period as the host's sync set it, with the
//! newest valid command; in lock-step it waits for the next command, and considers the host lost
//! after a second of silence. In the safe state it brings the ram to rest by its own clock, in
//! either pace.
//!
//! The clock-paced loop neither prints nor allocates: once per second it hands a small status to an
//! ordinary thread, which prints it.

pub use super::account::{RigSummary, summary_text};

use super::account::{Status, print_statuses};
use super::{RigNode, Timing, replayed};
use crate::BenchError;
use crate::bus::{Bus, Sent, SocketCanBus};
use crate::clock::Pacer;
use crate::draw::Draw;
use crate::realtime::{self, RealtimeOptions};
use crate::silence::{GLANCE, SILENCE, Silence};
use can_protocol::{MessageId, Node, Pace, Profile, RunState, Sender};
use heapless::spsc::{Producer, Queue};
use scenario::rig::RigSetup;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Real time after which a rig that went safe ends, when it is to end with the run.
pub const LINGER: Duration = Duration::from_secs(2);

/// How a rig runs and ends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// The log of a run whose host may arm the rig again, played back on a virtual interface.
    pub accept_replay: Option<PathBuf>,
    /// End when the host has ended its run, or some time after going safe.
    pub exit_after_run: bool,
    /// Real-time set-up.
    pub realtime: RealtimeOptions,
}

/// Runs a rig on a CAN interface until `stop`.
///
/// # Errors
/// The interface cannot be used, or real time is required and was not granted.
pub fn run_on(
    setup: &RigSetup,
    interface: &str,
    node: Node,
    profile: Profile,
    options: &Options,
    stop: &AtomicBool,
) -> Result<RigSummary, BenchError> {
    let draw = match &options.accept_replay {
        Some(log) => Draw::repeating(replayed::rig_number(log, interface, node)?),
        None => Draw::system().map_err(|why| BenchError::NoRandom { why })?,
    };
    let mut bus = SocketCanBus::open(interface, &heard_by(node), profile)?;
    files::say!("rig node {node}, {}, on {interface}: waiting for a host", setup.name);
    let mut rig = RigNode::new(setup, node, profile).with_draw(draw);
    serve(&mut rig, &mut bus, options, stop)
}

/// What a rig listens to: its host, and whoever else is heard under its own ids. The host's sync
/// names the profile in use.
pub fn heard_by(node: Node) -> Vec<MessageId> {
    let is_heard = |message: &MessageId| match *message {
        MessageId::Sync | MessageId::PressureOff(None) | MessageId::Heartbeat(_) => true,
        MessageId::PressureOff(Some(of))
        | MessageId::Command(_, of)
        | MessageId::ArmRequest(of)
        | MessageId::Measurement(_, of)
        | MessageId::Telemetry(of)
        | MessageId::ArmAnswer(of)
        | MessageId::Fault(Sender::Rig(of)) => of == node,
        MessageId::Residual(_)
        | MessageId::Fault(Sender::Host)
        | MessageId::TrackRequest
        | MessageId::TrackOffer
        | MessageId::TrackSample(_) => false,
    };
    MessageId::all().filter(is_heard).collect()
}

/// Serves a rig on a bus until `stop`, or until the run is over when asked to end with it.
///
/// # Errors
/// Real time is required and was not granted.
pub fn serve<B: Bus>(
    rig: &mut RigNode,
    bus: &mut B,
    options: &Options,
    stop: &AtomicBool,
) -> Result<RigSummary, BenchError> {
    let mut queue = Queue::<Status, 4>::new();
    let (to_printer, printer) = queue.split();
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        // Before the real-time set-up, so that it shares neither priority nor processor.
        scope.spawn(|| print_statuses(printer, &done));
        let report = realtime::set_up(&options.realtime);
        for line in report.lines() {
            files::say!("real-time: {line}");
        }
        let granted = report.complete() || !options.realtime.require;
        let skipped =
            if granted { run(rig, bus, options.exit_after_run, stop, to_printer) } else { 0 };
        done.store(true, Ordering::Release);
        if !granted {
            return Err(BenchError::RealtimeRefused);
        }
        Ok(RigSummary::new(rig, bus.counters(), skipped))
    })
}

/// The loop; returns the ticks that its clock missed.
fn run<B: Bus>(
    rig: &mut RigNode,
    bus: &mut B,
    exit_after_run: bool,
    stop: &AtomicBool,
    mut statuses: Producer<'_, Status>,
) -> u64 {
    let mut watch = Watch::new();
    let mut timing = rig.timing();
    let mut pacer = Pacer::new(timing.wall_period_ns(), 1);
    let mut skipped = 0;
    let runs_before = rig.runs();
    while !stop.load(Ordering::Relaxed) {
        if rig.timing() != timing {
            timing = rig.timing();
            skipped += pacer.skipped();
            pacer = Pacer::new(timing.wall_period_ns(), 1);
        }
        // Read once: where the kernel has to be asked, it costs as much as a frame.
        let now;
        if timing.pace == Pace::Clock {
            pacer.wait();
            now = Instant::now();
            take_in(rig, bus);
            // The sync that sets another pace ends this one's cycles.
            if rig.pace() == Pace::Clock {
                rig.cycle();
            }
            send_out(rig, bus);
        } else if rig.is_idle() || (rig.is_latched() && rig.is_at_rest()) {
            // Without commands its own clock is the only one.
            pacer.wait();
            now = Instant::now();
            take_in(rig, bus);
            rig.rest_if_uncommanded();
            send_out(rig, bus);
        } else {
            if bus.wait(GLANCE)
                && let Some(frame) = bus.receive()
            {
                // What has come behind it is there for the next wait.
                rig.on_frame(&frame);
                send_out(rig, bus);
            }
            now = Instant::now();
            if watch.silence(rig, now) >= SILENCE && !rig.is_idle() {
                rig.host_is_silent(silent_cycles(timing));
                send_out(rig, bus);
                come_to_rest(rig, bus, &mut pacer);
            }
        }
        if watch.second_is_over(now) {
            // A printer that is stuck loses lines, and nothing waits for it.
            let _full = statuses.enqueue(Status::of(rig, bus.counters()));
        }
        let over = rig.runs() > runs_before && rig.run_state() == RunState::Standby;
        if exit_after_run && (over || watch.safe_for(rig, now) >= LINGER) {
            break;
        }
    }
    skipped + pacer.skipped()
}

/// Every frame that has arrived; in lock-step the answer to one goes out before the next is taken.
fn take_in<B: Bus>(rig: &mut RigNode, bus: &mut B) {
    while let Some(frame) = bus.receive() {
        rig.on_frame(&frame);
        if rig.pace() == Pace::LockStep {
            send_out(rig, bus);
        }
    }
}

fn send_out<B: Bus>(rig: &mut RigNode, bus: &mut B) {
    while let Some(frame) = rig.take_frame() {
        // Dropped and down are counted by the bus; a host that hears nothing acts by itself.
        let (Sent::Away | Sent::Dropped | Sent::Down) = bus.send(&frame);
    }
}

/// A lock-step rig has no time of its own: when its host is lost, its clock stops the ram.
fn come_to_rest<B: Bus>(rig: &mut RigNode, bus: &mut B, pacer: &mut Pacer) {
    pacer.restart();
    // From the highest speed that a command can name this takes a second at most.
    for _ in 0..1_000_000_000 / pacer.period_ns() {
        if rig.is_at_rest() {
            break;
        }
        pacer.wait();
        rig.cycle();
        send_out(rig, bus);
    }
}

fn silent_cycles(timing: Timing) -> u32 {
    let cycles = SILENCE.as_nanos() / u128::from(timing.wall_period_ns().max(1));
    u32::try_from(cycles).unwrap_or(u32::MAX)
}

/// Real times that the loop looks at.
struct Watch {
    accepted: u64,
    silence: Silence,
    safe_since: Option<Instant>,
    printed: Instant,
}

impl Watch {
    fn new() -> Self {
        let now = Instant::now();
        Self { accepted: 0, silence: Silence::from(now), safe_since: None, printed: now }
    }

    /// How long no new valid command had come at that time.
    fn silence(&mut self, rig: &RigNode, now: Instant) -> Duration {
        let accepted = rig.frames().received;
        if accepted != self.accepted {
            self.accepted = accepted;
            self.silence = Silence::from(now);
        }
        self.silence.lasts(now)
    }

    fn safe_for(&mut self, rig: &RigNode, now: Instant) -> Duration {
        if !rig.is_latched() {
            self.safe_since = None;
            return Duration::ZERO;
        }
        now.saturating_duration_since(*self.safe_since.get_or_insert(now))
    }

    fn second_is_over(&mut self, now: Instant) -> bool {
        let over = now.saturating_duration_since(self.printed) >= Duration::from_secs(1);
        if over {
            self.printed = now;
        }
        over
    }
}
