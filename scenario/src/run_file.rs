//! A scenario as it stands in its file.

use crate::compare::CompareFile;
use crate::compensation::CompensationFile;
use crate::damper::DamperFile;
use crate::error::ScenarioError;
use crate::inputs::Inputs;
use crate::motion::MotionFile;
use crate::plausibility::PlausibilityFile;
use crate::quantity::Quantity;
use crate::readiness::ReadinessFile;
use crate::rig::RigFile;
use crate::source::Source;
use crate::track::TrackFile;
use crate::watch::WatchFile;
use files::quoted;
use serde::{Deserialize, Serialize};

/// A scenario as it stands in its file.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RunFile {
    /// What it shows; without it the title says what vehicle, speed and dampers are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// The vehicle file, relative to this one.
    pub vehicle: String,
    /// Running speed.
    pub speed_kmh: Quantity,
    /// How long it runs.
    pub duration_s: Quantity,
    /// Time at the start that statistics leave out.
    pub run_in_s: Option<Quantity>,
    /// Cycles of the control loop per second: 1000, 2000 or 4000.
    pub rate_hz: Option<Quantity>,
    /// Substeps per millisecond.
    pub substeps: Option<u32>,
    /// The track.
    #[serde(default)]
    pub track: TrackFile,
    /// The damper in every slot that does not name its own values.
    #[serde(default)]
    pub damper: DamperFile,
    /// What is different in single slots.
    #[serde(default)]
    pub slot: Vec<SlotFile>,
    /// How rigs are moved.
    #[serde(default)]
    pub motion: MotionFile,
    /// What rigs have to answer before they are armed.
    #[serde(default)]
    pub readiness: ReadinessFile,
    /// What is believed of rigs.
    #[serde(default)]
    pub plausibility: PlausibilityFile,
    /// The emulated rig on the memory bus; its damper defaults to that of the scenario.
    #[serde(default)]
    pub rig: RigFile,
    /// Another damper that the run is compared with.
    pub compare: Option<CompareFile>,
}

/// One damper slot.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SlotFile {
    /// Its place on the vehicle.
    pub place: String,
    /// `modelled` or `rig`; `partner` or `other_bogie` where a rig in another slot stands for it.
    pub on: On,
    /// Place of the damper whose rig stands for this one.
    pub of: Option<String>,
    /// Node number of the rig, 1 to 4.
    pub node: Option<u8>,
    /// Name of the rig's bus, for a vehicle with rigs on several; the run's `--bus` when absent.
    pub bus: Option<String>,
    /// Values of this damper alone.
    #[serde(default)]
    pub damper: DamperFile,
    /// Wear injected in software in front of a rig.
    pub virtual_wear: Option<VirtualWearFile>,
    /// The damper that acts on the vehicle while the rig's force is faded in and out: by default
    /// the scenario's, with the virtual wear.
    pub model: Option<DamperFile>,
    /// A model that the rig's force is compared with.
    pub watch: Option<WatchFile>,
    /// Whether a run goes on whose delay costs more of the damping than is allowed.
    pub accept_delay_error: Option<bool>,
    /// How the delay of the rig is compensated.
    pub compensation: Option<CompensationFile>,
    /// What follows where the rig is lost in RUN.
    pub if_rig_drops_out: Option<IfRigDropsOut>,
}

/// Where the force of a slot comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum On {
    /// The damper model, inside the vehicle step.
    Modelled,
    /// A rig on the bus.
    Rig,
    /// The rig of the damper that stands opposite on the same bogie, its sign reversed.
    Partner,
    /// The rig of a damper of another bogie.
    OtherBogie,
}

/// For which damper a rig in another slot stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StandsFor {
    /// The one opposite on the same bogie.
    Partner,
    /// One of another bogie.
    OtherBogie,
}

impl StandsFor {
    /// Its name in a scenario and in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Partner => "partner",
            Self::OtherBogie => "other_bogie",
        }
    }
}

impl On {
    /// For which damper a rig stands; none of a slot with a model or a rig of its own.
    pub(crate) const fn stands_for(self) -> Option<StandsFor> {
        match self {
            Self::Partner => Some(StandsFor::Partner),
            Self::OtherBogie => Some(StandsFor::OtherBogie),
            Self::Modelled | Self::Rig => None,
        }
    }
}

/// What follows where a rig is lost in RUN.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum IfRigDropsOut {
    /// The run ends, as its cause asks for.
    #[default]
    Stop,
    /// The vehicle goes on with the model of that damper, as long as another rig is left.
    Model,
}

/// Wear in software: play and softness in series with the real damper.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct VirtualWearFile {
    /// Extra total clearance.
    pub clearance_2a_m: Option<Quantity>,
    /// Stiffness of the extra series spring.
    pub stiffness_n_per_m: Option<Quantity>,
}

impl RunFile {
    /// This scenario with the values of every model file that it names.
    pub(crate) fn resolved(
        mut self,
        source: &Source,
        inputs: &mut Inputs,
    ) -> Result<Self, ScenarioError> {
        check_places(&self.slot, source)?;
        self.damper = self.damper.resolved(source, "damper", inputs)?;
        self.rig = self.rig.resolved(source, inputs)?;
        for slot in &mut self.slot {
            let own = std::mem::take(&mut slot.damper);
            slot.damper = own.resolved(source, &format!("damper {}", slot.place), inputs)?;
            if let Some(model) = slot.model.take() {
                let role = format!("model {}", slot.place);
                slot.model = Some(model.resolved(source, &role, inputs)?);
            }
            if let Some(watch) = &mut slot.watch {
                let model = std::mem::take(&mut watch.damper);
                let role = format!("watched model {}", slot.place);
                watch.damper = model.resolved(source, &role, inputs)?;
            }
        }
        self.compare = self.compare.map(|compare| compare.resolved(source, inputs)).transpose()?;
        Ok(self)
    }
}

/// Each place is there once at most.
fn check_places(slots: &[SlotFile], source: &Source) -> Result<(), ScenarioError> {
    for (index, slot) in slots.iter().enumerate() {
        let place = &slot.place;
        if slots.iter().take(index).any(|earlier| earlier.place == *place) {
            return Err(source.whole_error(format!("slot \"{}\" is given twice", quoted(place))));
        }
    }
    Ok(())
}
