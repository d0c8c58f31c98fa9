//! What a worn damper would do, beside what the rig does.
//!
//! The same joint before the same model, but at the instant that a measurement tells of: on the
//! vehicle's own motion instead of one that was extrapolated, without rounded contacts, and with
//! the difference that was measured then. So what the force is off,
//!
//! ```text
//! e = (1 + q) (M[x_measured] - M[w_reference])
//! ```
//!
//! holds all that a delay costs: the error of the extrapolation, contacts that were foreseen too
//! early or too late, a correction that came late, and a ram that strays. Noise of the load cell is
//! on both sides and cancels.
//!
//! Limits: the difference is that of the measured motion, not of the reference's.

use super::VirtualWear;
use super::mismatch::{Compared, Correction};
use crate::damper::DamperState;

/// The worn damper under the vehicle's own motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reference {
    damper: DamperState,
    last_m: Option<f64>,
    squares: f64,
    readings: u32,
}

impl Reference {
    /// Nothing has happened yet.
    pub(super) const NEW: Self =
        Self { damper: DamperState::NEW, last_m: None, squares: 0.0, readings: 0 };

    /// Takes the vehicle's displacement (m) of a cycle, and what has arrived in it; `known` is what
    /// the model needs without that.
    pub(super) fn take(
        &mut self,
        wear: &VirtualWear<'_>,
        vehicle_m: f64,
        arrived: Option<Compared>,
        known: Correction,
        cycle_s: f64,
    ) {
        // A rig that follows is half a cycle behind what is wanted in the cycle of its answer.
        let at_m = 0.5 * (vehicle_m + self.last_m.unwrap_or(vehicle_m));
        self.last_m = Some(vehicle_m);
        let correction = arrived.map_or(known, |compared| compared.correction);
        let (_, model_n) = wear.balance(&mut self.damper, at_m, &correction, cycle_s);
        if let Some(Compared { model_n: measured_n, .. }) = arrived {
            let error_n = correction.of(measured_n) - correction.of(model_n);
            self.squares += error_n * error_n;
            self.readings = self.readings.saturating_add(1);
        }
    }

    /// What the force was off, rms since [`Reference::clear`] (N).
    pub(super) fn error_n(&self) -> f64 {
        crate::sqrt::sqrt(self.squares / f64::from(self.readings.max(1)))
    }

    /// Begins the sum anew.
    pub(super) fn clear(&mut self) {
        (self.squares, self.readings) = (0.0, 0);
    }
}
