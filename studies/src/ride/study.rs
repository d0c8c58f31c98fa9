//! The ride of a scenario at every point of a grid.

use super::assessment::Ride;
use super::page::page;
use super::procedure::Procedure;
use super::text::text;
use crate::study::{self, Study, Varied};
use crate::trip::Equipped;
use report::Report;
use scenario::run::Run;
use serde::{Deserialize, Serialize};

/// What is asked.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// The scenario and its points; its layout and duration do not matter.
    pub varied: Varied,
    /// How ride is asked for.
    pub procedure: Procedure,
}

/// A point of the grid and the ride there.
pub type Point = study::Point<Found>;

/// What was found at a point.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Found {
    /// The ride.
    pub ride: Option<Ride>,
}

impl Study for Question {
    const CALLED: &'static str = "ride";
    const ANSWERS: &'static str = "rides";
    type Found = Found;
    type Procedure = Procedure;

    fn varied(&self) -> &Varied {
        &self.varied
    }

    fn procedure(&self) -> &Procedure {
        &self.procedure
    }

    fn duration_s(&self, _run: &Run) -> f64 {
        self.procedure.run_in_s + self.procedure.section_s
    }

    fn fits(&self, run: &Run) -> Result<(), String> {
        let known = run.body_names.iter().any(|name| name == "carbody");
        known.then_some(()).ok_or_else(|| {
            format!("no body is named \"carbody\", found {}", run.body_names.join(", "))
        })
    }

    fn answer(&self, run: &Run, equipped: &Equipped, found: &mut Found) -> Result<(), String> {
        found.ride = Some(Ride::of(run, equipped, &self.procedure)?);
        Ok(())
    }

    fn text(&self, points: &[Point]) -> String {
        text(points, &self.procedure)
    }

    fn page(&self, points: &[Point], report: Report) -> Report {
        page(points, &self.procedure, report)
    }
}
