//! `summary.json`: what a machine reads of a run. The schema is `docs/schema/summary.schema.json`.

use crate::bus::BusCounters;
use crate::columns::Columns;
use crate::comparison::Comparison;
use crate::control::{End, SessionState, hash};
use hdrhistogram::Histogram;
use scenario::run::{CYCLE_S, Run, SlotForce};
use serde::Serialize;
use signal::spectrum::Spectrum;
use signal::statistics;

/// The summary of a run. What does not apply is null.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Version of this format.
    pub format: u32,
    /// Title of the scenario.
    pub title: String,
    /// The vehicle.
    pub vehicle: String,
    /// What one should know about its numbers: which are calibrated and not measured.
    pub notes: Vec<String>,
    /// The bus and the pace, as given.
    pub bus: String,
    /// `realtime`, `lockstep` or `fast`.
    pub pace: String,
    /// Running speed (km/h).
    pub speed_kmh: f64,
    /// Control cycles done.
    pub steps: u64,
    /// Model time (s).
    pub duration_s: f64,
    /// Time at the start that the statistics leave out (s).
    pub run_in_s: f64,
    /// Time that the statistics of dampers and bodies cover: at most 20 minutes (s).
    pub statistics_s: f64,
    /// Wall time of the loop (s).
    pub wall_s: f64,
    /// Slots of the clock that were missed and skipped.
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
    /// Accelerations of three bodies.
    pub accelerations: Accelerations,
    /// The same run with another damper; null without `[compare]`.
    pub comparison: Option<Comparison>,
    /// `completed`, `stopped` or `safe`.
    pub state: String,
    /// 16 hex digits over host state and received forces of every cycle.
    pub trajectory_hash: String,
    /// How the hash is made.
    pub trajectory_hash_algorithm: String,
    /// Rows and frames that the recorder had no room for.
    pub record_dropped: u64,
    /// Worst-case share of the bus that the cyclic pair takes.
    pub bus_load: f64,
}

/// Percentiles of a time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Percentiles {
    pub p50: f64,
    pub p99: f64,
    pub p99_9: f64,
    pub max: f64,
}

/// Percentiles of the vehicle step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct StepPercentiles {
    pub p50: f64,
    pub p99: f64,
    pub max: f64,
}

/// Frames of the cyclic pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Frames {
    /// Commands that the bus took.
    pub sent: u64,
    /// Valid, new measurements.
    pub received: u64,
    /// Measurements that the counters say are missing, or commands without one.
    pub lost: u64,
    /// Frames whose protection failed.
    pub crc_errors: u64,
    /// Repeated measurements.
    pub repeated: u64,
    /// Measurements out of sequence.
    pub wrong_sequence: u64,
    /// Commands that the bus did not take in time.
    pub late: u64,
}

/// Everything that passed the bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[expect(missing_docs, reason = "documented at the bus")]
pub struct BusCount {
    pub sent: u64,
    pub received: u64,
    pub send_dropped: u64,
    pub receive_dropped: u64,
    pub error_frames: u64,
}

/// One damper slot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DamperSummary {
    /// Its place on the vehicle.
    pub name: String,
    /// `rig` or `modelled`.
    pub place: String,
    /// Force, positive in tension.
    pub force_n: ForceRange,
    /// Stroke from mid-stroke.
    pub stroke_m: Stroke,
    /// Peak of the stroke's power spectral density, above 0.5 Hz.
    pub frequency_psd_peak_hz: Option<f64>,
    /// Half the rate of zero crossings of the stroke.
    pub frequency_zero_crossing_hz: Option<f64>,
    /// Dissipated power (J/s).
    pub work_per_s_j: f64,
    /// On a rig: energy that the vehicle gave less energy that the rig took, over the latter.
    pub exchanged_energy_error: Option<f64>,
    /// Cycles in which nothing new arrived; null without a rig.
    pub stale_cycles: Option<u64>,
    /// Commands that did not fit the frame and were cut to its limits; null without a rig.
    pub saturated_commands: Option<u64>,
    /// Measurements with a flag: limit reached, actuator lagging, saturated; null without a rig.
    pub flagged_measurements: Option<u64>,
    /// Running rms of measured less modelled force at the end (N); null without a watch.
    pub residual_rms_n: Option<f64>,
    /// The same when the usual residual had been learnt (N); null before.
    pub residual_learnt_rms_n: Option<f64>,
    /// Whether the residual was above its limit at the end; null without a watch or before it has
    /// learnt what is usual.
    pub drift: Option<bool>,
    /// Time at which drift was first raised (s); null if never.
    pub drift_since_s: Option<f64>,
}

/// Range of a force (N).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct ForceRange {
    pub min: f64,
    pub max: f64,
    pub rms: f64,
}

/// Size of a stroke (m).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Stroke {
    pub mean_peak: Option<f64>,
    pub rms: f64,
    pub max: f64,
}

/// Accelerations of three bodies; null where the vehicle has none of that name.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Accelerations {
    pub carbody: Option<Acceleration>,
    pub bogie_front: Option<Acceleration>,
    pub wheelset_1: Option<Acceleration>,
}

/// Rms acceleration of a body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Acceleration {
    pub lateral_rms_m_per_s2: f64,
    pub vertical_rms_m_per_s2: f64,
}

/// What the summary needs beside the columns.
#[derive(Debug)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Outcome<'a> {
    pub run: &'a Run,
    pub bus: String,
    pub pace: &'static str,
    pub end: End,
    pub state: &'a SessionState,
    pub ports: &'a [crate::control::Port],
    pub counters: BusCounters,
    pub record_dropped: u64,
    pub wall_s: f64,
    pub bus_load: f64,
    pub watched: [Option<usize>; 3],
}

/// Frequencies below this are track, not damper (Hz).
const LOWEST_PEAK_HZ: f64 = 0.5;

/// Length of a spectrum's segments (s).
pub const SEGMENT_S: f64 = 8.192;

impl Summary {
    /// Sums up a run.
    pub fn of(outcome: &Outcome<'_>, columns: &Columns) -> Self {
        let run = outcome.run;
        let state = outcome.state;
        let first = columns.first_after(run.run_in_s);
        let frames = frames(outcome);
        let clocked = outcome.pace == "realtime";
        let mut dampers = dampers(run, columns, first);
        for (port, memory) in outcome.ports.iter().zip(&state.ports) {
            if let Some(damper) = dampers.get_mut(port.slot) {
                damper.saturated_commands = Some(memory.saturated);
                damper.flagged_measurements = Some(memory.flagged);
            }
        }
        Self {
            format: 1,
            title: run.title.clone(),
            vehicle: run.vehicle_name.clone(),
            notes: run.about.clone(),
            bus: outcome.bus.clone(),
            pace: outcome.pace.to_owned(),
            speed_kmh: run.speed_m_per_s * 3.6,
            steps: state.line.cycle,
            duration_s: state.line.cycle as f64 * CYCLE_S,
            run_in_s: run.run_in_s,
            statistics_s: (columns.time_s.len() - first) as f64 * CYCLE_S,
            wall_s: outcome.wall_s,
            overruns: state.skipped,
            cycle_time_us: percentiles(&columns.cycle_ns),
            step_compute_us: StepPercentiles {
                p50: at(&columns.compute_ns, 0.5),
                p99: at(&columns.compute_ns, 0.99),
                max: at(&columns.compute_ns, 1.0),
            },
            lateness_us: clocked.then(|| percentiles(&columns.lateness_ns)),
            frames,
            bus_counters: BusCount {
                sent: outcome.counters.sent,
                received: outcome.counters.received,
                send_dropped: outcome.counters.send_dropped,
                receive_dropped: outcome.counters.receive_dropped,
                error_frames: outcome.counters.error_frames,
            },
            damper: dampers,
            accelerations: accelerations(outcome.watched, columns, first),
            comparison: None,
            state: match outcome.end {
                End::Completed => "completed",
                End::Stopped => "stopped",
                End::Safe => "safe",
            }
            .to_owned(),
            trajectory_hash: format!("{:016x}", state.hash),
            trajectory_hash_algorithm: hash::ALGORITHM.to_owned(),
            record_dropped: outcome.record_dropped,
            bus_load: outcome.bus_load,
        }
    }
}

/// Every damper slot from the row `first` on.
pub fn dampers(run: &Run, columns: &Columns, first: usize) -> Vec<DamperSummary> {
    let slots = run.slots.iter().enumerate();
    let dampers = slots.map(|(slot, place)| {
        let rig = matches!(place.force, SlotForce::Rig { .. });
        damper(&place.place, rig, slot, first, columns)
    });
    dampers.collect()
}

/// Accelerations of the bodies that were watched, from the row `first` on.
pub fn accelerations(
    watched: [Option<usize>; 3],
    columns: &Columns,
    first: usize,
) -> Accelerations {
    let rms = |index: usize| statistics::rms(&columns.acceleration[index][first..]);
    let body = |index: usize| {
        watched[index].map(|_| Acceleration {
            lateral_rms_m_per_s2: rms(2 * index),
            vertical_rms_m_per_s2: rms(2 * index + 1),
        })
    };
    Accelerations { carbody: body(0), bogie_front: body(1), wheelset_1: body(2) }
}

fn frames(outcome: &Outcome<'_>) -> Frames {
    let mut frames = Frames {
        sent: 0,
        received: 0,
        lost: 0,
        crc_errors: 0,
        repeated: 0,
        wrong_sequence: 0,
        late: outcome.state.late,
    };
    for (port, state) in outcome.ports.iter().zip(&outcome.state.ports) {
        let counts = port.counts(state);
        frames.sent += state.commands;
        frames.received += counts.initial + counts.ok + counts.some_lost;
        frames.crc_errors += counts.wrong_crc;
        frames.repeated += counts.repeated;
        frames.wrong_sequence += counts.wrong_sequence;
        frames.lost += counts.lost_frames;
    }
    frames.sent -= outcome.state.late.min(frames.sent);
    // On its own clock a rig measures more or less often than it is commanded; otherwise every
    // command has its measurement.
    if outcome.pace != "realtime" {
        frames.lost = frames.lost.max(frames.sent.saturating_sub(frames.received));
    }
    frames
}

/// A quantile of a time in nanoseconds, as microseconds.
pub fn at(histogram: &Histogram<u64>, quantile: f64) -> f64 {
    histogram.value_at_quantile(quantile) as f64 * 1e-3
}

fn percentiles(histogram: &Histogram<u64>) -> Percentiles {
    Percentiles {
        p50: at(histogram, 0.5),
        p99: at(histogram, 0.99),
        p99_9: at(histogram, 0.999),
        max: at(histogram, 1.0),
    }
}

fn damper(name: &str, rig: bool, slot: usize, first: usize, columns: &Columns) -> DamperSummary {
    let rate_hz = 1.0 / CYCLE_S;
    let force = &columns.force_n[slot][first..];
    let stroke = &columns.extension_m[slot][first..];
    let rate = &columns.rate_m_per_s[slot][first..];
    let (min, max) = statistics::min_max(force).unwrap_or((0.0, 0.0));
    let duration_s = (force.len() as f64 * CYCLE_S).max(CYCLE_S);
    let work: f64 = force.iter().zip(rate).map(|(force, rate)| force * rate * CYCLE_S).sum();
    // Small wiggles around the middle are no strokes: a hundredth of the rms.
    let dead_band = 0.01 * statistics::rms(stroke);
    let spectrum = Spectrum::welch(stroke, rate_hz, SEGMENT_S).ok();
    let watch = &columns.watch[slot];
    DamperSummary {
        name: name.to_owned(),
        place: if rig { "rig" } else { "modelled" }.to_owned(),
        force_n: ForceRange { min, max, rms: statistics::rms(force) },
        stroke_m: Stroke {
            mean_peak: statistics::mean_peak(stroke, dead_band),
            rms: statistics::rms(stroke),
            max: stroke.iter().fold(0.0, |most: f64, x| most.max(x.abs())),
        },
        frequency_psd_peak_hz: spectrum.and_then(|s| peak_above(&s, LOWEST_PEAK_HZ)),
        frequency_zero_crossing_hz: statistics::zero_crossing_hz(stroke, rate_hz, dead_band),
        work_per_s_j: work / duration_s,
        exchanged_energy_error: rig.then(|| energy_error(slot, first, columns)).flatten(),
        stale_cycles: rig.then_some(columns.stale[slot]),
        saturated_commands: None,
        flagged_measurements: None,
        residual_rms_n: Some(watch.rms_n).filter(|rms| watch.verdict > 0 && rms.is_finite()),
        residual_learnt_rms_n: watch.learnt_rms_n,
        drift: (watch.verdict >= 2).then_some(watch.verdict == 3),
        drift_since_s: watch.drift_since_s,
    }
}

fn peak_above(spectrum: &Spectrum, lowest_hz: f64) -> Option<f64> {
    spectrum
        .lines()
        .filter(|(frequency, density)| *frequency >= lowest_hz && density.is_finite())
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(frequency, _)| frequency)
}

/// What the vehicle gave at its own displacement, against what the rig took at the displacement it
/// measured: the latency of the loop makes or takes energy.
fn energy_error(slot: usize, first: usize, columns: &Columns) -> Option<f64> {
    let along = |force: &[f64], displacement: &[f64]| -> f64 {
        let mean = force.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let moved = displacement.windows(2).map(|pair| pair[1] - pair[0]);
        mean.zip(moved).map(|(force, moved)| force * moved).sum()
    };
    let given = along(&columns.force_n[slot][first..], &columns.extension_m[slot][first..]);
    let taken = along(&columns.measured_n[slot][first..], &columns.measured_m[slot][first..]);
    let error = (given - taken) / taken;
    error.is_finite().then_some(error)
}
