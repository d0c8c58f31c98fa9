//! What the figures of the study are made from.

use super::locomotive::Locomotive;
use crate::error::EvidenceError;
use files::Identity;
use serde::Serialize;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use vehicle_studies::critical_speed::Procedure;
use vehicle_studies::trip::Equipped;

/// Hash over the sources of the crates that compute the figures, made by the build script.
const PROGRAM: &str = env!("REPRODUCE_SOURCES");

/// A scenario, its locomotive and the way stability is asked for.
#[derive(Debug, Clone)]
pub struct Basis<'a> {
    /// The scenario.
    pub scenario: &'a Path,
    /// The locomotive of the scenario.
    pub locomotive: &'a Locomotive,
    /// How stability is asked for.
    pub procedure: &'a Procedure,
    /// Ends the work on a figure when it is set.
    pub stop: &'a AtomicBool,
}

/// What an identity holds of the question.
#[derive(Serialize)]
struct QuestionForm<'a> {
    /// Numbers of figures, or `calibration`.
    figures: &'a [&'static str],
    procedure: &'a Procedure,
}

impl<'a> Basis<'a> {
    /// The locomotive with yaw dampers of a stiffness and a clearance, until the work is stopped.
    pub(super) fn equipped(&self, ke_n_per_m: f64, clearance_2a_m: f64) -> Equipped<'a> {
        self.locomotive.with(ke_n_per_m, clearance_2a_m).until(self.stop)
    }

    /// The identity of some figures of the study, by their numbers, or of its calibration.
    ///
    /// # Errors
    /// None: the question always serialises.
    pub fn identity(&self, figures: &[&'static str]) -> Result<Identity, EvidenceError> {
        let question = QuestionForm { figures, procedure: self.procedure };
        Identity::new(&question, self.locomotive.inputs.clone(), PROGRAM)
            .map_err(|why| EvidenceError::NotSerialised(why.to_string()))
    }

    /// Reads the scenario again.
    ///
    /// # Errors
    /// Its files have changed since the locomotive was loaded.
    pub(super) fn refuse_changed(&self) -> Result<(), EvidenceError> {
        let now = Locomotive::load(self.scenario, &[])?;
        if now.inputs == self.locomotive.inputs {
            return Ok(());
        }
        Err(EvidenceError::Changed(self.scenario.to_owned()))
    }
}
