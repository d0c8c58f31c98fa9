//! The locomotive of the study, with one set of yaw dampers at a time.

use crate::error::EvidenceError;
use firmware_core::damper::{Damper, Nominal};
use scenario::run::{Overrides, Run};
use scenario::setting::Setting;
use std::collections::BTreeMap;
use std::path::Path;
use vehicle_studies::StudyError;
use vehicle_studies::trip::Equipped;

/// Effective stiffness of a damper in good condition (N/m).
pub(super) const KE_N_PER_M: f64 = 12.5e6;
/// Its clearance (m).
pub(super) const CLEARANCE_2A_M: f64 = 0.2e-3;

/// Keys of a scenario that make all its yaw dampers so.
pub(super) fn dampers(ke_n_per_m: f64, clearance_2a_m: f64) -> [Setting; 2] {
    [
        Setting::to("damper.ke_n_per_m", ke_n_per_m),
        Setting::to("damper.clearance_2a_m", clearance_2a_m),
    ]
}

/// A scenario's vehicle, and the damper that its yaw dampers are made from.
#[derive(Debug, Clone)]
pub struct Locomotive {
    equipped: Equipped<'static>,
    nominal: Nominal,
    /// What the scenario calls itself.
    pub title: String,
    /// What one should know about the vehicle's numbers.
    pub about: Vec<String>,
    /// Hash of the content of every file that was read, by what the file is for.
    pub inputs: BTreeMap<String, String>,
}

impl Locomotive {
    /// The vehicle of a scenario, some numbers of it changed.
    ///
    /// # Errors
    /// A scenario that cannot run, or one whose vehicle has no damper.
    pub fn load(scenario: &Path, changes: &[Setting]) -> Result<Self, EvidenceError> {
        let overrides = Overrides { duration_s: Some(1.0), ..Overrides::default() };
        let run = Run::load_with(scenario, overrides, changes)?;
        let in_file = |why| StudyError::InFile(scenario.to_owned(), Box::new(why));
        let equipped = Equipped::of(&run).map_err(|why| in_file(why.into()))?;
        let first = equipped.dampers.first().map(|damper| *damper.nominal());
        let no_damper = || EvidenceError::NoYawDamper(scenario.to_owned());
        let nominal = first.ok_or_else(no_damper)?;
        let (title, about, inputs) = (run.title, run.about, run.inputs);
        Ok(Self { equipped, nominal, title, about, inputs })
    }

    /// With yaw dampers of this stiffness and clearance.
    pub fn with(&self, ke_n_per_m: f64, clearance_2a_m: f64) -> Equipped<'static> {
        self.with_dampers(Nominal { ke_n_per_m, clearance_2a_m, ..self.nominal })
    }

    /// With these yaw dampers at every place.
    ///
    /// A damper that cannot be leaves the scenario's own; none of this study's is one.
    pub fn with_dampers(&self, nominal: Nominal) -> Equipped<'static> {
        let as_built = || self.equipped.clone();
        Damper::new(nominal, &[]).map_or_else(|_| as_built(), |damper| as_built().with(&damper))
    }

    /// The damper that others are made from.
    pub const fn nominal(&self) -> &Nominal {
        &self.nominal
    }

    /// The vehicle as its scenario equips it.
    pub const fn as_built(&self) -> &Equipped<'static> {
        &self.equipped
    }
}
