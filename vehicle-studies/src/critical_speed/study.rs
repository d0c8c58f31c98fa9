//! Critical speeds of a scenario at every point of a grid.

use super::answer::{CriticalSpeeds, Point};
use super::ascent::Ascent;
use super::fold::Fold;
use super::linear::LinearSpeed;
use super::page::page;
use super::procedure::Procedure;
use super::text::text;
use crate::error::StudyError;
use crate::one_force::refuse_other_bogie;
use crate::study::Study;
use crate::trip::Equipped;
use firmware_core::wheel_rail::wheel::Surface;
use report::Report;
use scenario::conicity::RollingRadiusDifference;
use scenario::run::Run;
use serde::Serialize;

/// Amplitude at which equivalent conicity is stated (m).
const CONICITY_AT_M: f64 = 3e-3;
/// Lateral reach of the rolling radius difference that it is found from (m).
const REACH_M: f64 = 6e-3;

/// What is asked; track and duration of the scenario do not matter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Question {
    /// How stability is asked for.
    #[serde(flatten)]
    pub procedure: Procedure,
    /// Over irregular track.
    pub ascent: bool,
    /// Down the limit cycle.
    pub fold: bool,
    /// Strokes of the dampers for eigenvalues (m); none for no eigenvalues.
    pub strokes_m: Vec<f64>,
}

impl Study for Question {
    const NAME: &'static str = "critical-speed";
    const ANSWERS: &'static str = "critical speeds";
    type Answer = CriticalSpeeds;

    fn fits(&self, run: &Run) -> Result<(), StudyError> {
        refuse_other_bogie(run)
    }

    fn answer(
        &self,
        _run: &Run,
        equipped: &Equipped<'_>,
        _own: Option<f64>,
        answer: &mut CriticalSpeeds,
    ) -> Result<(), StudyError> {
        answer.equivalent_conicity_at_3_mm = conicity(equipped);
        answer.friction = equipped.vehicle.axles.first().map(|axle| axle.wheel.friction);
        if self.ascent {
            let ascent = Ascent::of(equipped, &self.procedure)?;
            answer.ascent = Some(ascent);
        }
        if self.fold {
            let fold = Fold::of(equipped, &self.procedure)?;
            answer.fold = Some(fold);
        }
        answer.linear = LinearSpeed::at_strokes(equipped, &self.procedure, &self.strokes_m)?;
        Ok(())
    }

    fn text(&self, points: &[Point]) -> String {
        text(points, &self.procedure)
    }

    fn page(&self, points: &[Point], report: Report) -> Report {
        page(points, &self.procedure, report)
    }
}

/// Equivalent conicity at 3 mm of profiles, or the conicity of a cone.
fn conicity(equipped: &Equipped<'_>) -> Option<f64> {
    match (equipped.contact.as_ref(), equipped.vehicle.axles.first()?.wheel.surface) {
        (Some(contact), Surface::Profiles) => {
            RollingRadiusDifference::of_wheelset(&contact.pair, REACH_M)
                .integrated_conicity(CONICITY_AT_M)
        }
        (_, Surface::Conical(cone)) => Some(cone.conicity),
        (None, Surface::Profiles) => None,
    }
}
