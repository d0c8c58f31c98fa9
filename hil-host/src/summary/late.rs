//! The summary of a run whose program is gone, from its files.

use super::stand_ins::labels;
use super::{ArmedSession, Frames, Summary, accelerations, dampers, percentiles, step_percentiles};
use crate::bus::BusCounters;
use crate::control::{Asker, DropOutSummary, End, HASH_ALGORITHM, NotedSummary, StopSummary};
use crate::counts::Counts;
use crate::linear_vehicle::Hunting;
use crate::options::PaceChoice;
use crate::record::RunEvent;
use crate::statistics::Statistics;
use scenario::run::Run;
use serde::Deserialize;

/// What only the program knew and `summary.json` holds.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub(crate) struct KeptSummary {
    pub(crate) format: u32,
    /// All control cycles.
    pub(crate) cycles: u64,
    pub(crate) wall_s: f64,
    pub(crate) overruns: u64,
    pub(crate) frames: Frames,
    pub(crate) bus_counters: super::BusCount,
    pub(crate) state: End,
    /// None in a file of an earlier version.
    #[serde(default)]
    pub(crate) stopped_by: Option<Asker>,
    pub(crate) not_held: Vec<String>,
    pub(crate) cause: Option<StopSummary>,
    /// Empty in a file of an earlier version.
    #[serde(default)]
    pub(crate) drop_outs: Vec<DropOutSummary>,
    /// Empty in a file of an earlier version.
    #[serde(default)]
    pub(crate) noted: Vec<NotedSummary>,
    pub(crate) record_fault: Option<String>,
    pub(crate) trajectory_hash: String,
    pub(crate) record_dropped: u64,
    /// Empty in a file of an earlier version.
    #[serde(default)]
    pub(crate) sessions: Vec<ArmedSession>,
    /// Null without one.
    pub(crate) comparison: Option<serde_json::Value>,
}

/// What a run was asked for, as far as its summary needs it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Asked {
    pub(crate) bus: String,
    pub(crate) pace: PaceChoice,
    pub(crate) bus_load: f64,
    pub(crate) watched: [Option<usize>; 3],
    /// The vehicle's hunting.
    pub(crate) hunting: Option<Hunting>,
    /// What happened, from the file of the events.
    pub(crate) events: Vec<RunEvent>,
    /// Damper slots on rigs.
    pub(crate) rigs: usize,
    /// What is known of them by calibration.
    pub(crate) calibrations: Vec<String>,
}

impl Summary {
    /// Sums up a run from its record and, where it has ended by itself, from its summary. Without
    /// one the frames are counted from the rows.
    pub(crate) fn of_record(
        run: &Run,
        asked: &Asked,
        (counts, statistics): (&Counts, &Statistics),
        kept: Option<&KeptSummary>,
    ) -> Self {
        let sums = statistics.after_run_in();
        let (cycles, hash) = counts.last;
        let counted = Frames {
            sent: cycles * asked.rigs as u64,
            received: counts.fresh.iter().sum(),
            lost: counts.stale.iter().sum(),
            crc_errors: 0,
            repeated: 0,
            wrong_sequence: 0,
            late: 0,
        };
        let clocked = asked.pace == PaceChoice::Realtime;
        Self {
            format: 1,
            title: run.title.clone(),
            vehicle: run.vehicle_name.clone(),
            notes: run.about.clone(),
            bus: asked.bus.clone(),
            pace: asked.pace,
            speed_kmh: run.speed_m_per_s * 3.6,
            rate_hz: run.rate.hz(),
            steps: counts.run_cycles,
            cycles,
            duration_s: counts.run_cycles as f64 * run.cycle_s(),
            run_in_s: run.run_in_s,
            statistics_s: sums.rows as f64 * run.cycle_s(),
            wall_s: kept.map_or(0.0, |kept| kept.wall_s),
            overruns: kept.map_or(counts.skipped, |kept| kept.overruns),
            cycle_time_us: percentiles(&counts.cycle_ns),
            step_compute_us: step_percentiles(&counts.compute_ns),
            lateness_us: clocked.then(|| percentiles(&counts.lateness_ns)),
            frames: kept.map_or(counted, |kept| kept.frames),
            bus_counters: kept
                .map_or_else(|| BusCounters::default().into(), |kept| kept.bus_counters),
            damper: dampers(run, counts, sums, asked.hunting),
            hunting: asked.hunting,
            accelerations: accelerations(asked.watched, sums),
            comparison: None,
            state: kept.map_or(End::Stopped, |kept| kept.state),
            stopped_by: kept.and_then(|kept| kept.stopped_by),
            not_held: kept.map_or_else(Vec::new, |kept| kept.not_held.clone()),
            cause: kept.and_then(|kept| kept.cause.clone()),
            drop_outs: kept.map_or_else(Vec::new, |kept| kept.drop_outs.clone()),
            labels: labels(run),
            noted: kept.map_or_else(Vec::new, |kept| kept.noted.clone()),
            events: asked.events.clone(),
            record_fault: kept.and_then(|kept| kept.record_fault.clone()),
            trajectory_hash: kept
                .map_or_else(|| format!("{hash:016x}"), |kept| kept.trajectory_hash.clone()),
            trajectory_hash_algorithm: HASH_ALGORITHM.to_owned(),
            record_dropped: kept
                .map_or(cycles.saturating_sub(counts.rows()), |kept| kept.record_dropped),
            bus_load: asked.bus_load,
            sessions: kept.map_or_else(Vec::new, |kept| kept.sessions.clone()),
            calibrations: asked.calibrations.clone(),
        }
    }
}
