//! What is mounted between the eyes: the damper, a rigid bar, or a constant load.
//!
//! ```text
//! bar   F = k (x - x_0)       x_0: where the ram stood when the rig was started
//! load  F = constant
//! ```
//! The bar has neither mass nor damping, and its ends have no play.

use crate::mechanics::Mounting;
use firmware_core::damper::{Damper, Motion};
use scenario::damper_mass;
use scenario::rig::{Mounted, RigSetup};

/// What is mounted, for one length of substep.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Specimen {
    mounted: Mounted,
    damper: Damper,
}

impl Specimen {
    /// That of a rig; its length of substep is still to be set.
    pub(crate) fn of(setup: &RigSetup) -> Self {
        Self { mounted: setup.mounted, damper: setup.damper.clone() }
    }

    /// The same without the moving mass of a damper, and that mass (kg).
    pub(crate) fn without_mass(self) -> (Self, f64) {
        if self.mounted != Mounted::Damper {
            return (self, 0.0);
        }
        let mass_kg = damper_mass::mass_kg(&self.damper).unwrap_or(0.0);
        match damper_mass::without(self.damper.clone()) {
            Ok(damper) => (Self { damper, ..self }, mass_kg),
            Err(_) => (self, 0.0),
        }
    }

    /// The same for another length of substep (s).
    #[must_use]
    pub(crate) fn prepared(self, step_s: f64) -> Self {
        Self { damper: self.damper.prepared(step_s), ..self }
    }

    /// The force (N) after a substep that ends with this motion of the eyes.
    pub(crate) fn advance(&self, mounting: &mut Mounting, motion: Motion, step_s: f64) -> f64 {
        match self.mounted {
            Mounted::Damper => self.damper.advance(&mut mounting.damper, motion, step_s),
            Mounted::Bar { stiffness_n_per_m } => {
                stiffness_n_per_m * (motion.displacement_m - mounting.at_m)
            }
            Mounted::Load { force_n } => force_n,
        }
    }
}
