//! One session with one fault, and the invariants that hold in every cycle of it.

use super::faulty_bus::FaultyBus;
use super::kind::Fault;
use crate::BenchError;
use crate::bus::BusChoice;
use crate::clock::Tick;
use crate::control::{Buses, Course, End, Ending, NoAnswer, Requests, Session, SessionState, Stop};
use crate::record::Queues;
use crate::run::{Plan, Terms, session};
use can_protocol::{Node, Profile, RunState};
use firmware_core::line::SlotState;
use firmware_core::supervision::{LossLimits, OLDEST_CYCLES, State};
use firmware_core::vehicle::DAMPER_SLOTS;
use scenario::run::Run;
use std::f64::consts::FRAC_PI_2;
use std::fmt;
use std::time::Duration;

/// When a fault acts, and for how long the session goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Injection {
    /// The fault.
    pub fault: Fault,
    /// Cycle in which it begins.
    pub begin: u64,
    /// Cycles that it lasts.
    pub lasts: u64,
    /// Last cycle of a session that nothing ends.
    pub until: u64,
}

impl Injection {
    /// The tick that begins the cycle after so many.
    fn tick(&self, cycles: u64) -> Tick {
        let skipped = match self.fault {
            Fault::SkipSlots(slots) if cycles == self.begin => u64::from(slots),
            _ => 0,
        };
        Tick { skipped, ..Tick::default() }
    }
}

/// What became of a fault.
#[derive(Debug, Clone, PartialEq)]
pub struct Injected {
    /// The cycle in which it began.
    pub begin: u64,
    /// What stopped the session.
    pub stop: Option<Stop>,
    /// Why the vehicle went on without the rig that the fault was about.
    pub dropped_out: Option<Stop>,
    /// How the session ended; none where it went on.
    pub end: Option<End>,
    /// State of the rig at the end.
    pub rig: RunState,
    /// Cycles done.
    pub cycles: u64,
    /// Measurements of them that were lost.
    pub lost: u64,
    /// Trajectory hash at the end.
    pub hash: u64,
    /// The first invariant that did not hold.
    pub violation: Option<Violation>,
}

impl Injected {
    /// Cycles from the beginning of the fault until it was found.
    pub fn cycles_to_detect(&self) -> Option<u64> {
        self.found().map(|stop| stop.cycle.saturating_sub(self.begin))
    }

    /// What was found first.
    pub fn found(&self) -> Option<Stop> {
        self.dropped_out.or(self.stop)
    }
}

/// An invariant that did not hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Violation {
    /// A command further from the last than the highest speed allows (m).
    Step {
        /// Control cycle.
        cycle: u64,
        /// The step.
        step_m: f64,
    },
    /// A command whose speed changes by more than the acceleration allows (m/s).
    Change {
        /// Control cycle.
        cycle: u64,
        /// The change.
        change_m_per_s: f64,
    },
    /// RUN on a measurement that is too old.
    Stale {
        /// Control cycle.
        cycle: u64,
        /// Its age in cycles.
        age_cycles: u8,
    },
    /// A session that had found a cause went on in RUN.
    RunsOn {
        /// Control cycle.
        cycle: u64,
    },
    /// A command that still moved when the time for the safe stop was over (m/s).
    StillMoves {
        /// Control cycle.
        cycle: u64,
        /// Its speed.
        speed_m_per_s: f64,
    },
    /// A session that left the safe state.
    LeavesSafe {
        /// Control cycle.
        cycle: u64,
    },
    /// A force that steps further than the fade to the model of a lost rig allows (N).
    Force {
        /// Control cycle.
        cycle: u64,
        /// The step.
        step_n: f64,
    },
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Step { cycle, step_m } => {
                write!(f, "cycle {cycle}: the command steps by {:.3} mm", step_m * 1e3)
            }
            Self::Change { cycle, change_m_per_s } => {
                let change = change_m_per_s * 1e3;
                write!(f, "cycle {cycle}: the speed of the command changes by {change:.3} mm/s")
            }
            Self::Stale { cycle, age_cycles } => {
                write!(f, "cycle {cycle}: RUN on a measurement {age_cycles} cycles old")
            }
            Self::RunsOn { cycle } => write!(f, "cycle {cycle}: RUN after a cause was found"),
            Self::StillMoves { cycle, speed_m_per_s } => {
                let speed = speed_m_per_s * 1e3;
                write!(f, "cycle {cycle}: the safe stop still moves at {speed:.3} mm/s")
            }
            Self::LeavesSafe { cycle } => write!(f, "cycle {cycle}: the safe state was left"),
            Self::Force { cycle, step_n } => {
                write!(f, "cycle {cycle}: a force that is faded out steps by {step_n:.0} N")
            }
        }
    }
}

/// Greatest age of a force that the vehicle feels in RUN, cycles: the oldest that is believed, held
/// over as many lost ones as do not end the run.
const OLDEST_HELD_CYCLES: u8 = OLDEST_CYCLES + LossLimits::USUAL.in_a_row as u8 - 1;

/// Rounding in the comparison with a limit.
const ROUNDING: f64 = 1.0 + 1e-9;

/// Hands a scenario's session on the memory bus, and the node of its first rig, to `work`.
///
/// # Errors
/// The scenario has no rig, or those of `work`.
pub(super) fn in_memory<T>(
    run: &Run,
    work: impl FnOnce(&Session<'_>, Node) -> Result<T, BenchError>,
) -> Result<T, BenchError> {
    let plan = Plan::new(run, &BusChoice::Memory)?;
    let track = run.track.view();
    let session = session(run, &track, &plan.rigs, Terms::in_memory(Profile::Classical))?;
    work(&session, plan.rigs.first().map_or(Node::ALL[0], |rig| rig.node))
}

/// The nodes of a session's rigs.
pub(super) fn nodes(session: &Session<'_>) -> impl Iterator<Item = Node> {
    session.ports.iter().map(|port| port.node)
}

/// Runs a session into a fault, until it has ended or its cycles are done.
///
/// # Errors
/// The rig cannot be armed.
pub fn inject(
    session: &Session<'_>,
    run: &Run,
    bus: &mut FaultyBus,
    injection: &Injection,
) -> Result<Injected, NoAnswer> {
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let requests = Requests::armed();
    session.greet(&mut state, std::slice::from_mut(bus), Duration::from_secs(1), &requests)?;
    bus.inject(injection.fault, injection.begin, injection.lasts);
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let mut ending = Ending::default();
    let (mut end, mut violation, mut safe_since) = (None, None, None);
    let mut course = Course::new(run, session.line.track);
    let mut track = course.track();
    while state.line.cycle < injection.until && end.is_none() {
        if course.is_passed(&state.line) {
            drop(track);
            if course.change().is_err() {
                end = Some(End::Stopped);
                break;
            }
            track = course.track();
        }
        let (before, tick) = (Before::of(&state), injection.tick(state.line.cycle));
        let mut buses = Buses::new(std::slice::from_mut(bus), &mut recorder);
        session.cycle_on(&track, &mut state, &mut buses, tick);
        violation = violation
            .or_else(|| violated(session, &state, &before))
            .or_else(|| stops_unsafely(session, &state, &mut safe_since))
            .or_else(|| drops_out_badly(session, &state, &before));
        end = ending.take(session, &mut state, u64::MAX, false);
    }
    let rig = bus.rig().map_or(RunState::Init, crate::rig::RigNode::run_state);
    let (stop, cycles, hash) = (state.stop, state.line.cycle, state.hash);
    let dropped_out = state.ports.iter().find_map(|port| port.dropped_out);
    let lost = state.ports.iter().map(|port| port.belief.losses().0.total()).sum();
    let begin = injection.begin;
    Ok(Injected { begin, stop, dropped_out, end, rig, cycles, lost, hash, violation })
}

/// What the slots were before a cycle.
struct Before {
    slots: [SlotState; DAMPER_SLOTS],
    forces_n: [f64; DAMPER_SLOTS],
}

impl Before {
    fn of(state: &SessionState) -> Self {
        let forces_n = state.line.vehicle.damper_n.map(|force| force.lane(0));
        Self { slots: state.line.slots, forces_n }
    }
}

/// The first invariant that a cycle did not keep.
fn violated(session: &Session<'_>, state: &SessionState, before: &Before) -> Option<Violation> {
    let (cycle, cycle_s) = (state.line.cycle, session.line.cycle_s);
    let is_running = state.line.state == State::Run;
    if is_running && state.stop.is_some() {
        return Some(Violation::RunsOn { cycle });
    }
    session.ports.iter().zip(&state.ports).find_map(|(port, memory)| {
        let (last, now) = (before.slots.get(port.slot)?, state.line.slots.get(port.slot)?);
        let step_m = (now.command.displacement_m - last.command.displacement_m).abs();
        let change_m_per_s = (now.command.velocity_m_per_s - last.command.velocity_m_per_s).abs();
        let age = memory.belief.age_cycles().filter(|age| *age > OLDEST_HELD_CYCLES);
        if step_m > now.limits.velocity_m_per_s * cycle_s * ROUNDING {
            return Some(Violation::Step { cycle, step_m });
        }
        if change_m_per_s > now.limits.acceleration_m_per_s2 * cycle_s * ROUNDING {
            return Some(Violation::Change { cycle, change_m_per_s });
        }
        let age = age.filter(|_| is_running && !memory.has_dropped_out());
        age.map(|age_cycles| Violation::Stale { cycle, age_cycles })
    })
}

/// Cycles in which a force that is not believed leaves the vehicle.
const FADE_CYCLES: f64 = 20.0;

/// Whether a slot that goes on without its rig has a step in its force, or moves its ram for longer
/// than a stop takes.
fn drops_out_badly(
    session: &Session<'_>,
    state: &SessionState,
    before: &Before,
) -> Option<Violation> {
    let cycle = state.line.cycle;
    session.ports.iter().zip(&state.ports).find_map(|(port, memory)| {
        let (why, slot) = (memory.dropped_out?, state.line.slots.get(port.slot)?);
        let (model_n, last_n) = (slot.damper.force_n(), before.slots[port.slot].damper.force_n());
        let step_n =
            (state.line.vehicle.damper_n[port.slot].lane(0) - before.forces_n[port.slot]).abs();
        // The steepest cycle of the fade, and what the model does in it.
        let faded_n = FRAC_PI_2 / FADE_CYCLES * (slot.guard.force_n - last_n).abs();
        if step_n > (model_n - last_n).abs() + faded_n * ROUNDING + 1e-6 {
            return Some(Violation::Force { cycle, step_n });
        }
        let speed_m_per_s = slot.command.velocity_m_per_s.abs();
        let moves = cycle > why.cycle + stop_cycles(session, slot) && speed_m_per_s > 0.0;
        moves.then_some(Violation::StillMoves { cycle, speed_m_per_s })
    })
}

/// Cycles that a stop takes from the highest speed of a slot's command.
fn stop_cycles(session: &Session<'_>, slot: &SlotState) -> u64 {
    let stop_s = slot.limits.velocity_m_per_s / slot.limits.acceleration_m_per_s2;
    (stop_s / session.line.cycle_s).ceil() as u64 + 1
}

/// Whether the safe state is kept, and reached in the time that the highest speed takes to stop.
fn stops_unsafely(
    session: &Session<'_>,
    state: &SessionState,
    safe_since: &mut Option<u64>,
) -> Option<Violation> {
    let cycle = state.line.cycle;
    if !state.line.is_safe() {
        return safe_since.map(|_| Violation::LeavesSafe { cycle });
    }
    let since = *safe_since.get_or_insert(cycle);
    session.ports.iter().find_map(|port| {
        let slot = state.line.slots.get(port.slot)?;
        let speed_m_per_s = slot.command.velocity_m_per_s.abs();
        let moves = cycle > since + stop_cycles(session, slot) && speed_m_per_s > 0.0;
        moves.then_some(Violation::StillMoves { cycle, speed_m_per_s })
    })
}
