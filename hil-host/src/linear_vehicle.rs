//! The vehicle about steady running, as far as the bench needs it: its hunting, and what a damper
//! does to it. Whoever starts a run computes it; the bench knows no study.

use firmware_core::vehicle::DAMPER_SLOTS;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// The least damped oscillation of a vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hunting {
    /// Its frequency, Hz.
    pub frequency_hz: f64,
    /// Its damping ratio; negative for a motion that grows.
    pub damping_ratio: f64,
}

/// A vehicle about steady running with all its dampers, each as `Ce` and `Ke` in series.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearVehicle {
    /// Its least damped oscillation.
    pub hunting: Hunting,
    /// The pole of it, 1/s.
    pub hunting_pole: Complex64,
    /// Its poles, with the receptance at every slot.
    pub modes: Vec<LinearMode>,
}

/// A pole, and its residues in the receptance of each damper slot: the extension over a force that
/// extends. A pole off the real axis stands for its conjugate too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearMode {
    /// The pole, 1/s; its imaginary part is not negative.
    pub pole: Complex64,
    /// Residues, m/(N s).
    pub residues: [Complex64; DAMPER_SLOTS],
    /// The same between slots: the extension of the first index over a force of the second.
    pub cross: [[Complex64; DAMPER_SLOTS]; DAMPER_SLOTS],
}

impl LinearMode {
    /// What it has of a receptance with this residue at a frequency, 1/s.
    pub(crate) fn of(&self, residue: Complex64, s: Complex64) -> Complex64 {
        let own = residue / (s - self.pole);
        let other = residue.conj() / (s - self.pole.conj());
        if self.pole.im == 0.0 { own } else { own + other }
    }
}
