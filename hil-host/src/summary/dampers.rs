//! Force, stroke, work and residual of every damper slot.

use crate::columns::Columns;
use can_protocol::Watch;
use scenario::run::{CYCLE_S, Run, SlotForce};
use serde::Serialize;
use signal::spectrum::Spectrum;
use signal::statistics;

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
    /// Commands that the limits in `[motion]` changed; null without a rig.
    pub limited_commands: Option<u64>,
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

/// Frequencies below this are track, not damper (Hz).
const LOWEST_PEAK_HZ: f64 = 0.5;

/// Length of a spectrum's segments (s).
pub(crate) const SEGMENT_S: f64 = 8.192;

/// Every damper slot from the row `first` on.
pub(crate) fn dampers(run: &Run, columns: &Columns, first: usize) -> Vec<DamperSummary> {
    let slots = run.slots.iter().enumerate();
    let dampers = slots.map(|(slot, place)| {
        let rig = matches!(place.force, SlotForce::Rig { .. });
        damper(&place.place, rig, slot, first, columns)
    });
    dampers.collect()
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
        limited_commands: None,
        residual_rms_n: watch.last_rms_n(),
        residual_learnt_rms_n: watch.learnt_rms_n,
        drift: match watch.verdict {
            Watch::None | Watch::Learning => None,
            Watch::Steady => Some(false),
            Watch::Drift => Some(true),
        },
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
