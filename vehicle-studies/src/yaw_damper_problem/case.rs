//! The vehicle with one state of its dampers, and its all-model runs.

use super::condition::Condition;
use super::data_sheet::DataSheet;
use super::errors::Errors;
use super::recording::{Observed, Recording};
use super::regime::{REGIMES, Regime};
use crate::critical_speed::{Critical, Fold, Procedure};
use crate::error::StudyError;
use crate::trip::{Equipped, Rigs};
use firmware_core::damper::{Damper, Nominal};
use firmware_core::vehicle::DAMPER_SLOTS;
use scenario::irregularity::Band;
use scenario::rig::RigSetup;
use scenario::run::{Overrides, Run};
use scenario::track::OwnedTrack;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// All dampers are behind rigs: the strongest coupling.
pub(super) const ALL: [bool; DAMPER_SLOTS] = [true; DAMPER_SLOTS];
/// Frequency of the phase before the limit cycle is known (Hz).
const FIRST_HZ: f64 = 3.3;

/// A vehicle of the problem.
#[derive(Debug)]
pub(super) struct Case<'a> {
    pub(super) condition: Condition,
    pub(super) equipped: Equipped<'a>,
    /// The rig of the scenario with its damper, without dead time.
    pub(super) rig: RigSetup,
    /// How that rig answers.
    pub(super) sheet: DataSheet,
    /// Hash of the content of every file that was read.
    pub(super) inputs: BTreeMap<String, String>,
    speed_m_per_s: f64,
    band: Band,
}

/// The all-model run of a regime.
#[derive(Debug)]
pub(super) struct Reference {
    regime: Regime,
    track: OwnedTrack,
    speed_m_per_s: f64,
    pub(super) recording: Recording,
    pub(super) observed: Observed,
}

impl<'a> Case<'a> {
    /// Reads the scenario with this state of its dampers; work on it ends once the flag is set.
    ///
    /// # Errors
    /// A scenario that cannot be read; one without random irregularity or without a damper.
    pub(super) fn load(
        scenario: &Path,
        condition: Condition,
        stop: &'a AtomicBool,
    ) -> Result<Self, StudyError> {
        let overrides = Overrides { duration_s: Some(1.0), ..Overrides::default() };
        let run = Run::load_with(scenario, overrides, &condition.settings())?;
        let in_file = |why| StudyError::InFile(scenario.to_owned(), Box::new(why));
        if run.slots.len() < DAMPER_SLOTS {
            return Err(in_file(StudyError::NoDamper));
        }
        let band = run.band.ok_or_else(|| in_file(StudyError::NoIrregularity))?;
        let equipped = Equipped::of(&run)?.until(stop);
        let rig = RigSetup { delay_cycles: 0, ..run.rig };
        let sheet = DataSheet::of(&rig);
        let (inputs, speed_m_per_s) = (run.inputs, run.speed_m_per_s);
        Ok(Self { condition, equipped, rig, sheet, inputs, speed_m_per_s, band })
    }

    /// The all-model runs: over the track and in the limit cycle. The phase over the track is taken
    /// at the frequency of the limit cycle.
    ///
    /// # Errors
    /// The vehicle leaves the track or does not hunt; the work is stopped.
    pub(super) fn references(&self) -> Result<[Reference; 2], StudyError> {
        let hunting = self.reference(Regime::Hunting, FIRST_HZ)?;
        let track = self.reference(Regime::Track, hunting.observed.frequency_hz)?;
        debug_assert!(REGIMES.len() == 2, "a run of every regime");
        Ok([track, hunting])
    }

    fn reference(&self, regime: Regime, hunting_hz: f64) -> Result<Reference, StudyError> {
        let speed_m_per_s = self.regime_m_per_s(regime);
        let track = regime.track(&self.band, speed_m_per_s);
        let recording = Recording::of(&self.equipped, regime, &track, speed_m_per_s)?;
        let lost = || StudyError::NoReference(self.condition.name(), regime.name());
        let recording = recording.ok_or_else(lost)?;
        let observed = recording.observed(hunting_hz).ok_or_else(lost)?;
        Ok(Reference { regime, track, speed_m_per_s, recording, observed })
    }

    /// Speed in a regime (m/s).
    pub(super) fn regime_m_per_s(&self, regime: Regime) -> f64 {
        match regime {
            Regime::Track => self.speed_m_per_s,
            Regime::Hunting => self.condition.hunting_kmh() / 3.6,
        }
    }

    /// The errors with all dampers behind rigs; none where the vehicle leaves the track or its
    /// limit cycle is lost.
    ///
    /// # Errors
    /// The work is stopped.
    pub(super) fn errors(
        &self,
        rigs: Rigs,
        reference: &Reference,
    ) -> Result<Option<Errors>, StudyError> {
        let Reference { regime, track, speed_m_per_s, observed, .. } = reference;
        let coupled = self.equipped.behind(rigs);
        let recording = Recording::of(&coupled, *regime, track, *speed_m_per_s)?;
        let found = recording.and_then(|recording| recording.observed(observed.frequency_hz));
        Ok(found.map(|found| Errors::of(&found, observed)))
    }

    /// The speed below which no hunting stays, with all dampers behind rigs or with none.
    ///
    /// # Errors
    /// The work is stopped.
    pub(super) fn critical(&self, rigs: Option<Rigs>) -> Result<Critical, StudyError> {
        let equipped = match rigs {
            Some(rigs) => &self.equipped.behind(rigs),
            None => &self.equipped,
        };
        Ok(Fold::of(equipped, &self.procedure(RESOLUTION_KMH))?.dies)
    }

    /// The same with all dampers modelled, each with so many times its damping.
    ///
    /// # Errors
    /// The work is stopped.
    pub(super) fn critical_with_damping(&self, factor: f64) -> Result<Critical, StudyError> {
        let dampers: Result<Vec<Damper>, _> = self
            .equipped
            .dampers
            .iter()
            .map(|damper| Damper::new(damped(damper.nominal(), factor), damper.effects()))
            .collect();
        let mut equipped = self.equipped.clone();
        equipped.dampers = dampers?;
        Ok(Fold::of(&equipped, &self.procedure(FINE_KMH))?.dies)
    }

    /// How the critical speed is asked for.
    fn procedure(&self, resolution_kmh: f64) -> Procedure {
        let to_kmh = self.condition.from_above_kmh();
        let from_kmh = to_kmh - RANGE_KMH;
        let (step_kmh, hold_s) = (STEP_KMH, HOLD_S);
        Procedure { from_kmh, to_kmh, step_kmh, resolution_kmh, hold_s, ..Procedure::default() }
    }
}

/// How closely a critical speed is met (km/h).
const RESOLUTION_KMH: f64 = 0.5;
/// The same where two of them are subtracted.
const FINE_KMH: f64 = 0.1;
/// Range of speeds that is searched (km/h).
const RANGE_KMH: f64 = 100.0;
/// Distance between speeds (km/h), and the time at each (s). A cycle that has lost its balance dies
/// slowly; in a shorter time it is taken along to a speed at which it does not exist any more.
const STEP_KMH: f64 = 2.5;
const HOLD_S: f64 = 24.0;

/// A damper whose dashpot and relief give so many times the force at every speed.
fn damped(nominal: &Nominal, factor: f64) -> Nominal {
    Nominal {
        ce_n_s_per_m: factor * nominal.ce_n_s_per_m,
        f_relief_n: factor * nominal.f_relief_n,
        c2_n_s_per_m: factor * nominal.c2_n_s_per_m,
        ..*nominal
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    static GO: AtomicBool = AtomicBool::new(false);

    #[test]
    fn dampers_on_rigs_without_any_lag_are_those_of_the_all_model_run() {
        let scenario = Path::new(env!("CARGO_MANIFEST_DIR"));
        let scenario = scenario.join("../scenarios/ss9-160kmh-servo-rig.toml");
        for condition in [Condition::New, Condition::Worn] {
            let case = Case::load(&scenario, condition, &GO).unwrap();
            let reference = case.reference(Regime::Track, FIRST_HZ).unwrap();
            let rigid = RigSetup { fixture_m_per_n: 0.0, ..case.rig.clone() };
            let rigs = Rigs::late_by(&rigid, 0.0, ALL).unwrap();
            let found = case.errors(rigs, &reference).unwrap().unwrap();
            // What 1 kHz costs: forces are held, and clearances are crossed between two cycles.
            let [work, stroke, phase] = found.all().map(f64::abs);
            assert!(work < 0.2 && stroke < 0.05 && phase < 0.05, "{condition:?}: {found:?}");
        }
    }
}
