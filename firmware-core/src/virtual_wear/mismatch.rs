//! What the damper on a rig differs from its model.
//!
//! The model is driven by the measured displacement, so an error of the ram is none of it. The
//! difference of the forces of one instant is low-passed: a damper differs slowly, a load cell is
//! noisy, and the noise would shake the ram by `noise / stiffness` in every cycle.

use super::Reading;
use crate::damper::{Damper, DamperState, Motion};
use core::f64::consts::TAU;

/// Cut-off of the difference (Hz): well above hunting, well below the loop.
const CUT_OFF_HZ: f64 = 25.0;
/// Time constant with which the scale forgets (s): three periods of hunting.
const FORGETTING_S: f64 = 1.0;
/// Force below which nothing is learned of the scale (N).
const FORCE_FLOOR_N: f64 = 200.0;
/// Most that the scale is off from one.
const SHARE_MAX: f64 = 0.5;
/// Most readings in a row that may be missing; after more the model begins anew.
const GAP_MAX: u32 = 100;

/// The model that follows the rig, and what the force differs from its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mismatch {
    measured: Option<DamperState>,
    missing: u32,
    scale: Scale,
    force_n: f64,
    squares: Squares,
}

impl Mismatch {
    /// Nothing has happened yet.
    pub(super) const NEW: Self = Self {
        measured: None,
        missing: 0,
        scale: Scale { product: 0.0, square: 0.0 },
        force_n: 0.0,
        squares: Squares { difference: 0.0, model: 0.0, readings: 0 },
    };
}

/// Sums over the readings since they were cleared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Squares {
    difference: f64,
    model: f64,
    readings: u32,
}

/// A measured force beside that of the model on the same motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Compared {
    /// Force of the model (N).
    pub(super) model_n: f64,
    /// What makes it the measured one.
    pub(super) correction: Correction,
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
    /// Takes what has arrived since the last cycle; nothing where nothing has.
    pub(super) fn take(
        &mut self,
        specimen: &Damper,
        reading: Option<Reading>,
        cycle_s: f64,
    ) -> Option<Compared> {
        let Some(Reading { displacement_m, force_n }) = reading.filter(Reading::is_finite) else {
            self.missing = self.missing.saturating_add(1);
            return None;
        };
        let motion = Motion::new(displacement_m, 0.0);
        let known = self.measured.filter(|_| self.missing <= GAP_MAX);
        let mut model = known.unwrap_or(DamperState::starting(motion));
        let since_s = f64::from(self.missing + 1) * cycle_s;
        self.missing = 0;
        let model_n = specimen.advance(&mut model, motion, since_s);
        self.measured = Some(model);
        let difference_n = force_n - model_n;
        self.squares.difference += difference_n * difference_n;
        self.squares.model += model_n * model_n;
        self.squares.readings = self.squares.readings.saturating_add(1);
        self.scale.take(model_n, difference_n, since_s);
        let difference_n = difference_n - self.scale.share() * model_n;
        let angle = TAU * CUT_OFF_HZ * since_s;
        self.force_n += angle / (1.0 + angle) * (difference_n - self.force_n);
        let correction = Correction { scale: 1.0 + self.scale.share(), difference_n };
        Some(Compared { model_n, correction })
    }

    /// As far as it is known.
    pub(super) fn correction(&self) -> Correction {
        Correction { scale: 1.0 + self.scale.share(), difference_n: self.force_n }
    }

    /// Measured less modelled force and the modelled one, rms since [`Mismatch::clear`] (N); none
    /// before the first reading.
    pub(super) fn sizes_n(&self) -> Option<(f64, f64)> {
        let Squares { difference, model, readings } = self.squares;
        let rms = |squares: f64| crate::sqrt::sqrt(squares / f64::from(readings));
        (readings > 0).then(|| (rms(difference), rms(model)))
    }

    /// Begins the sums anew.
    pub(super) fn clear(&mut self) {
        self.squares = Squares::default();
    }
}
