//! Below which speed does no hunting stay, however it began?
//!
//! The vehicle is set swinging at the highest speed by a burst of sinusoidal alignment, several
//! wavelengths of which are tried; the largest motion that stays is followed downward, a few
//! seconds at each speed, from the state that the one before has left, until it dies. The last step
//! is halved. No seed and no track enter: with a clear limit cycle this is its saddle-node, the
//! lower end of the range of speeds at which quiet running and hunting exist side by side.
//!
//! Just below its end a motion dies slowly, and the time at each speed may not see it: a tenth of a
//! km/h for Cooperrider's bogie. A cycle that the burst does not reach is not found; the answer
//! then is that of the cycle that was.

use super::bracket::Critical;
use super::hunting::{Hunting, after};
use super::procedure::Procedure;
use crate::error::StudyError;
use crate::trip::{Equipped, Trip, TripState};
use firmware_core::track::{Irregularity, IrregularitySample, Layout, Track};
use rayon::prelude::*;
use scenario::equilibrium::NoEquilibrium;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Frequencies with which the burst shakes the vehicle (Hz).
const BURST_HZ: [f64; 5] = [1.5, 2.2, 2.8, 3.4, 4.2];
/// Its amplitude (m).
const BURST_M: f64 = 8e-3;
/// Its length (cycles).
const BURST_CYCLES: f64 = 8.0;
/// Where it begins (m).
const BURST_FROM_M: f64 = 40.0;
/// Distance between samples of it (m).
const SAMPLE_M: f64 = 0.1;

/// A hunting motion at a speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CyclePoint {
    /// Speed (km/h).
    pub kmh: f64,
    /// The motion.
    pub motion: Hunting,
}

/// A limit cycle followed downward.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fold {
    /// Where it dies.
    pub dies: Critical,
    /// The motion on the way, from the highest speed down; the last is the last that stayed.
    pub cycle: Vec<CyclePoint>,
}

impl Fold {
    /// Follows the largest motion that stays at the highest speed.
    ///
    /// # Errors
    /// The vehicle does not run steadily at the highest speed, or the work is stopped.
    pub fn of(equipped: &Equipped<'_>, procedure: &Procedure) -> Result<Self, StudyError> {
        let Procedure { from_kmh, to_kmh, resolution_kmh, alive_m, .. } = *procedure;
        let alive = |motion: &Hunting| motion.amplitude_m.is_some_and(|m| m > alive_m);
        let (motion, mut state) = swinging(equipped, procedure)?;
        let mut cycle = vec![CyclePoint { kmh: to_kmh, motion }];
        if !alive(&motion) {
            return Ok(Self { dies: Critical::Above(to_kmh), cycle: Vec::new() });
        }
        let (mut at, mut step) = (to_kmh, procedure.step_kmh);
        loop {
            let next = (at - step).max(from_kmh);
            debug_assert!(next < at, "{next} and {at} km/h");
            let mut tried = state.clone();
            let motion = held(equipped, procedure, next, &mut tried)?;
            if alive(&motion) {
                cycle.push(CyclePoint { kmh: next, motion });
                (at, state) = (next, tried);
                if at <= from_kmh {
                    return Ok(Self { dies: Critical::Below(from_kmh), cycle });
                }
            } else if step > resolution_kmh {
                step *= 0.5;
            } else {
                return Ok(Self { dies: Critical::At(at), cycle });
            }
        }
    }
}

/// Holds a speed on perfect track.
fn held(
    equipped: &Equipped<'_>,
    procedure: &Procedure,
    kmh: f64,
    state: &mut TripState,
) -> Result<Hunting, StudyError> {
    let track = Track::default();
    let trip = Trip::new(equipped, &track, kmh / 3.6, procedure.substeps);
    after(&trip, state, [procedure.hold_s, procedure.watched_s])
}

/// The largest motion that remains after a burst at the highest speed, and its state.
fn swinging(
    equipped: &Equipped<'_>,
    procedure: &Procedure,
) -> Result<(Hunting, TripState), StudyError> {
    let speed_m_per_s = procedure.to_kmh / 3.6;
    let shaken: Result<Vec<(Hunting, TripState)>, StudyError> = BURST_HZ
        .par_iter()
        .map(|burst_hz| {
            let samples = burst(speed_m_per_s / burst_hz, BURST_M);
            let track = burst_track(&samples);
            let trip = Trip::new(equipped, &track, speed_m_per_s, procedure.substeps);
            let mut state = trip.begin(&[])?;
            let times = [burst_s(*burst_hz, speed_m_per_s) + procedure.hold_s, procedure.watched_s];
            Ok((after(&trip, &mut state, times)?, state))
        })
        .collect();
    let mut shaken = shaken?;
    // What has left the track has no cycle.
    let size = |motion: &Hunting| motion.amplitude_m.unwrap_or(-1.0);
    shaken.sort_by(|a, b| size(&b.0).total_cmp(&size(&a.0)));
    // One for every frequency of the burst.
    debug_assert_eq!(shaken.len(), BURST_HZ.len());
    let none = NoEquilibrium { residual_m_per_s2: f64::NAN };
    shaken.into_iter().next().ok_or_else(|| none.into())
}

/// Time until a burst of a frequency (Hz) is passed at a speed (m/s).
pub(crate) fn burst_s(burst_hz: f64, speed_m_per_s: f64) -> f64 {
    BURST_CYCLES / burst_hz + BURST_FROM_M / speed_m_per_s
}

/// The track of a burst, perfect behind it.
pub(crate) fn burst_track(samples: &[IrregularitySample]) -> Track<'_> {
    Track {
        layout: Layout::tangent(),
        irregularity: Irregularity { samples, step_m: SAMPLE_M, ..Irregularity::default() },
    }
}

/// A sine of alignment of an amplitude (m) that grows and fades over its length.
pub(crate) fn burst(wavelength_m: f64, amplitude_m: f64) -> Vec<IrregularitySample> {
    let length_m = BURST_CYCLES * wavelength_m;
    let count = ((BURST_FROM_M + length_m) / SAMPLE_M) as usize;
    let samples = (0..count).map(|index| {
        let along_m = index as f64 * SAMPLE_M - BURST_FROM_M;
        let envelope = libm::sin(0.5 * TAU * (along_m / length_m).clamp(0.0, 1.0));
        let alignment_m = amplitude_m * envelope * libm::sin(TAU * along_m / wavelength_m);
        IrregularitySample { alignment_m, ..IrregularitySample::default() }
    });
    samples.collect()
}
