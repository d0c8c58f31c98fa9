//! `summary.json`: what a machine reads of a run. The schema is `docs/schema/summary.schema.json`.

mod accelerations;
mod counters;
mod dampers;
mod frames;
mod held;
mod late;
mod outcome;
mod sessions;
mod stand_ins;
mod times;
mod tracking;
mod wear;

pub use accelerations::{Acceleration, Accelerations};
pub use dampers::{DamperSummary, ForceRange, Stroke};
pub use frames::{BusCount, Frames};
pub use sessions::ArmedSession;
pub use stand_ins::StandInSummary;
pub use times::{Percentiles, StepPercentiles};
pub use tracking::{MeasuredDelay, TrackingSummary};
pub use wear::WearSummary;

pub(crate) use accelerations::accelerations;
pub(crate) use dampers::dampers;
pub(crate) use held::is_worn;
pub(crate) use late::{Asked, KeptSummary};
pub(crate) use outcome::Outcome;
pub(crate) use stand_ins::labels;
pub(crate) use times::{microseconds, percentiles};

use crate::comparison::Comparison;
use crate::control::{Asker, DropOutSummary, End, HASH_ALGORITHM, NotedSummary, StopSummary};
use crate::counts::Counts;
use crate::linear_vehicle::Hunting;
use crate::options::PaceChoice;
use crate::record::RunEvent;
use crate::statistics::Statistics;
use frames::frames;
use held::Counted;
use serde::Serialize;
use sessions::sessions;
use times::step_percentiles;

/// The summary of a run. What does not apply is null.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Version of this format.
    pub format: u32,
    /// Title of the scenario.
    pub title: String,
    /// The vehicle.
    pub vehicle: String,
    /// Notes on its numbers: which are calibrated and not measured.
    pub notes: Vec<String>,
    /// The bus and the pace, as given.
    pub bus: String,
    /// `realtime`, `lockstep` or `fast`.
    pub pace: PaceChoice,
    /// Running speed (km/h).
    pub speed_kmh: f64,
    /// Control cycles per second (Hz).
    pub rate_hz: u32,
    /// Control cycles of RUN.
    pub steps: u64,
    /// All control cycles, those before and after RUN included.
    pub cycles: u64,
    /// Model time in RUN (s).
    pub duration_s: f64,
    /// Time at the start that the statistics leave out (s).
    pub run_in_s: f64,
    /// Time that the statistics of dampers and bodies cover (s).
    pub statistics_s: f64,
    /// Real time of the loop (s).
    pub wall_s: f64,
    /// Ticks of the clock that were missed and skipped.
    pub overruns: u64,
    /// Time from receive to send (µs).
    pub cycle_time_us: Percentiles,
    /// Time of the vehicle step alone (µs).
    pub step_compute_us: StepPercentiles,
    /// How late cycles began; null without a clock (µs).
    pub lateness_us: Option<Percentiles>,
    /// Frames of the cyclic pair.
    pub frames: Frames,
    /// Everything that passed the bus, seen from the host.
    pub bus_counters: BusCount,
    /// The damper slots, in their order.
    pub damper: Vec<DamperSummary>,
    /// The vehicle's least damped oscillation, at which delays are judged; null where it was not
    /// computed.
    pub hunting: Option<Hunting>,
    /// Accelerations of three bodies.
    pub accelerations: Accelerations,
    /// The same run with another damper; null without `[compare]`.
    pub comparison: Option<Comparison>,
    /// `completed`, `stopped`, `ramped_out` or `safe`.
    pub state: End,
    /// Who asked for the end of a run that was stopped: `key`, `page`, `signal` or `record`; null
    /// otherwise.
    pub stopped_by: Option<Asker>,
    /// Why a completed run is not held, one sentence each; empty where it is.
    pub not_held: Vec<String>,
    /// What stopped it; null unless it ended in the safe state.
    pub cause: Option<StopSummary>,
    /// Rigs that were lost while the vehicle went on with their models, in the order of the slots.
    pub drop_outs: Vec<DropOutSummary>,
    /// One line for each measured force that acted on several bogies.
    pub labels: Vec<String>,
    /// What was beyond a limit of `[plausibility]` and ended nothing.
    pub noted: Vec<NotedSummary>,
    /// What happened, in the order of the cycles: at most the first 1000 events.
    pub events: Vec<RunEvent>,
    /// Why the record could not be kept and the run was ended; null otherwise.
    pub record_fault: Option<String>,
    /// 16 hex digits over host state and received forces of every cycle.
    pub trajectory_hash: String,
    /// How the hash is made.
    pub trajectory_hash_algorithm: String,
    /// Rows and frames that the recorder or the disk had no room for.
    pub record_dropped: u64,
    /// Worst-case share of the bus that the cyclic pair takes.
    pub bus_load: f64,
    /// The armed sessions, one for each rig.
    pub sessions: Vec<ArmedSession>,
    /// What is known of the rigs by calibration, one line for each part.
    pub calibrations: Vec<String>,
}

impl Summary {
    /// Sums up a run.
    pub(crate) fn of(outcome: &Outcome<'_>, counts: &Counts, statistics: &Statistics) -> Self {
        let run = outcome.run;
        let state = outcome.state;
        let sums = statistics.after_run_in();
        let clocked = outcome.pace == PaceChoice::Realtime;
        let mut dampers = dampers(run, counts, sums, outcome.hunting);
        for (port, memory) in outcome.ports.iter().zip(&state.ports) {
            debug_assert!(port.slot < dampers.len(), "a rig without a damper slot");
            if let Some(damper) = dampers.get_mut(port.slot) {
                damper.saturated_commands = Some(memory.saturated);
                damper.flagged_measurements = Some(memory.flagged);
                damper.limited_commands = Some(state.line.slots[port.slot].limited);
                damper.virtual_wear = WearSummary::of(outcome.line, state, port.slot);
                if let Some(tracking) = &mut damper.tracking {
                    let delay = state.gate.delays[port.slot].residual(run.cycle_s());
                    tracking.before_run = delay.map(|delay| tracking.measured(delay));
                }
            }
        }
        let frames = frames(outcome);
        let drop_outs = drop_outs(outcome);
        let counted = Counted {
            cycles: state.line.cycle,
            skipped: state.skipped,
            unrecorded: outcome.record_dropped,
            frames: &frames,
            dampers: &dampers,
            places: &run.slots,
            drop_outs: &drop_outs,
        };
        let not_held = match outcome.end {
            End::Completed => held::not_held(&counted),
            End::Stopped | End::RampedOut | End::Safe => Vec::new(),
        };
        Self {
            format: 1,
            title: run.title.clone(),
            vehicle: run.vehicle_name.clone(),
            notes: run.about.clone(),
            bus: outcome.bus.clone(),
            pace: outcome.pace,
            speed_kmh: run.speed_m_per_s * 3.6,
            rate_hz: run.rate.hz(),
            steps: counts.run_cycles,
            cycles: state.line.cycle,
            duration_s: counts.run_cycles as f64 * run.cycle_s(),
            run_in_s: run.run_in_s,
            statistics_s: sums.rows as f64 * run.cycle_s(),
            wall_s: outcome.wall_s,
            overruns: state.skipped,
            cycle_time_us: percentiles(&counts.cycle_ns),
            step_compute_us: step_percentiles(&counts.compute_ns),
            lateness_us: clocked.then(|| percentiles(&counts.lateness_ns)),
            frames,
            bus_counters: outcome.counters.into(),
            damper: dampers,
            hunting: outcome.hunting,
            accelerations: accelerations(outcome.watched, sums),
            comparison: None,
            state: outcome.end,
            stopped_by: outcome.asker,
            not_held,
            cause: state.stop.map(|stop| stop.summary()),
            drop_outs,
            labels: labels(run),
            noted: outcome.noted.clone(),
            events: outcome.events.clone(),
            record_fault: outcome.record_fault.clone(),
            trajectory_hash: format!("{:016x}", state.hash),
            trajectory_hash_algorithm: HASH_ALGORITHM.to_owned(),
            record_dropped: outcome.record_dropped,
            bus_load: outcome.bus_load,
            sessions: sessions(outcome.ports, &state.ports),
            calibrations: outcome.calibrations.clone(),
        }
    }
}

/// The rigs that were lost while the vehicle went on.
fn drop_outs(outcome: &Outcome<'_>) -> Vec<DropOutSummary> {
    let ports = outcome.ports.iter().zip(&outcome.state.ports);
    let lost = ports.filter_map(|(port, memory)| {
        let place = outcome.run.slots.get(port.slot)?;
        Some(DropOutSummary::of(&place.place, &memory.dropped_out?))
    });
    lost.collect()
}
