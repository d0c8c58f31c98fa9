//! Where wear in software stands for wear in the joint: a map, on emulated rigs.
//!
//! ```text
//! force error   rms(F_software - F_worn) / rms(F_new)
//! work error    (W_software - W_worn) / W_new        over whole cycles of a sine
//! ```
//! `software` is a healthy damper on a rig, behind [`firmware_core::virtual_wear`]. `worn` has the
//! wear in its joint and moves with the vehicle itself, as on a rig that is late by nothing; `new`
//! is the healthy damper there. The host knows a model of the healthy damper; what is mounted may
//! differ from it. A cell holds where the force is within [`FORCE_SHARE`] of the healthy
//! damper's, and the work within [`WORK_SHARE`] of its work. The work is also given over the worn
//! damper's own, which may be little: at 3 MN/m a stroke of 4 mm is spring nearly alone.
//!
//! Beside it stands the same difference from a worn damper on the very rig, behind the same
//! compensator. What the rig does to any damper is in both forces then and cancels.
//!
//! Limits: emulated rigs, one sine. The vehicle is not coupled.

mod cell;
mod page;
mod specimen;
#[cfg(test)]
mod tests;
mod text;

use crate::BenchError;
use cell::{Bench, Driven};
use firmware_core::compensation::{Compensator, Feedforward};
use firmware_core::damper::Damper;
use firmware_core::virtual_wear::WearFound;
use rayon::prelude::*;
use scenario::rig::{DELAY_CYCLES_MAX, Drive, RigSetup};
use scenario::run::{CYCLE_S, Run, SlotForce};
use serde::Serialize;
use specimen::{Specimen, specimens};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Most error of the work per cycle, over that of the healthy damper.
const WORK_SHARE: f64 = 0.05;
/// Most error of the force, over that of the healthy damper; a run leaves some room to it.
const FORCE_SHARE: f64 = 0.03;
/// Order of the compensators of ideal rigs.
const ORDER: u8 = 2;

/// The motion between the eyes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sine {
    /// Half of the travel (m).
    pub stroke_m: f64,
    /// Frequency (Hz).
    pub frequency_hz: f64,
}

/// What a map covers.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// The motion.
    pub sine: Sine,
    /// Clearances in software (m).
    pub clearances_m: Vec<f64>,
    /// Stiffnesses of the worn damper (N/m), not above that of the healthy one.
    pub stiffnesses_n_per_m: Vec<f64>,
    /// Delays of ideal rigs (s).
    pub delays_s: Vec<f64>,
    /// Their least lags (s), a part of the delay: a bandwidth of 1 / (2 pi lag). Whole cycles make
    /// the rest of the delay.
    pub lags_s: Vec<f64>,
}

/// One cell of a map.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cell {
    /// The rig.
    pub rig: String,
    /// What is mounted, against the model that the host has.
    pub specimen: &'static str,
    /// Clearance in software (mm).
    pub clearance_2a_mm: f64,
    /// Stiffness of the worn damper (MN/m).
    pub ke_mn_per_m: f64,
    /// Error of the force (%).
    pub force_error_percent: f64,
    /// The same against a worn damper on the same rig (%).
    pub on_rig_force_error_percent: f64,
    /// Error of the work over that of the healthy damper (%).
    pub work_error_percent: f64,
    /// The same against a worn damper on the same rig (%).
    pub on_rig_work_error_percent: f64,
    /// Error of the work over the worn damper's own (%).
    pub own_work_error_percent: f64,
    /// Rms of the force that the model lacks, over its own (%).
    pub mismatch_percent: Option<f64>,
    /// Gain of the loop over the mismatch.
    pub loop_gain: Option<f64>,
    /// Error of the force that a run expects from the mismatch (%).
    pub expected_error_percent: Option<f64>,
    /// Travel in which a contact is rounded (mm).
    pub rounding_mm: f64,
    /// Commands that the limits of `[motion]` changed (%).
    pub limited_percent: f64,
    /// Whether a run would accept the loop.
    pub is_accepted: bool,
    /// Whether both errors are within their limits.
    pub holds: bool,
}

/// A map.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WearMap {
    /// Version of this format.
    pub format: u32,
    /// What the rigs are: `emulated rig`.
    pub rigs: &'static str,
    /// The motion.
    pub sine: Sine,
    /// Most error of the force (%).
    pub most_force_error_percent: f64,
    /// Most error of the work (%).
    pub most_work_error_percent: f64,
    /// The cells.
    pub cells: Vec<Cell>,
}

/// A rig of the map.
#[derive(Debug, Clone)]
struct Rig {
    name: String,
    setup: RigSetup,
    compensator: Compensator,
}

/// Computes a map for the first damper of a scenario that is on a rig; none where `stop` was set.
///
/// # Errors
/// No damper is on a rig, or its model takes no wear.
pub fn wear_map(
    run: &Run,
    question: &Question,
    stop: &AtomicBool,
    done: &(dyn Fn(usize, usize) + Sync),
) -> Result<Option<WearMap>, BenchError> {
    let on_rig = run.slots.iter().find_map(|slot| match &slot.force {
        SlotForce::Rig { specimen, compensator, .. } => Some((&**specimen, *compensator)),
        SlotForce::Modelled(_) | SlotForce::StandIn { .. } => None,
    });
    let Some((model, compensator)) = on_rig else {
        return Err(BenchError::NoRig { title: run.title.clone() });
    };
    let rigs = rigs(run, question, compensator);
    let specimens = specimens(model).map_err(BenchError::Damper)?;
    let pairs: Vec<(&Rig, &Specimen)> =
        rigs.iter().flat_map(|rig| specimens.iter().map(move |specimen| (rig, specimen))).collect();
    let counted = AtomicUsize::new(0);
    let of_pair = |(rig, specimen): &(&Rig, &Specimen)| {
        let cells = cells(run, question, (rig, specimen), model, stop);
        done(counted.fetch_add(1, Ordering::Relaxed) + 1, pairs.len());
        cells
    };
    let found: Vec<Vec<Cell>> = pairs.par_iter().map(of_pair).collect::<Result<_, _>>()?;
    Ok((!stop.load(Ordering::Relaxed)).then(|| WearMap {
        format: 1,
        rigs: "emulated rig",
        sine: question.sine,
        most_force_error_percent: 100.0 * FORCE_SHARE,
        most_work_error_percent: 100.0 * WORK_SHARE,
        cells: found.into_iter().flatten().collect(),
    }))
}

/// Ideal rigs of every delay and lag, and the scenario's own where it is none of these.
fn rigs(run: &Run, question: &Question, compensator: Compensator) -> Vec<Rig> {
    let mut rigs: Vec<Rig> = Vec::new();
    for delay_s in &question.delays_s {
        for lag_s in &question.lags_s {
            // Counts are whole within the rounding of a decimal.
            let cycles = libm::floor((delay_s - lag_s) / CYCLE_S + 1e-6);
            if cycles < 0.0 {
                continue;
            }
            let delay_cycles = (cycles as u16).min(DELAY_CYCLES_MAX);
            let lag_s = delay_s - f64::from(delay_cycles) * CYCLE_S;
            let name = format!("{:.1} ms late, lag {:.1} ms", 1e3 * delay_s, 1e3 * lag_s);
            if rigs.iter().any(|rig| rig.name == name) {
                continue;
            }
            rigs.push(Rig {
                name,
                setup: RigSetup { drive: Drive::Ideal, lag_s, delay_cycles, ..run.rig.clone() },
                compensator: Compensator::Feedforward(Feedforward::polynomial(ORDER, *delay_s)),
            });
        }
    }
    rigs.push(Rig { name: run.rig.name.clone(), setup: run.rig.clone(), compensator });
    rigs
}

/// The cells of one damper on one rig.
fn cells(
    run: &Run,
    question: &Question,
    (rig, specimen): (&Rig, &Specimen),
    model: &Damper,
    stop: &AtomicBool,
) -> Result<Vec<Cell>, BenchError> {
    let bench = Bench {
        rig: rig.setup.clone(),
        specimen: specimen.damper.clone(),
        model: model.clone(),
        compensator: rig.compensator,
        limits: crate::run::limits(run),
    };
    let Question { sine, clearances_m, stiffnesses_n_per_m, .. } = question;
    let healthy = bench.without_rig((0.0, 0.0), *sine).map_err(BenchError::Damper)?;
    let mut cells = Vec::new();
    for ke_n_per_m in stiffnesses_n_per_m {
        for clearance_2a_m in clearances_m {
            if stop.load(Ordering::Relaxed) {
                return Ok(cells);
            }
            let compliance_m_per_n = (1.0 / ke_n_per_m - 1.0 / model.nominal().ke_n_per_m).max(0.0);
            let wear = (*clearance_2a_m, compliance_m_per_n);
            let worn = bench.without_rig(wear, *sine).map_err(BenchError::Damper)?;
            let on_rig = bench.in_joint(wear, *sine).map_err(BenchError::Damper)?;
            let software = bench.in_software(wear, *sine);
            let [force, work, own_work] = errors(&healthy, &worn, &software);
            let [on_rig_force, on_rig_work, _] = errors(&healthy, &on_rig, &software);
            let percent =
                |of: fn(&WearFound) -> f64| software.found.map(|found| 100.0 * of(&found));
            cells.push(Cell {
                rig: rig.name.clone(),
                specimen: specimen.name,
                clearance_2a_mm: 1e3 * clearance_2a_m,
                ke_mn_per_m: 1e-6 * ke_n_per_m,
                force_error_percent: 100.0 * force,
                on_rig_force_error_percent: 100.0 * on_rig_force,
                work_error_percent: 100.0 * work,
                on_rig_work_error_percent: 100.0 * on_rig_work,
                own_work_error_percent: 100.0 * own_work,
                mismatch_percent: percent(|found| found.mismatch),
                loop_gain: software.found.map(|found| found.loop_gain),
                expected_error_percent: percent(|found| found.force_error),
                rounding_mm: 1e3 * bench.rounding_m(wear, *sine),
                limited_percent: 100.0 * software.limited_share(),
                is_accepted: software.found.is_none_or(|found| found.is_accepted()),
                holds: force <= FORCE_SHARE && work.abs() <= WORK_SHARE,
            });
        }
    }
    Ok(cells)
}

/// Errors of force and work over the healthy damper's, and of the work over the worn damper's own.
fn errors(healthy: &Driven, worn: &Driven, software: &Driven) -> [f64; 3] {
    let force = software.differs_n(worn) / healthy.rms_n();
    let work_j = software.work_j - worn.work_j;
    [force, work_j / healthy.work_j, work_j / worn.work_j]
}
