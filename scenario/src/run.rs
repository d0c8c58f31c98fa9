//! A run: vehicle, speed, track, damper slots and rig, ready to be simulated.

pub use crate::compensation::{CompensationFile, CompensationKind};
pub use crate::cycle::{CYCLE_S, Rate};
pub use crate::effective::Effective;
pub use crate::motion::{BeyondLimits, MEASURING_S, Motion};
pub use crate::plausibility::{ForceLimit, Plausibility};
pub use crate::readiness::Readiness;
pub use crate::run_file::{IfRigDropsOut, On, RunFile, SlotFile, StandsFor, VirtualWearFile};
pub use crate::slot::{Slot, SlotForce, worn};

use crate::compare::CompareSetup;
use crate::damper_mass;
use crate::effective::effective;
use crate::equilibrium::{self, Equilibrium, NoEquilibrium};
use crate::error::ScenarioError;
use crate::inputs::Inputs;
use crate::irregularity::{Band, Stretches};
use crate::kind::Kind;
use crate::minimum_speed::minimum_speed_m_per_s;
use crate::quantity::Quantity;
use crate::rig::{RigFile, RigSetup};
use crate::setting::Setting;
use crate::slot::{refuse_clipped_wear, slots};
use crate::source::Source;
use crate::stand_in;
use crate::title;
use crate::track::OwnedTrack;
use crate::typical;
use crate::vehicle::VehicleFile;
use crate::wheel_rail::Contact;
use files::quote::escaped;
use files::{number, quoted};
use firmware_core::damper::Damper;
use firmware_core::vehicle::Vehicle;
use firmware_core::wheel_rail::table::ContactTable;
use std::collections::BTreeMap;
use std::path::Path;

/// Substeps per millisecond unless a scenario says otherwise: chosen by the convergence test.
pub const SUBSTEPS: u32 = 4;

/// Most substeps per millisecond.
const SUBSTEPS_MAX: u32 = 64;

/// No wheel on rail has run faster (km/h).
const SPEED_MAX_KMH: f64 = 600.0;

/// Longest run (s): a day.
const DURATION_MAX_S: f64 = 86_400.0;

/// Distance at which the vehicle's reference point starts, so that no wheel stands before zero (m).
const START_M: f64 = 15.0;

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
    /// How often the control loop turns.
    pub rate: Rate,
    /// Substeps per cycle.
    pub substeps: u32,
    /// The track; its first stretch where there are [`Run::stretches`].
    pub track: OwnedTrack,
    /// The stretches of its random irregularity; none for a measured or a perfect track. Up to
    /// 26 km there is one.
    pub stretches: Option<Stretches>,
    /// What its random irregularity is made from; none for a measured or a perfect track.
    pub band: Option<Band>,
    /// The damper slots.
    pub slots: Vec<Slot>,
    /// How rigs are moved.
    pub motion: Motion,
    /// What rigs have to answer before they are armed.
    pub readiness: Readiness,
    /// What is believed of rigs.
    pub plausibility: Plausibility,
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
    /// "watched model front left", "rig", "rig damper", "damper of the rig", "compared damper".
    pub inputs: BTreeMap<String, String>,
    /// What is unusual about its numbers, one line each, for a command to print.
    pub warnings: Vec<String>,
    /// The scenario with every default written out; running it gives the same run.
    pub effective: Effective,
}

/// What happens at a speed that the substeps are too coarse for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Slow {
    /// It is refused.
    Refused,
    /// Substeps are halved until they do.
    Finer,
}

/// Which rates a loop may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rates {
    /// Each of [`Rate::ALL`].
    All,
    /// The usual one: what asks does not know another.
    Usual,
}

/// What the command line changes in a scenario.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Overrides {
    /// Another duration (s).
    pub duration_s: Option<f64>,
    /// Another speed (km/h).
    pub speed_kmh: Option<f64>,
    /// Another rate of the control loop.
    pub rate: Option<Rate>,
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

    /// The same for what knows the usual rate of 1 kHz alone.
    ///
    /// # Errors
    /// As for [`Run::load`]; another rate.
    pub fn load_at_usual_rate(path: &Path, overrides: Overrides) -> Result<Self, ScenarioError> {
        Self::build(&Source::read(path)?, overrides, &[], (Slow::Refused, Rates::Usual))
    }

    /// The same with other numbers in the scenario and in its vehicle.
    ///
    /// # Errors
    /// As for [`Run::load_at_usual_rate`]; a key that leads nowhere.
    pub fn load_with(
        path: &Path,
        overrides: Overrides,
        settings: &[Setting],
    ) -> Result<Self, ScenarioError> {
        let source = Source::read(path)?.with_settings(settings)?;
        Self::build(&source, overrides, settings, (Slow::Refused, Rates::Usual))
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
        Self::build(&source, overrides, settings, (Slow::Finer, Rates::Usual))
    }

    /// Builds a scenario from its text.
    ///
    /// # Errors
    /// One line with file, line and key for the first thing that does not fit.
    pub fn from_source(source: &Source, overrides: Overrides) -> Result<Self, ScenarioError> {
        Self::build(source, overrides, &[], (Slow::Refused, Rates::All))
    }

    fn build(
        source: &Source,
        overrides: Overrides,
        settings: &[Setting],
        (slow, rates): (Slow, Rates),
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
        let rate = file.overridden_rate(source, overrides, rates)?;
        let substeps = file.stated_substeps(source, rate)?;
        let vehicle_source = source.named("vehicle", &file.vehicle)?;
        inputs.note("vehicle", vehicle_source.content_hash());
        let vehicle_source = vehicle_source.with_vehicle_settings(settings)?;
        let vehicle_file: VehicleFile = vehicle_source.parse_as(Kind::Vehicle)?;
        let mut vehicle = vehicle_file.build(&vehicle_source)?;
        let contact = vehicle_file.wheel_rail.contact_of(&vehicle_source, &mut inputs)?;
        let rig_file = RigFile { damper: file.rig.damper.over(&file.damper), ..file.rig.clone() };
        let rig = rig_file.build(source)?;
        let compare = file.compare.as_ref().map(|compare| compare.build(source, &vehicle));
        let compare = compare.transpose()?;
        let mut slots = slots(&file, &vehicle_file, source, rate)?;
        stand_in::place(&file, &vehicle, source, &mut slots)?;
        debug_assert_eq!(slots.len(), vehicle.dampers.len(), "one slot for each damper");
        for (number, slot) in slots.iter_mut().enumerate() {
            if let SlotForce::Modelled(damper) = &mut slot.force {
                *damper = damper_mass::give_to_bodies(&mut vehicle, number, damper.clone())
                    .map_err(|error| source.whole_error(error.to_string()))?;
            }
        }
        let table = contact.as_ref().map(|contact| &*contact.table);

        let wheels = (&vehicle, table);
        let (speed_m_per_s, substeps_per_ms) = file
            .speed_and_substeps(source, wheels, substeps, slow)
            .map_err(|error| overrides.blamed_for_speed(error))?;
        let start = Self::steady(&vehicle, contact.as_ref(), speed_m_per_s).map_err(|error| {
            ScenarioError::Equilibrium { file: vehicle_source.path().to_owned(), part: None, error }
        })?;
        let motion = file.motion.build(source, rate)?;
        refuse_clipped_wear(&slots, &motion, rate, source)?;
        let readiness = file.readiness.build(source)?;
        let plausibility = file.plausibility.build(source, motion.stroke_m, rate)?;
        let ramps_s = if on_rigs(&slots) { motion.ramps_s(rate) } else { 0.0 };
        let end_m = START_M + speed_m_per_s * (duration_s + ramps_s) + 20.0;
        let reach_m = vehicle.bodies.iter().map(|body| body.station_m.abs()).fold(0.0, f64::max);
        let (track, stretches) = file.track.build(source, (0.0, end_m), reach_m, &mut inputs)?;
        let band = stretches.as_ref().map(|stretches| *stretches.band());
        let mut about: Vec<String> =
            vehicle_file.about.iter().map(|about| escaped(about)).collect();
        if let Some(contact) = &contact {
            for profile in &contact.profiles {
                about.push(profile.line());
            }
        }
        debug_assert!(start.state.distance_m.0[0] == START_M, "all wheels behind the start");
        let vehicle_name = quoted(&vehicle_file.name).to_string();
        let title = match &file.title {
            Some(title) => quoted(title).to_string(),
            None => title::title(&vehicle_name, file.speed_kmh.value, &slots, &rig.damper),
        };
        let mut warnings = warnings(&slots, &rig.damper, compare.as_ref());
        warnings.extend(typical::vehicle_warnings(&vehicle_file));
        let body_names =
            vehicle_file.body.iter().map(|body| quoted(&body.name).to_string()).collect();
        file.run_in_s = Some(Quantity::plain(run_in_s));
        file.substeps = Some(substeps_per_ms);
        file.rate_hz = Some(Quantity::plain(f64::from(rate.hz())));
        let effective =
            effective(file, (&motion, &rig, rate), source, vehicle_file, &vehicle_source)?;
        Ok(Self {
            title,
            vehicle_name,
            about,
            vehicle,
            contact,
            speed_m_per_s,
            duration_s,
            run_in_s,
            rate,
            substeps: substeps_per_ms / rate.per_ms(),
            track,
            stretches,
            band,
            slots,
            motion,
            readiness,
            plausibility,
            rig,
            compare,
            start,
            body_names,
            inputs: inputs.by_role(),
            warnings,
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

    /// The same run with its random track in stretches of so many samples.
    #[must_use]
    pub fn in_stretches_of(self, samples: usize) -> Self {
        let Some(stretches) = self.stretches else { return self };
        let stretches = stretches.of_samples(samples);
        let mut track = self.track;
        stretches.make(0, &mut track.samples, &|| true);
        Self { track, stretches: Some(stretches), ..self }
    }

    /// Number of control cycles.
    pub fn cycles(&self) -> u64 {
        self.rate.cycles(self.duration_s)
    }

    /// Length of a control cycle (s).
    pub fn cycle_s(&self) -> f64 {
        self.rate.cycle_s()
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
    /// Substeps per millisecond.
    fn stated_substeps(&self, source: &Source, rate: Rate) -> Result<u32, ScenarioError> {
        let substeps = self.substeps.unwrap_or(SUBSTEPS);
        if !(2..=SUBSTEPS_MAX).contains(&substeps) {
            let found = format!("substeps = {substeps}, expected 2 to {SUBSTEPS_MAX}");
            return Err(source.whole_error(found));
        }
        if !substeps.is_multiple_of(rate.per_ms()) {
            let expected = format!("a multiple of {} at {rate}", rate.per_ms());
            return Err(source.whole_error(format!("substeps = {substeps}, expected {expected}")));
        }
        Ok(substeps)
    }

    /// The rate of the loop, which the command line may have changed.
    fn overridden_rate(
        &self,
        source: &Source,
        overrides: Overrides,
        rates: Rates,
    ) -> Result<Rate, ScenarioError> {
        let expected = match rates {
            Rates::All => "1000, 2000 or 4000 Hz",
            Rates::Usual => "1000 Hz: no other rate is supported here",
        };
        let fits = |rate: &Rate| rates == Rates::All || *rate == Rate::Usual;
        if let Some(rate) = overrides.rate {
            let (option, found) = ("--rate", f64::from(rate.hz()));
            let refused = || ScenarioError::Option { option, found, expected: expected.to_owned() };
            return Some(rate).filter(fits).ok_or_else(refused);
        }
        let Some(given) = &self.rate_hz else { return Ok(Rate::Usual) };
        let rate = Rate::ALL.into_iter().find(|rate| f64::from(rate.hz()) == given.value);
        rate.filter(fits).ok_or_else(|| given.refused(source, "rate_hz", expected))
    }

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
            let least_kmh = number(libm::ceil(least * 3.6));
            let fine = (substeps + 1..=SUBSTEPS_MAX).find(|n| speed_m_per_s >= slowest(*n));
            let advice = fine.map_or(String::new(), |n| format!("; substeps = {n} is enough"));
            let expected = format!(
                "at least {least_kmh} at {substeps} substeps: creep grows stiff as 1/V{advice}"
            );
            return Err(self.speed_kmh.refused(source, "speed_kmh", expected));
        }
        Ok((speed_m_per_s, substeps))
    }
}

/// Whether any slot is on a rig.
fn on_rigs(slots: &[Slot]) -> bool {
    slots.iter().any(|slot| matches!(slot.force, SlotForce::Rig { .. }))
}

/// What is unusual about the dampers of a run: each line once, with the places it is about.
fn warnings(slots: &[Slot], on_rig: &Damper, compare: Option<&CompareSetup>) -> Vec<String> {
    let mut found: Vec<(String, Vec<&str>)> = Vec::new();
    let mut note = |line: String, place| match found.iter_mut().find(|(other, _)| *other == line) {
        Some((_, places)) => places.push(place),
        None => found.push((line, vec![place])),
    };
    for slot in slots {
        let lines = match &slot.force {
            SlotForce::Modelled(damper) => typical::damper_warnings(damper),
            SlotForce::Rig { virtual_clearance_2a_m, .. } => {
                let wear = typical::wear_warning(*virtual_clearance_2a_m);
                typical::damper_warnings(on_rig).into_iter().chain(wear).collect()
            }
            SlotForce::StandIn { model, is_reversed, .. } => {
                stand_in::warnings(model, on_rig, *is_reversed)
            }
        };
        for line in lines {
            note(line, &slot.place);
        }
    }
    if let Some(CompareSetup { name, damper, .. }) = compare {
        for line in typical::damper_warnings(damper) {
            note(line, name);
        }
    }
    found.into_iter().map(|(line, places)| format!("{}: {line}", places.join(", "))).collect()
}
