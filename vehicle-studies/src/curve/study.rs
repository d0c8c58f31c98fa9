//! The curving of a scenario at every point of a grid.

use super::assessment::{Curve, duration_s};
use super::page::page;
use super::procedure::Procedure;
use super::sections::{Part, sections};
use super::text::text;
use crate::study::{self, Study};
use crate::trip::Equipped;
use report::Report;
use scenario::run::Run;
use serde::{Deserialize, Serialize};

/// A point of the grid and the curving there.
pub type Point = study::Point<Found>;

/// What was found at a point.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Found {
    /// The curving.
    pub curve: Option<Curve>,
}

impl Study for Procedure {
    const CALLED: &'static str = "curve";
    const ANSWERS: &'static str = "curves";
    type Found = Found;

    fn duration_s(&self, run: &Run) -> f64 {
        duration_s(run)
    }

    fn fits(&self, run: &Run) -> Result<(), String> {
        let curved = sections(&run.track.layout).iter().any(|section| section.part == Part::Curve);
        curved
            .then_some(())
            .ok_or_else(|| "the track has no curve, expected [track.curve]".to_owned())
    }

    fn answer(&self, run: &Run, equipped: &Equipped, found: &mut Found) -> Result<(), String> {
        found.curve = Some(Curve::of(run, equipped, self)?);
        Ok(())
    }

    fn text(&self, points: &[Point]) -> String {
        text(points, self)
    }

    fn page(&self, points: &[Point], report: Report) -> Report {
        page(points, self, report)
    }
}
