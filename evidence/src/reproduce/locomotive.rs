//! The locomotive of the study, with one set of yaw dampers at a time.

use firmware_core::damper::{Damper, Nominal};
use scenario::run::{Overrides, Run};
use scenario::setting::Setting;
use scenario::source::ScenarioError;
use std::path::Path;
use vehicle_studies::trip::Equipped;

/// Effective stiffness of a damper in good condition (N/m).
pub const KE_N_PER_M: f64 = 12.5e6;
/// Its clearance (m).
pub const CLEARANCE_2A_M: f64 = 0.2e-3;

/// Keys of a scenario that make all its yaw dampers so.
pub fn dampers(ke_n_per_m: f64, clearance_2a_m: f64) -> [Setting; 2] {
    [
        Setting::to("damper.ke_n_per_m", ke_n_per_m),
        Setting::to("damper.clearance_2a_m", clearance_2a_m),
    ]
}

/// A scenario's vehicle, and the damper that its yaw dampers are made from.
#[derive(Debug, Clone)]
pub struct Locomotive {
    equipped: Equipped,
    nominal: Nominal,
    /// What the scenario calls itself.
    pub title: String,
    /// What one should know about the vehicle's numbers.
    pub about: Vec<String>,
}

impl Locomotive {
    /// The vehicle of a scenario, some numbers of it changed.
    ///
    /// # Errors
    /// A scenario that cannot run, or one whose vehicle has no damper.
    pub fn load(scenario: &Path, changes: &[Setting]) -> Result<Self, ScenarioError> {
        let overrides = Overrides { duration_s: Some(1.0), speed_kmh: None };
        let run = Run::load_with(scenario, overrides, changes)?;
        let refused = |message: String| ScenarioError::mismatch(scenario, message);
        let equipped = Equipped::of(&run).map_err(|why| refused(why.to_string()))?;
        let first = equipped.dampers.first().map(|damper| *damper.nominal());
        let nominal =
            first.ok_or_else(|| refused("the vehicle has no yaw damper to vary".to_owned()))?;
        Ok(Self { equipped, nominal, title: run.title, about: run.about })
    }

    /// With yaw dampers of this stiffness and clearance.
    pub fn with(&self, ke_n_per_m: f64, clearance_2a_m: f64) -> Equipped {
        self.with_dampers(Nominal { ke_n_per_m, clearance_2a_m, ..self.nominal })
    }

    /// With these yaw dampers at every place.
    ///
    /// A damper that cannot be leaves the scenario's own; none of this study's is one.
    pub fn with_dampers(&self, nominal: Nominal) -> Equipped {
        let as_built = || self.equipped.clone();
        Damper::new(nominal, &[]).map_or_else(|_| as_built(), |damper| as_built().with(&damper))
    }

    /// The damper that others are made from.
    pub const fn nominal(&self) -> &Nominal {
        &self.nominal
    }

    /// The vehicle as its scenario equips it.
    pub const fn as_built(&self) -> &Equipped {
        &self.equipped
    }
}
