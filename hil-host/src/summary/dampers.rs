//! Force, stroke, work and residual of every damper slot.

use super::stand_ins::StandInSummary;
use super::tracking::TrackingSummary;
use super::wear::WearSummary;
use crate::counts::Counts;
use crate::linear_vehicle::Hunting;
use crate::statistics::{SlotSums, Sums};
use can_protocol::Watch;
use scenario::run::{Run, Slot, SlotForce};
use serde::Serialize;
use signal::spectrum::Spectrum;

/// One damper slot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DamperSummary {
    /// Its place on the vehicle.
    pub name: String,
    /// `rig`, `modelled`, or for which damper the rig of another slot stood: `partner` or
    /// `other_bogie`.
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
    /// Which rig stood for it, and how exactly; null where none did.
    pub stand_in: Option<StandInSummary>,
    /// Time from which it ran on its model, because its rig or the one that stood for it had
    /// dropped out (s); null if never.
    pub model_from_s: Option<f64>,
    /// How its rig follows, and what the delay costs; null without a rig.
    pub tracking: Option<TrackingSummary>,
    /// Cycles in which nothing new arrived; null without a rig.
    pub stale_cycles: Option<u64>,
    /// Commands that did not fit the frame and were cut to its limits; null without a rig.
    pub saturated_commands: Option<u64>,
    /// Measurements with a flag: limit reached, actuator lagging, saturated; null without a rig.
    pub flagged_measurements: Option<u64>,
    /// Commands that the limits in `[motion]` changed; null without a rig.
    pub limited_commands: Option<u64>,
    /// Wear in software before the damper on its rig; null without.
    pub virtual_wear: Option<WearSummary>,
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

/// Every damper slot.
pub(crate) fn dampers(
    run: &Run,
    counts: &Counts,
    sums: &Sums,
    hunting: Option<Hunting>,
) -> Vec<DamperSummary> {
    let slots = run.slots.iter().enumerate();
    let dampers = slots.map(|(slot, place)| {
        let tracking = TrackingSummary::of(&place.force, hunting, &sums.slots[slot], run.cycle_s());
        let stand_in = StandInSummary::of(run, slot, sums, counts.model_from_s[slot]);
        DamperSummary { stand_in, tracking, ..damper(place, slot, counts, (sums, run.cycle_s())) }
    });
    dampers.collect()
}

fn damper(
    place: &Slot,
    slot: usize,
    counts: &Counts,
    (sums, cycle_s): (&Sums, f64),
) -> DamperSummary {
    let rig = matches!(place.force, SlotForce::Rig { .. });
    let duration_s = (sums.rows as f64 * cycle_s).max(cycle_s);
    let sums = &sums.slots[slot];
    let (min, max) = sums.force_range.unwrap_or((0.0, 0.0));
    let spectrum = sums.spectrum.spectrum().ok();
    let watch = &counts.watch[slot];
    DamperSummary {
        name: place.place.clone(),
        place: place.force.name().to_owned(),
        force_n: ForceRange { min, max, rms: sums.force.rms() },
        stroke_m: Stroke {
            mean_peak: sums.mean_peak_m(),
            rms: sums.stroke.rms(),
            max: sums.stroke_max_m,
        },
        frequency_psd_peak_hz: spectrum.and_then(|s| peak_above(&s, LOWEST_PEAK_HZ)),
        frequency_zero_crossing_hz: sums.zero_crossing_hz(),
        work_per_s_j: sums.work_j / duration_s,
        exchanged_energy_error: rig.then(|| energy_error(sums)).flatten(),
        stand_in: None,
        model_from_s: counts.model_from_s[slot],
        tracking: None,
        stale_cycles: rig.then_some(counts.stale[slot]),
        saturated_commands: None,
        flagged_measurements: None,
        limited_commands: None,
        virtual_wear: None,
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
fn energy_error(sums: &SlotSums) -> Option<f64> {
    let (given, taken) = (sums.given.sum(), sums.taken.sum());
    let error = (given - taken) / taken;
    error.is_finite().then_some(error)
}
