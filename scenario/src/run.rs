//! The scenario of a run: vehicle, speed, track, four damper slots, rig.

use crate::compare::{CompareFile, CompareSetup};
use crate::damper::DamperFile;
use crate::damper_mass;
use crate::equilibrium::{self, Equilibrium, NoEquilibrium};
use crate::error::ScenarioError;
use crate::inputs::Inputs;
use crate::irregularity::{Band, IrregularityFile};
use crate::kind::Kind;
use crate::minimum_speed::minimum_speed_m_per_s;
use crate::quantity::Quantity;
use crate::rig::{RigFile, RigSetup};
use crate::setting::Setting;
use crate::source::Source;
use crate::track::{OwnedTrack, TrackFile};
use crate::vehicle::VehicleFile;
use crate::watch::{WatchFile, WatchSetup};
use crate::wheel_rail::{Contact, SurfaceFile};
use files::quote::escaped;
use files::quoted;
use firmware_core::damper::Damper;
use firmware_core::vehicle::{DAMPER_SLOTS, Vehicle};
use firmware_core::wheel_rail::table::ContactTable;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Length of one control cycle (s).
pub const CYCLE_S: f64 = 1e-3;

/// Substeps per cycle unless a scenario says otherwise: chosen by the convergence test.
pub const SUBSTEPS: u32 = 4;

/// No wheel on rail has run faster (km/h).
const SPEED_MAX_KMH: f64 = 600.0;

/// Longest run (s): a day.
const DURATION_MAX_S: f64 = 86_400.0;

/// Distance at which the vehicle's reference point starts, so that no wheel stands before zero (m).
const START_M: f64 = 15.0;

/// A scenario as it stands in its file.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RunFile {
    /// What it shows.
    pub title: String,
    /// The vehicle file, beside this one.
    pub vehicle: String,
    /// Running speed.
    pub speed_kmh: Quantity,
    /// How long it runs.
    pub duration_s: Quantity,
    /// Time at the start that statistics leave out.
    pub run_in_s: Option<Quantity>,
    /// Substeps per cycle of 1 ms.
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
    /// `modelled` or `rig`.
    pub on: On,
    /// Node number of the rig, 1 to 4.
    pub node: Option<u8>,
    /// Name of the rig's bus, for a vehicle with rigs on several; the run's `--bus` when absent.
    pub bus: Option<String>,
    /// Values of this damper alone.
    #[serde(default)]
    pub damper: DamperFile,
    /// Wear injected in software in front of a rig.
    pub virtual_wear: Option<VirtualWearFile>,
    /// A model that the rig's force is compared with.
    pub watch: Option<WatchFile>,
}

/// Where the force of a slot comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum On {
    /// The damper model, inside the vehicle step.
    Modelled,
    /// A rig on the bus.
    Rig,
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

/// One slot, ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Slot {
    /// Its place on the vehicle.
    pub place: String,
    /// Where its force comes from.
    pub force: SlotForce,
}

/// Where the force of a slot comes from.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "four of them, made once")]
pub enum SlotForce {
    /// The model.
    Modelled(Damper),
    /// A rig.
    Rig {
        /// Its node.
        node: u8,
        /// Its bus, when it is not the run's.
        bus: Option<String>,
        /// Extra total clearance in software (m).
        virtual_clearance_2a_m: f64,
        /// Extra series compliance in software (m/N).
        virtual_compliance_m_per_n: f64,
        /// The model that its force is compared with.
        watch: Option<Box<WatchSetup>>,
    },
}

/// A scenario in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// What it shows.
    pub title: String,
    /// Name of the vehicle.
    pub vehicle_name: String,
    /// What one should know about the vehicle's numbers.
    pub about: Vec<String>,
    /// The vehicle.
    pub vehicle: Vehicle,
    /// Solved profiles.
    pub contact: Option<Contact>,
    /// Running speed (m/s).
    pub speed_m_per_s: f64,
    /// How long it runs (s).
    pub duration_s: f64,
    /// Time at the start that statistics leave out (s).
    pub run_in_s: f64,
    /// Substeps per cycle.
    pub substeps: u32,
    /// The track.
    pub track: OwnedTrack,
    /// What its random irregularity is made from; none for a measured or a perfect track.
    pub band: Option<Band>,
    /// The damper slots.
    pub slots: Vec<Slot>,
    /// The emulated rig.
    pub rig: RigSetup,
    /// Another damper that the run is compared with.
    pub compare: Option<CompareSetup>,
    /// Where it starts from: steady running.
    pub start: Equilibrium,
    /// Names of the bodies, in order.
    pub body_names: Vec<String>,
    /// Hash of the content of every file that was read, by its role: "scenario", "vehicle",
    /// "wheel profile", "rail profile", "measured track", "damper", "damper front left",
    /// "watched model front left", "rig damper", "compared damper".
    pub inputs: BTreeMap<String, String>,
    /// The scenario with every default written out; running it gives the same run.
    pub effective: Effective,
}

/// A scenario and its vehicle as TOML, to be kept beside each other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Effective {
    /// The scenario; it names the vehicle `vehicle.toml`.
    pub scenario: String,
    /// The vehicle.
    pub vehicle: String,
}

/// What happens at a speed that the substeps are too coarse for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Slow {
    /// It is refused.
    Refused,
    /// Substeps are halved until they do.
    Finer,
}

/// What the command line changes in a scenario.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Overrides {
    /// Another duration (s).
    pub duration_s: Option<f64>,
    /// Another speed (km/h).
    pub speed_kmh: Option<f64>,
}

impl Run {
    /// Reads a scenario file and everything it names.
    ///
    /// # Errors
    /// One line with file, line and key for the first thing that does not fit.
    pub fn load(path: &Path, overrides: Overrides) -> Result<Self, ScenarioError> {
        let source = Source::read(path)?;
        Self::from_source(&source, overrides)
    }

    /// The same with other numbers in the scenario and in its vehicle.
    ///
    /// # Errors
    /// As for [`Run::load`]; a key that leads nowhere.
    pub fn load_with(
        path: &Path,
        overrides: Overrides,
        settings: &[Setting],
    ) -> Result<Self, ScenarioError> {
        let source = Source::read(path)?.with_settings(settings)?;
        Self::build(&source, overrides, settings, Slow::Refused)
    }

    /// The same for a study that varies its speed: where one needs finer substeps it gets them.
    ///
    /// # Errors
    /// As for [`Run::load_with`].
    pub fn load_as_fine_as_needed(
        path: &Path,
        overrides: Overrides,
        settings: &[Setting],
    ) -> Result<Self, ScenarioError> {
        let source = Source::read(path)?.with_settings(settings)?;
        Self::build(&source, overrides, settings, Slow::Finer)
    }

    /// Builds a scenario from its text.
    ///
    /// # Errors
    /// One line with file, line and key for the first thing that does not fit.
    pub fn from_source(source: &Source, overrides: Overrides) -> Result<Self, ScenarioError> {
        Self::build(source, overrides, &[], Slow::Refused)
    }

    fn build(
        source: &Source,
        overrides: Overrides,
        settings: &[Setting],
        slow: Slow,
    ) -> Result<Self, ScenarioError> {
        let file: RunFile = source.parse_as(Kind::Scenario)?;
        let mut inputs = Inputs::default();
        inputs.note("scenario", source.content_hash());
        let mut file = file.resolved(source, &mut inputs)?;
        let duration_s = file.overridden_duration_s(source, overrides)?;
        if let Some(speed) = overrides.speed_kmh {
            file.speed_kmh = Quantity::plain(speed);
        }
        let run_in_s = match &file.run_in_s {
            Some(run_in) => run_in.not_negative(source, "run_in_s")?,
            None => 2.0,
        };
        // A short run keeps half of itself for its statistics.
        let run_in_s = run_in_s.min(0.5 * duration_s);
        let substeps = file.substeps.unwrap_or(SUBSTEPS);
        if !(2..=64).contains(&substeps) {
            return Err(source.whole_error(format!("substeps = {substeps}, expected 2 to 64")));
        }
        let vehicle_source = Source::read(&source.beside(&file.vehicle))?;
        inputs.note("vehicle", vehicle_source.content_hash());
        let vehicle_source = vehicle_source.with_vehicle_settings(settings)?;
        let vehicle_file: VehicleFile = vehicle_source.parse_as(Kind::Vehicle)?;
        let mut vehicle = vehicle_file.build(&vehicle_source)?;
        let contact = vehicle_file.wheel_rail.contact_of(&vehicle_source, &mut inputs)?;
        let rig_file = RigFile { damper: file.rig.damper.over(&file.damper), ..file.rig.clone() };
        let rig = rig_file.build(source)?;
        let compare = file.compare.as_ref().map(|compare| compare.build(source, &vehicle));
        let compare = compare.transpose()?;
        let mut slots = slots(&file, &vehicle_file, source, rig.damper.nominal().ke_n_per_m)?;
        for (number, slot) in slots.iter_mut().enumerate() {
            if let SlotForce::Modelled(damper) = &mut slot.force {
                *damper = damper_mass::give_to_bodies(&mut vehicle, number, damper.clone())
                    .map_err(|error| source.whole_error(error.to_string()))?;
            }
        }
        let table = contact.as_ref().map(|contact| &*contact.table);

        let wheels = (&vehicle, table);
        let (speed_m_per_s, substeps) = file
            .speed_and_substeps(source, wheels, substeps, slow)
            .map_err(|error| overrides.blamed_for_speed(error))?;
        let start = Self::steady(&vehicle, contact.as_ref(), speed_m_per_s).map_err(|error| {
            ScenarioError::Equilibrium { file: vehicle_source.path().to_owned(), part: None, error }
        })?;
        let end_m = START_M + speed_m_per_s * duration_s + 20.0;
        let track = file.track.build(source, (0.0, end_m), &mut inputs)?;
        let irregularity = file.track.irregularity.as_ref();
        let band = irregularity.map(|rough| rough.band(source)).transpose()?.flatten();
        let mut about: Vec<String> =
            vehicle_file.about.iter().map(|about| escaped(about)).collect();
        if let Some(contact) = &contact {
            for profile in &contact.profiles {
                about.push(profile.line());
            }
        }
        let title = quoted(&file.title).to_string();
        let vehicle_name = quoted(&vehicle_file.name).to_string();
        let body_names =
            vehicle_file.body.iter().map(|body| quoted(&body.name).to_string()).collect();
        file.run_in_s = Some(Quantity::plain(run_in_s));
        file.substeps = Some(substeps);
        let effective = effective(file, source, vehicle_file, &vehicle_source)?;
        Ok(Self {
            title,
            vehicle_name,
            about,
            vehicle,
            contact,
            speed_m_per_s,
            duration_s,
            run_in_s,
            substeps,
            track,
            band,
            slots,
            rig,
            compare,
            start,
            body_names,
            inputs: inputs.by_role(),
            effective,
        })
    }

    /// Steady running, with all wheels behind the beginning of the track.
    pub(crate) fn steady(
        vehicle: &Vehicle,
        contact: Option<&Contact>,
        speed_m_per_s: f64,
    ) -> Result<Equilibrium, NoEquilibrium> {
        let table = contact.map(|contact| &*contact.table);
        let mut start = equilibrium::running(vehicle, table, speed_m_per_s)?;
        start.state.distance_m.0[0] = START_M;
        Ok(start)
    }

    /// Number of control cycles.
    pub fn cycles(&self) -> u64 {
        libm::round(self.duration_s / CYCLE_S) as u64
    }
}

impl Overrides {
    /// An error of the speed names the option where it gives the speed.
    fn blamed_for_speed(self, error: ScenarioError) -> ScenarioError {
        match (self.speed_kmh, error) {
            (Some(_), ScenarioError::Value { key, found, expected, .. })
                if &*key == "speed_kmh" =>
            {
                ScenarioError::Option { option: "--speed-kmh", found, expected }
            }
            (_, error) => error,
        }
    }
}

impl RunFile {
    /// The duration (s), which the command line may have changed.
    fn overridden_duration_s(
        &mut self,
        source: &Source,
        overrides: Overrides,
    ) -> Result<f64, ScenarioError> {
        const EXPECTED: &str = "0.001 to 86400 s";
        if let Some(duration_s) = overrides.duration_s {
            if !(CYCLE_S..=DURATION_MAX_S).contains(&duration_s) {
                let (option, expected) = ("--duration", EXPECTED.to_owned());
                return Err(ScenarioError::Option { option, found: duration_s, expected });
            }
            self.duration_s = Quantity::plain(duration_s);
        }
        self.duration_s.within(source, "duration_s", CYCLE_S, DURATION_MAX_S, EXPECTED)
    }

    /// This scenario with the values of every model file that it names.
    fn resolved(mut self, source: &Source, inputs: &mut Inputs) -> Result<Self, ScenarioError> {
        check_places(&self.slot, source)?;
        self.damper = self.damper.resolved(source, "damper", inputs)?;
        self.rig.damper = self.rig.damper.resolved(source, "rig damper", inputs)?;
        for slot in &mut self.slot {
            let own = std::mem::take(&mut slot.damper);
            slot.damper = own.resolved(source, &format!("damper {}", slot.place), inputs)?;
            if let Some(watch) = &mut slot.watch {
                let model = std::mem::take(&mut watch.damper);
                let role = format!("watched model {}", slot.place);
                watch.damper = model.resolved(source, &role, inputs)?;
            }
        }
        self.compare = self.compare.map(|compare| compare.resolved(source, inputs)).transpose()?;
        Ok(self)
    }

    /// The speed (m/s), and substeps that are fine enough for it.
    fn speed_and_substeps(
        &self,
        source: &Source,
        (vehicle, table): (&Vehicle, Option<&ContactTable>),
        mut substeps: u32,
        slow: Slow,
    ) -> Result<(f64, u32), ScenarioError> {
        let speed_m_per_s = self.speed_kmh.within(
            source,
            "speed_kmh",
            f64::MIN_POSITIVE,
            SPEED_MAX_KMH,
            "more than 0 and at most 600 km/h",
        )? / 3.6;
        let slowest =
            |substeps: u32| minimum_speed_m_per_s(vehicle, table, CYCLE_S / f64::from(substeps));
        while slow == Slow::Finer && substeps <= 32 && speed_m_per_s < slowest(substeps) {
            substeps *= 2;
        }
        let least = slowest(substeps);
        if speed_m_per_s < least {
            let least_kmh = libm::ceil(least * 3.6);
            let expected =
                format!("at least {least_kmh:.0} at {substeps} substeps: creep grows stiff as 1/V");
            return Err(self.speed_kmh.refused(source, "speed_kmh", expected));
        }
        Ok((speed_m_per_s, substeps))
    }
}

/// The scenario with every default written out; files that it names get their full path.
fn effective(
    mut file: RunFile,
    source: &Source,
    mut vehicle: VehicleFile,
    vehicle_source: &Source,
) -> Result<Effective, ScenarioError> {
    let full = |source: &Source, path: &str| {
        let path = source.beside(path);
        std::path::absolute(&path).unwrap_or(path).display().to_string()
    };
    "vehicle.toml".clone_into(&mut file.vehicle);
    file.damper = file.damper.over(&DamperFile::new_damper());
    file.rig = file.rig.with_defaults(&file.damper);
    for watch in file.slot.iter_mut().filter_map(|slot| slot.watch.as_mut()) {
        *watch = watch.with_defaults(&file.damper);
    }
    file.compare = file.compare.map(|compare| compare.with_defaults());
    if let Some(IrregularityFile::Csv { path }) = &mut file.track.irregularity {
        *path = full(source, path);
    }
    if let SurfaceFile::Profiles { wheel, rail, .. } = &mut vehicle.wheel_rail.surface {
        for profile in [wheel, rail] {
            if vehicle_source.beside(profile).is_file() {
                *profile = full(vehicle_source, profile);
            }
        }
    }
    let written = |error: toml::ser::Error| source.whole_error(error.to_string());
    Ok(Effective {
        scenario: toml::to_string(&file).map_err(written)?,
        vehicle: toml::to_string(&vehicle).map_err(written)?,
    })
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

fn slots(
    file: &RunFile,
    vehicle: &VehicleFile,
    source: &Source,
    rig_ke_n_per_m: f64,
) -> Result<Vec<Slot>, ScenarioError> {
    let places: Vec<&str> = vehicle.damper_slot.iter().map(|slot| slot.place.as_str()).collect();
    debug_assert!(places.len() <= DAMPER_SLOTS);
    if let Some(unknown) = file.slot.iter().find(|slot| !places.contains(&slot.place.as_str())) {
        let expected = match places.as_slice() {
            [] => "expected none: the vehicle has no damper".to_owned(),
            places => format!("expected one of {}", quoted(&places.join(", "))),
        };
        let place = quoted(&unknown.place);
        return Err(
            source.whole_error(format!("slot place \"{place}\" does not exist, {expected}"))
        );
    }
    for slot in &file.slot {
        let place = quoted(&slot.place);
        let wear_or_watch = slot.virtual_wear.is_some() || slot.watch.is_some();
        let on_a_rig = [slot.node.is_some(), slot.bus.is_some(), wear_or_watch];
        if slot.on == On::Modelled && on_a_rig.contains(&true) {
            return Err(source.whole_error(format!(
                "slot \"{place}\" is modelled: node, bus, virtual_wear and watch are for a rig"
            )));
        }
    }
    let mut nodes = Vec::new();
    let mut built = Vec::new();
    for place in places {
        let given = file.slot.iter().find(|slot| slot.place == place);
        let force = match given {
            Some(slot) if slot.on == On::Rig => {
                slot.rig(file, source, &mut nodes, rig_ke_n_per_m)?
            }
            given => {
                let own = given.map(|slot| slot.damper.clone()).unwrap_or_default();
                SlotForce::Modelled(own.over(&file.damper).build(source)?)
            }
        };
        built.push(Slot { place: quoted(place).to_string(), force });
    }
    Ok(built)
}

impl SlotFile {
    fn rig(
        &self,
        file: &RunFile,
        source: &Source,
        nodes: &mut Vec<(Option<String>, u8)>,
        rig_ke_n_per_m: f64,
    ) -> Result<SlotForce, ScenarioError> {
        let node = self.node.unwrap_or(1);
        let place = quoted(&self.place);
        if !(1..=4).contains(&node) {
            return Err(
                source.whole_error(format!("slot \"{place}\": node = {node}, expected 1 to 4"))
            );
        }
        let address = (self.bus.clone(), node);
        if nodes.contains(&address) {
            return Err(source
                .whole_error(format!("slot \"{place}\": node {node} is taken by another slot")));
        }
        nodes.push(address);
        if self.damper != DamperFile::default() {
            return Err(source.whole_error(format!(
                "slot \"{place}\" is on a rig: its damper stands under [rig.damper]"
            )));
        }
        let (mut clearance, mut compliance) = (0.0, 0.0);
        if let Some(wear) = &self.virtual_wear {
            if let Some(given) = &wear.clearance_2a_m {
                clearance = given.not_negative(source, "clearance_2a_m")?;
            }
            if let Some(given) = &wear.stiffness_n_per_m {
                let stiffness = given.positive(source, "stiffness_n_per_m")?;
                // Feedback over one cycle of lag: unstable from the damper's own stiffness down.
                if stiffness < 2.0 * rig_ke_n_per_m {
                    return Err(given.error(
                        source,
                        format!(
                            "stiffness_n_per_m = {stiffness}, expected at least twice the ke_n_per_m \
                             of the rig's damper ({rig_ke_n_per_m}): softer wear needs a softer damper"
                        ),
                    ));
                }
                compliance = 1.0 / stiffness;
            }
        }
        let watch = match &self.watch {
            Some(watch) => Some(Box::new(watch.build(source, &file.damper)?)),
            None => None,
        };
        Ok(SlotForce::Rig {
            node,
            bus: self.bus.clone(),
            virtual_clearance_2a_m: clearance,
            virtual_compliance_m_per_n: compliance,
            watch,
        })
    }
}
