//! The comparison that a scenario asks for: the same run once more with another damper.
//!
//! ```toml
//! [compare]
//! name = "datasheet"                     # by default the name of the file
//! damper = { file = "datasheet.toml" }   # keys as in [damper], over a new damper
//! ```
//! The other damper takes the place of every damper of the scenario, those of single slots and of
//! an emulated rig included; wear in software goes with the damper that it stood for. Vehicle,
//! track, speed, rig and seeds stay. A rig that is not emulated cannot be run again: its slot is
//! modelled instead.

use crate::damper::DamperFile;
use crate::error::ScenarioError;
use crate::inputs::Inputs;
use crate::source::Source;
use files::quoted;
use firmware_core::damper::Damper;
use firmware_core::vehicle::Vehicle;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A comparison as it stands in a scenario.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CompareFile {
    /// What the other damper is called.
    pub name: Option<String>,
    /// The other damper.
    #[serde(default)]
    pub damper: DamperFile,
}

/// A comparison ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct CompareSetup {
    /// What the other damper is called.
    pub name: String,
    /// The other damper.
    pub damper: Damper,
    /// The vehicle without the mass of any damper.
    pub(crate) bare: Vehicle,
    /// The scenario, for what is wrong in it.
    pub(crate) source: Source,
}

/// What the other damper is called by default.
const NAME: &str = "the other damper";

impl CompareFile {
    /// This comparison with the values of the model file that it names, and with its name.
    ///
    /// # Errors
    /// The model cannot be read, or is no damper that can be, with its own file and line.
    pub(crate) fn resolved(
        self,
        source: &Source,
        inputs: &mut Inputs,
    ) -> Result<Self, ScenarioError> {
        let stem = self.damper.file.as_ref().and_then(|file| Path::new(file).file_stem());
        let stem = stem.map(|stem| stem.to_string_lossy().into_owned());
        Ok(Self {
            name: Some(self.name.or(stem).unwrap_or_else(|| NAME.to_owned())),
            damper: self.damper.resolved(source, "compared damper", inputs)?,
        })
    }

    /// This comparison with every value of its damper written out.
    #[must_use]
    pub fn with_defaults(&self) -> Self {
        Self { name: self.name.clone(), damper: self.damper.over(&DamperFile::new_damper()) }
    }

    /// Builds the comparison for a vehicle that carries no damper's mass yet.
    ///
    /// # Errors
    /// A value that no damper can have, or a vehicle without dampers, with file and line.
    pub fn build(&self, source: &Source, bare: &Vehicle) -> Result<CompareSetup, ScenarioError> {
        if bare.dampers.is_empty() {
            return Err(source.whole_error("[compare]: the vehicle has no yaw dampers to compare"));
        }
        Ok(CompareSetup {
            name: quoted(self.name.as_deref().unwrap_or(NAME)).to_string(),
            damper: self.damper.build(source)?,
            bare: bare.clone(),
            source: source.clone(),
        })
    }
}
