//! The ride of a scenario at every point of a grid.

use super::assessment::Ride;
use super::page::page;
use super::procedure::Procedure;
use super::text::text;
use crate::study::{self, Study};
use crate::trip::Equipped;
use report::Report;
use scenario::run::Run;
use serde::{Deserialize, Serialize};

/// A point of the grid and the ride there.
pub type Point = study::Point<Found>;

/// What was found at a point.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Found {
    /// The ride.
    pub ride: Option<Ride>,
}

impl Study for Procedure {
    const CALLED: &'static str = "ride";
    const ANSWERS: &'static str = "rides";
    type Found = Found;

    fn duration_s(&self, _run: &Run) -> f64 {
        self.run_in_s + self.section_s
    }

    fn fits(&self, run: &Run) -> Result<(), String> {
        if !run.body_names.iter().any(|name| name == "carbody") {
            return Err(format!(
                "no body is named \"carbody\", found {}",
                run.body_names.join(", ")
            ));
        }
        let perfect = run.band.is_none() && run.track.samples.samples.is_empty();
        let refused = || "the track has no irregularity, expected [track.irregularity]".to_owned();
        if perfect { Err(refused()) } else { Ok(()) }
    }

    fn answer(&self, run: &Run, equipped: &Equipped, found: &mut Found) -> Result<(), String> {
        found.ride = Some(Ride::of(run, equipped, self)?);
        Ok(())
    }

    fn text(&self, points: &[Point]) -> String {
        text(points, self)
    }

    fn page(&self, points: &[Point], report: Report) -> Report {
        page(points, self, report)
    }
}
