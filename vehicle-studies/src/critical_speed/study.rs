//! Critical speeds of a scenario at every point of a grid.

use super::ascent::Ascent;
use super::fold::Fold;
use super::linear::LinearSpeed;
use super::page::page;
use super::procedure::Procedure;
use super::text::text;
use crate::study::{self, Study};
use crate::trip::Equipped;
use firmware_core::wheel_rail::wheel::Surface;
use report::Report;
use scenario::conicity::RollingRadiusDifference;
use scenario::run::Run;
use serde::{Deserialize, Serialize};

/// Amplitude at which equivalent conicity is told (m).
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

/// A point of the grid and its critical speeds.
pub type Point = study::Point<Found>;

/// What was found at a point.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Found {
    /// Equivalent conicity at 3 mm (UIC 519), or that of the cone.
    pub equivalent_conicity_at_3_mm: Option<f64>,
    /// Coefficient of friction.
    pub friction: Option<f64>,
    /// Over irregular track.
    pub ascent: Option<Ascent>,
    /// Down the limit cycle.
    pub fold: Option<Fold>,
    /// By eigenvalues, for every stroke.
    pub linear: Vec<LinearSpeed>,
}

impl Study for Question {
    const CALLED: &'static str = "critical-speed";
    const ANSWERS: &'static str = "critical speeds";
    type Found = Found;

    fn answer(&self, _run: &Run, equipped: &Equipped, found: &mut Found) -> Result<(), String> {
        found.equivalent_conicity_at_3_mm = conicity(equipped);
        found.friction = equipped.vehicle.axles.first().map(|axle| axle.wheel.friction);
        if self.ascent {
            let ascent = Ascent::of(equipped, &self.procedure)?;
            found.ascent = Some(ascent);
        }
        if self.fold {
            let fold = Fold::of(equipped, &self.procedure).map_err(|why| why.to_string())?;
            found.fold = Some(fold);
        }
        let linear = |stroke_m: &f64| LinearSpeed::of(equipped, &self.procedure, *stroke_m);
        found.linear = self.strokes_m.iter().map(linear).collect();
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
fn conicity(equipped: &Equipped) -> Option<f64> {
    match (equipped.contact.as_ref(), equipped.vehicle.axles.first()?.wheel.surface) {
        (Some(contact), Surface::Profiles) => {
            RollingRadiusDifference::of_wheelset(&contact.pair, REACH_M)
                .integrated_conicity(CONICITY_AT_M)
        }
        (_, Surface::Conical(cone)) => Some(cone.conicity),
        (None, Surface::Profiles) => None,
    }
}
