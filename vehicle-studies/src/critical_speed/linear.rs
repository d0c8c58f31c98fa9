//! From which speed on does a small motion grow, with the dampers as they are at one stroke?
//!
//! Eigenvalues about steady running ([`crate::modes`]) with every damper as stiffness and damping
//! of one stroke and of the frequency of the mode that is asked for
//! (`describing_function`); the frequency is that of the least damped mode, found by
//! repetition. At zero stroke a clearance would mean that there is no damper: a stroke has to be
//! given. A damper behind a rig is turned by the delay of its force.

use super::bracket::{Critical, first_unstable};
use super::procedure::Procedure;
use crate::describing_function::impedance;
use crate::error::StudyError;
use crate::modes::{Coordinate, Impedances, Jacobians};
use crate::trip::Equipped;
use firmware_core::vehicle::VehicleState;
use nalgebra::Complex;
use rayon::prelude::*;
use scenario::equilibrium;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Strokes of the default table, half the travel (m).
pub const STROKES_M: [f64; 4] = [0.5e-3, 1e-3, 2e-3, 3.5e-3];
/// Frequency with which the repetition begins (Hz).
const FIRST_HZ: f64 = 3.0;
/// Modes that are asked for lie between these (Hz).
const MODES_HZ: [f64; 2] = [0.3, 15.0];
/// Most repetitions.
const REPETITIONS: usize = 12;
/// Distance between the speeds of the root locus (km/h).
const LOCUS_STEP_KMH: f64 = 20.0;
/// How closely the frequency is met (Hz).
const CLOSE_HZ: f64 = 1e-3;

/// The least damped mode.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Mode {
    /// Growth rate (1/s), negative for a motion that fades.
    pub growth_per_s: f64,
    /// Frequency (Hz).
    pub frequency_hz: f64,
}

/// The modes at a speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AtSpeed {
    /// Speed (km/h).
    pub kmh: f64,
    /// The modes in the range of hunting, the least damped first; none where there is no steady
    /// running.
    pub modes: Vec<Mode>,
}

/// The linear critical speed at one stroke of the dampers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LinearSpeed {
    /// Stroke of the dampers, half the travel (m); zero for a vehicle without dampers.
    pub stroke_m: f64,
    /// Where the least damped mode begins to grow.
    pub critical: Critical,
    /// Its frequency there (Hz).
    pub frequency_hz: Option<f64>,
    /// The modes over the whole range of speeds: the root locus.
    pub locus: Vec<AtSpeed>,
}

impl LinearSpeed {
    /// At each of some strokes (m, positive); once for a vehicle without dampers, to which a stroke
    /// means nothing.
    ///
    /// # Errors
    /// The work is stopped.
    pub fn at_strokes(
        equipped: &Equipped<'_>,
        procedure: &Procedure,
        strokes_m: &[f64],
    ) -> Result<Vec<Self>, StudyError> {
        let none = equipped.dampers.is_empty() && !strokes_m.is_empty();
        let strokes_m = if none { &[0.0] } else { strokes_m };
        strokes_m.iter().map(|stroke_m| Self::of(equipped, procedure, *stroke_m)).collect()
    }

    /// The stroke in words.
    pub(super) fn stroke_in_words(&self) -> String {
        if self.stroke_m == 0.0 {
            return "no dampers".to_owned();
        }
        format!("stroke {} mm", 1e3 * self.stroke_m)
    }

    /// At one stroke (m, positive).
    ///
    /// # Errors
    /// The work is stopped.
    pub fn of(
        equipped: &Equipped<'_>,
        procedure: &Procedure,
        stroke_m: f64,
    ) -> Result<Self, StudyError> {
        debug_assert!(stroke_m > 0.0 || equipped.dampers.is_empty(), "no stroke");
        let Procedure { from_kmh, to_kmh, step_kmh, resolution_kmh, .. } = *procedure;
        let mut growing = None;
        let climb = [from_kmh, to_kmh];
        let critical = first_unstable(climb, 2.0 * step_kmh, resolution_kmh, |kmh| {
            equipped.check_stop()?;
            let mode = least_damped(equipped, kmh / 3.6, stroke_m);
            let grows = mode.filter(|mode| mode.growth_per_s > 0.0);
            // The last one found is that of the speed that is reported.
            growing = grows.or(growing);
            Ok::<_, StudyError>(grows.is_some())
        })?;
        let mode = critical.kmh().and(growing);
        let steps = ((to_kmh - from_kmh) / LOCUS_STEP_KMH + 1e-9) as usize;
        let speeds: Vec<f64> =
            (0..=steps).map(|step| from_kmh + step as f64 * LOCUS_STEP_KMH).collect();
        let at = |kmh: &f64| -> Result<AtSpeed, StudyError> {
            equipped.check_stop()?;
            let modes = modes_at(equipped, kmh / 3.6, stroke_m).unwrap_or_default();
            Ok(AtSpeed { kmh: *kmh, modes })
        };
        let locus: Result<Vec<AtSpeed>, StudyError> = speeds.par_iter().map(at).collect();
        let frequency_hz = mode.map(|mode| mode.frequency_hz);
        Ok(Self { stroke_m, critical, frequency_hz, locus: locus? })
    }
}

/// The least damped mode at a speed, the dampers at a stroke; none where there is no steady
/// running.
fn least_damped(equipped: &Equipped<'_>, speed_m_per_s: f64, stroke_m: f64) -> Option<Mode> {
    modes_at(equipped, speed_m_per_s, stroke_m)?.first().copied()
}

/// The modes at a speed, the dampers at a stroke and the frequency of the least damped one.
fn modes_at(equipped: &Equipped<'_>, speed_m_per_s: f64, stroke_m: f64) -> Option<Vec<Mode>> {
    let steady = equilibrium::running(&equipped.vehicle, equipped.table(), speed_m_per_s).ok()?;
    let mut frequency_hz = FIRST_HZ;
    let mut found = Vec::new();
    for _ in 0..REPETITIONS {
        let about = (&steady.state, speed_m_per_s);
        found = modes(equipped, about, stroke_m, frequency_hz)?;
        let mode = *found.first()?;
        if (mode.frequency_hz - frequency_hz).abs() < CLOSE_HZ {
            break;
        }
        frequency_hz = mode.frequency_hz;
    }
    Some(found)
}

/// All modes in the range of hunting, the least damped first, with the dampers at a stroke and a
/// frequency.
fn modes(
    equipped: &Equipped<'_>,
    about: (&VehicleState, f64),
    stroke_m: f64,
    frequency_hz: f64,
) -> Option<Vec<Mode>> {
    let mut dampers = Impedances::default();
    for (number, (slot, damper)) in dampers.0.iter_mut().zip(&equipped.dampers).enumerate() {
        let own = impedance(damper, stroke_m, frequency_hz);
        *slot = match &equipped.rigs {
            Some(rigs) if rigs.has(number) => own.late_by(rigs.delay_s(), frequency_hz),
            _ => own,
        };
    }
    let jacobians = Jacobians::about(
        &equipped.vehicle,
        equipped.table(),
        about,
        dampers,
        &Coordinate::all(&equipped.vehicle),
    );
    let mode = |value: &Complex<f64>| Mode { growth_per_s: value.re, frequency_hz: value.im / TAU };
    let [low, high] = MODES_HZ;
    let in_range = |mode: &Mode| (low..high).contains(&mode.frequency_hz);
    Some(jacobians.eigenvalues()?.iter().map(mode).filter(in_range).collect())
}
