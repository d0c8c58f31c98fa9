//! The ride of a scenario at every point of a grid.

use super::answer::{Point, RideAnswer};
use super::assessment::Ride;
use super::page::page;
use super::procedure::Procedure;
use super::text::text;
use crate::error::StudyError;
use crate::one_force::refuse_other_bogie;
use crate::study::Study;
use crate::trip::Equipped;
use report::Report;
use scenario::run::Run;

impl Study for Procedure {
    const NAME: &'static str = "ride";
    const ANSWERS: &'static str = "rides";
    type Answer = RideAnswer;

    fn duration_s(&self, _run: &Run) -> f64 {
        self.run_in_s + self.section_s
    }

    fn fits(&self, run: &Run) -> Result<(), StudyError> {
        refuse_other_bogie(run)?;
        if !run.body_names.iter().any(|name| name == "carbody") {
            return Err(StudyError::NoBody("carbody", run.body_names.clone()));
        }
        let perfect = run.band.is_none() && run.track.samples.samples.is_empty();
        if perfect { Err(StudyError::NoIrregularity) } else { Ok(()) }
    }

    fn answer(
        &self,
        run: &Run,
        equipped: &Equipped<'_>,
        _own: Option<f64>,
        answer: &mut RideAnswer,
    ) -> Result<(), StudyError> {
        answer.ride = Some(Ride::of(run, equipped, self)?);
        Ok(())
    }

    fn text(&self, points: &[Point]) -> String {
        text(points, self)
    }

    fn page(&self, points: &[Point], report: Report) -> Report {
        page(points, self, report)
    }
}
