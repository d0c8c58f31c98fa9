//! The SS9 with four new yaw dampers, stepped without the host: for references that look at every
//! step.

use super::vehicles;
use crate::error::EvidenceError;
use firmware_core::damper::{Damper, DamperState, Motion};
use firmware_core::vehicle::{DAMPER_SLOTS, DamperForces, Vehicle, VehicleState};
use scenario::equilibrium;
use scenario::rig::RigFile;
use scenario::wheel_rail::Contact;

/// Length of a substep (s).
pub(super) const SUBSTEP_S: f64 = 0.25e-3;
/// 160 km/h.
pub(super) const SPEED_M_PER_S: f64 = 160.0 / 3.6;

/// The vehicle in steady running at 160 km/h.
pub(super) struct Locomotive {
    pub(super) vehicle: Vehicle,
    pub(super) contact: Contact,
    pub(super) start: VehicleState,
    pub(super) dampers: Dampers,
}

impl Locomotive {
    pub(super) fn new() -> Result<Self, EvidenceError> {
        let built = vehicles::ss9()?;
        let contact = built.contact.ok_or(EvidenceError::NotComputed("an SS9 without profiles"))?;
        let table = Some(&*contact.table);
        let start = equilibrium::running(&built.vehicle, table, SPEED_M_PER_S)?.state;
        // A rig without a file has a new SS9 yaw damper on it.
        let dampers = Dampers::new(&RigFile::default_setup()?.damper);
        Ok(Self { vehicle: built.vehicle, contact, start, dampers })
    }
}

/// One damper in every slot.
#[derive(Clone)]
pub(super) struct Dampers {
    damper: Damper,
    states: [DamperState; DAMPER_SLOTS],
}

impl Dampers {
    fn new(damper: &Damper) -> Self {
        Self { damper: damper.clone(), states: [DamperState::rest(); DAMPER_SLOTS] }
    }

    /// Stiffness of the series spring (N/m).
    pub(super) fn stiffness_n_per_m(&self) -> f64 {
        self.damper.nominal().ke_n_per_m
    }
}

impl DamperForces for Dampers {
    fn force_n(
        &mut self,
        slot: usize,
        _lane: usize,
        extension_m: f64,
        rate_m_per_s: f64,
        substep_s: f64,
    ) -> f64 {
        let motion = Motion::new(extension_m, rate_m_per_s);
        self.states.get_mut(slot).map_or(0.0, |state| self.damper.advance(state, motion, substep_s))
    }
}
