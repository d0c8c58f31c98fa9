//! The curving of a scenario at every point of a grid.

use super::answer::{CurveAnswer, Point};
use super::assessment::{Curve, duration_s};
use super::page::page;
use super::procedure::Procedure;
use super::sections::{Part, sections};
use super::text::text;
use crate::error::StudyError;
use crate::study::Study;
use crate::trip::Equipped;
use report::Report;
use scenario::run::Run;

impl Study for Procedure {
    const NAME: &'static str = "curve";
    const ANSWERS: &'static str = "curves";
    type Answer = CurveAnswer;

    fn duration_s(&self, run: &Run) -> f64 {
        duration_s(run)
    }

    fn fits(&self, run: &Run) -> Result<(), StudyError> {
        let curved = sections(&run.track.layout).iter().any(|section| section.part == Part::Curve);
        curved.then_some(()).ok_or(StudyError::NoCurve)
    }

    fn answer(
        &self,
        run: &Run,
        equipped: &Equipped<'_>,
        _own: Option<f64>,
        answer: &mut CurveAnswer,
    ) -> Result<(), StudyError> {
        answer.curve = Some(Curve::of(run, equipped, self)?);
        Ok(())
    }

    fn text(&self, points: &[Point]) -> String {
        text(points, self)
    }

    fn page(&self, points: &[Point], report: Report) -> Report {
        page(points, self, report)
    }
}
