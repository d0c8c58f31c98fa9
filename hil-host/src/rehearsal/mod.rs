//! A run rehearsed on emulated rigs: how far every limit is away, before anything is armed.
//!
//! ```text
//! margin = 1 - reached / limit
//! ```
//! The scenario runs on the memory bus, as fast as the machine computes, with the pause of the
//! ramp-in in which the delay is judged. What is reached comes from the supervision itself: from
//! its rules, its sums of work and its count of losses, and from what the command has asked of the
//! limits of `[motion]`. A limit that ends the run ends the rehearsal too; what comes later is then
//! not known.
//!
//! Limits: the emulated rig is a delay, a fixture and a damper. It has no clock, so that lateness
//! and losses are those of no bus. `yawbench rtcheck` and `yawbench doctor` ask for these.

mod checks;
mod measured_ram;
mod text;

pub use checks::{CheckMargin, LimitOf, Verdict};
pub use measured_ram::TRACKING;

use crate::BenchError;
use crate::bus::BusChoice;
use crate::control::{End, PortState, Session, SessionState, StopSummary};
use crate::linear_vehicle::LinearVehicle;
use crate::measured_ram::MeasuredRam;
use crate::progress_bar::LateBar;
use crate::record::Row;
use crate::run::{Plan, StabilityCheck, Terms, in_memory, needed_bytes, profile_of};
use can_protocol::RunState;
use checks::{of_delay, of_disk, of_motion, of_plausibility, of_stability, of_wear};
use scenario::run::Run;
use serde::Serialize;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// Cycles after which progress is shown again.
const SHOWN_CYCLES: u64 = 1000;

/// What a rehearsal has found; the schema is `docs/schema/rehearsal.schema.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rehearsal {
    /// Version of this format.
    pub format: u32,
    /// Title of the scenario.
    pub title: String,
    /// What the rigs are: `emulated rig`.
    pub rigs: &'static str,
    /// Running speed (km/h).
    pub speed_kmh: f64,
    /// Model time in RUN (s).
    pub duration_s: f64,
    /// How late the rams of the emulated rigs are, and where the figure is from; null for the rig
    /// of the scenario.
    pub ram: Option<MeasuredRam>,
    /// `completed`, `ramped_out` or `safe`.
    pub state: End,
    /// What ended it early.
    pub cause: Option<StopSummary>,
    /// Whether it was completed with all its rigs and nothing was beyond its limit.
    pub holds: bool,
    /// Every check.
    pub checks: Vec<CheckMargin>,
}

/// Rehearses a scenario; none where `stop` was set. `free_bytes` is the room on the disk of the
/// results, none where it is not known.
///
/// # Errors
/// No damper is on a rig, or the scenario cannot run in memory.
pub fn rehearse(
    run: &Run,
    ram: Option<MeasuredRam>,
    linear: Option<&LinearVehicle>,
    free_bytes: Option<u64>,
    stop: &AtomicBool,
) -> Result<Option<Rehearsal>, BenchError> {
    let plan = Plan::new(run, &BusChoice::Memory)?;
    if plan.rigs.is_empty() {
        return Err(BenchError::NoRig { title: run.title.clone() });
    }
    let profile = profile_of(run.rate);
    let terms = Terms {
        gate_hz: linear.map(|linear| linear.hunting.frequency_hz),
        shows_progress: true,
        ..Terms::in_memory(profile)
    };
    let mut run_cycles = 0_u64;
    let mut bar = LateBar::new("rehearsal", run.cycles());
    let take = |row: &Row| {
        if stop.load(Ordering::Relaxed) {
            return Ok(ControlFlow::Break(()));
        }
        run_cycles += u64::from(row.state == RunState::Run);
        if row.cycle.is_multiple_of(SHOWN_CYCLES) {
            bar.at(run_cycles);
        }
        Ok(ControlFlow::Continue(()))
    };
    let close = |session: &Session<'_>, state: &SessionState, end: End| {
        let mut checks = Vec::new();
        for (port, memory) in session.ports.iter().zip(&state.ports) {
            let Some(slot) = run.slots.get(port.slot) else { continue };
            checks.extend(of_motion(slot, &state.line.slots[port.slot], run.cycle_s()));
            checks.extend(of_plausibility(slot, &port.reached(memory)));
            checks.extend(of_wear(slot, state.gate.wear[port.slot]));
            checks.extend(of_delay(slot, &state.gate.delays[port.slot], run.cycle_s(), linear));
        }
        checks.extend(of_stability(&StabilityCheck::of(session, run, linear)));
        let is_whole = !state.ports.iter().any(PortState::has_dropped_out);
        (checks, (end, is_whole), state.stop.map(|stop| stop.summary()))
    };
    let found = in_memory(run, terms, |_| {}, run.cycles(), take, close)?;
    bar.finish();
    let Some((mut checks, (state, is_whole), cause)) = found else { return Ok(None) };
    checks.push(of_disk(needed_bytes(run, &plan, profile), free_bytes));
    let is_beyond = checks.iter().any(|check| check.verdict == Verdict::Beyond);
    Ok(Some(Rehearsal {
        format: 1,
        title: run.title.clone(),
        rigs: "emulated rig",
        speed_kmh: 3.6 * run.speed_m_per_s,
        duration_s: run_cycles as f64 * run.cycle_s(),
        ram,
        state,
        cause,
        holds: state == End::Completed && is_whole && !is_beyond,
        checks,
    }))
}
