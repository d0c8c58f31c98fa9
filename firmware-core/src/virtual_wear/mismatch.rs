//! What the damper on a rig differs from its model.
//!
//! The model is driven by the measured displacement, so an error of the ram is none of it. The
//! difference of the forces of one instant is low-passed: a damper differs slowly, a load cell is
//! noisy, and the noise would shake the ram by `noise / stiffness` in every cycle.

use super::rounding::MOST_ROUNDING_CYCLES;
use super::{MOST_AHEAD_CYCLES, Reading};
use crate::damper::{Damper, DamperState, Motion};
use crate::ring::Ring;
use core::f64::consts::TAU;

/// Cut-off of the difference (Hz): well above hunting, well below the loop.
const CUT_OFF_HZ: f64 = 25.0;
/// Cycles that a motion is computed ahead at most, its rounding included, and two more.
const KEPT: usize = MOST_AHEAD_CYCLES as usize + MOST_ROUNDING_CYCLES as usize + 2;
/// Time constant with which the scale forgets (s): three periods of hunting.
const FORGETTING_S: f64 = 1.0;
/// Force below which nothing is learned of the scale (N).
const FORCE_FLOOR_N: f64 = 200.0;
/// Most that the scale is off from one.
const SHARE_MAX: f64 = 0.5;
/// Most readings in a row that may be missing; after more the model begins anew.
const GAP_MAX: u32 = 100;

/// The model that follows the rig, and what the force differs from its own.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Mismatch {
    measured: Option<DamperState>,
    /// Force of the model in the last reading, in the cycle in which it has arrived (N).
    arrived_n: Option<f64>,
    missing: u32,
    scale: Scale,
    force_n: f64,
    /// The low-passed difference of the last cycles.
    kept_n: Kept,
    squares: Squares,
}

/// Sums over the readings since they were cleared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Squares {
    difference: f64,
    missed: f64,
    strayed: f64,
    model: f64,
    readings: u32,
}

/// Forces, all rms (N).
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::struct_field_names, reason = "their unit is the end of their names")]
pub(super) struct Sizes {
    /// Measured less modelled.
    pub(super) difference_n: f64,
    /// What the difference was off from the one that was foreseen.
    pub(super) missed_n: f64,
    /// What the ram strayed from the wanted motion, as a force of the model.
    pub(super) strayed_n: f64,
    /// Of the model.
    pub(super) model_n: f64,
}

/// Forces of the last cycles (N).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Kept(Ring<f64, KEPT>);

impl Kept {
    pub(super) fn keep(&mut self, force_n: f64) {
        self.0.keep(force_n);
    }

    pub(super) fn ago_n(&self, cycles: u8) -> f64 {
        debug_assert!(usize::from(cycles) < KEPT, "{cycles} cycles ago");
        self.0.ago(usize::from(cycles)).unwrap_or(0.0)
    }
}

/// What the model's force needs to be that of the damper on the rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Correction {
    scale: f64,
    difference_n: f64,
}

impl Correction {
    /// The force of the damper on the rig where its model has another one (N).
    pub(super) fn of(&self, model_n: f64) -> f64 {
        self.scale * model_n + self.difference_n
    }
}

/// How much larger the force is than the model's, by least squares with forgetting.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Scale {
    product: f64,
    square: f64,
}

impl Scale {
    fn take(&mut self, model_n: f64, difference_n: f64, since_s: f64) {
        let kept = FORGETTING_S / (FORGETTING_S + since_s);
        self.product = kept * (self.product + model_n * difference_n * since_s);
        self.square = kept * (self.square + model_n * model_n * since_s);
    }

    /// The share by which it is larger.
    fn share(&self) -> f64 {
        let held = FORCE_FLOOR_N * FORCE_FLOOR_N * FORGETTING_S;
        (self.product / (self.square + held)).clamp(-SHARE_MAX, SHARE_MAX)
    }
}

impl Mismatch {
    /// Takes what has arrived since the last cycle, of a motion computed so many cycles ahead.
    pub(super) fn take(
        &mut self,
        specimen: &Damper,
        reading: Option<Reading>,
        ahead_cycles: u8,
        cycle_s: f64,
    ) {
        self.kept_n.keep(self.force_n);
        self.arrived_n = None;
        let Some(Reading { displacement_m, force_n }) = reading.filter(Reading::is_finite) else {
            self.missing = self.missing.saturating_add(1);
            return;
        };
        let motion = Motion::new(displacement_m, 0.0);
        let known = self.measured.filter(|_| self.missing <= GAP_MAX);
        let mut model = known.unwrap_or(DamperState::starting(motion));
        let since_s = f64::from(self.missing + 1) * cycle_s;
        self.missing = 0;
        let model_n = specimen.advance(&mut model, motion, since_s);
        self.measured = Some(model);
        self.arrived_n = Some(model_n);
        let difference_n = force_n - model_n;
        self.squares.difference += difference_n * difference_n;
        self.squares.model += model_n * model_n;
        self.scale.take(model_n, difference_n, since_s);
        let difference_n = difference_n - self.scale.share() * model_n;
        let missed_n = difference_n - self.kept_n.ago_n(ahead_cycles);
        self.squares.missed += missed_n * missed_n;
        self.squares.readings = self.squares.readings.saturating_add(1);
        let angle = TAU * CUT_OFF_HZ * since_s;
        self.force_n += angle / (1.0 + angle) * (difference_n - self.force_n);
    }

    /// As far as it is known.
    pub(super) fn correction(&self) -> Correction {
        Correction { scale: 1.0 + self.scale.share(), difference_n: self.force_n }
    }

    /// Takes the force that was foreseen for the motion of this cycle: what the model says of the
    /// measured motion differs from it where the ram does not follow.
    pub(super) fn stray(&mut self, foreseen_n: f64) {
        if let Some(model_n) = self.arrived_n {
            let strayed_n = model_n - foreseen_n;
            self.squares.strayed += strayed_n * strayed_n;
        }
    }

    /// Sizes since [`Mismatch::clear`]; none before the first reading.
    pub(super) fn sizes(&self) -> Option<Sizes> {
        let Squares { difference, missed, strayed, model, readings } = self.squares;
        let rms = |squares: f64| crate::sqrt::sqrt(squares / f64::from(readings));
        (readings > 0).then(|| Sizes {
            difference_n: rms(difference),
            missed_n: rms(missed),
            strayed_n: rms(strayed),
            model_n: rms(model),
        })
    }

    /// Begins the sums anew.
    pub(super) fn clear(&mut self) {
        self.squares = Squares::default();
    }
}
