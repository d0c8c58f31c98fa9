//! A question about a vehicle, asked at every point of a grid of its numbers.
//!
//! A study reads its scenario at every point before it begins, so that what cannot run is known
//! before anything is written. Its identity holds the question, the content of every file that was
//! read and the sources of the program, so that answers to anything else are never mistaken for its
//! own. A point whose files have changed since is an error. Points are independent: any number of
//! cores and shards gives the same answers.

use crate::error::StudyError;
use crate::grid::Grid;
use crate::point::GridPoint;
use crate::trip::{Equipped, Together};
use files::Identity;
use rayon::prelude::*;
use report::Report;
use scenario::run::{Overrides, Run};
use scenario::setting::Setting;
use scenario::source::ScenarioError;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Hash over the sources of the crates that compute the answers, made by the build script.
pub(crate) const PROGRAM: &str = env!("VEHICLE_STUDIES_SOURCES");

/// A question about a vehicle: how it is asked, what the answer is and how it is shown. Serialised,
/// it is every number that the answers depend on apart from the scenario and its grid.
pub trait Study: Debug + Serialize + Sync {
    /// Its name: of the command, the folder and the file.
    const NAME: &'static str;
    /// What answers are called.
    const ANSWERS: &'static str;
    /// Key of an axis of the grid that belongs to the question and not to the scenario.
    const OWN_KEY: Option<&'static str> = None;
    /// The answer at a point; its default is none.
    type Answer: Serialize + DeserializeOwned + Default + Clone + PartialEq + Send + Sync;

    /// How long the vehicle runs on each track (s); it matters for a measured track only.
    fn duration_s(&self, _run: &Run) -> f64 {
        1.0
    }

    /// Refuses a scenario that the question does not fit.
    ///
    /// # Errors
    /// What the scenario lacks.
    fn fits(&self, _run: &Run) -> Result<(), StudyError> {
        Ok(())
    }

    /// Finds the answer for the scenario of a point; `own` is the value at the question's own key.
    ///
    /// # Errors
    /// Why there is none; the parts of `answer` that were found before stay.
    fn answer(
        &self,
        run: &Run,
        equipped: &Equipped<'_>,
        own: Option<f64>,
        answer: &mut Self::Answer,
    ) -> Result<(), StudyError>;

    /// The answers as a table for a terminal, with the conditions under which they hold.
    fn text(&self, points: &[GridPoint<Self::Answer>]) -> String;

    /// The report of the answers, after its title and facts.
    fn page(&self, points: &[GridPoint<Self::Answer>], report: Report) -> Report;
}

/// A scenario and the grid over which its keys are varied.
#[derive(Debug, Clone, PartialEq)]
pub struct Varied {
    /// The scenario.
    pub scenario: PathBuf,
    /// Its points.
    pub grid: Grid,
}

impl Varied {
    /// The scenario at a point, with one second of its random track, since studies lay their own.
    /// A measured track has to reach as far as the study goes (s). The axis of `own_key` is not one
    /// of the scenario.
    ///
    /// # Errors
    /// A scenario that cannot be read or does not hold at the point.
    pub fn run(
        &self,
        index: usize,
        own_key: Option<&str>,
        duration_s: impl Fn(&Run) -> f64,
    ) -> Result<Run, ScenarioError> {
        let mut settings = self.grid.point(index);
        settings.retain(|setting| own_key != Some(setting.key.as_str()));
        let load = |duration_s: f64| {
            let overrides = Overrides { duration_s: Some(duration_s), ..Overrides::default() };
            Run::load_as_fine_as_needed(&self.scenario, overrides, &settings)
        };
        let short = load(1.0)?;
        let measured = short.band.is_none() && !short.track.samples.samples.is_empty();
        if measured { load(duration_s(&short)) } else { Ok(short) }
    }
}

/// A question asked about a scenario at every point of its grid.
#[derive(Debug, Clone, PartialEq)]
pub struct VariedStudy<S> {
    /// The scenario and its grid.
    pub varied: Varied,
    /// The question.
    pub study: S,
}

/// What an identity holds of the question.
#[derive(Serialize)]
struct QuestionForm<'a, S> {
    study: &'static str,
    /// Axis by axis, the slowest first.
    vary: Vec<Vec<Setting>>,
    question: &'a S,
}

impl<S: Study> VariedStudy<S> {
    /// Reads the scenario at every point; gives the identity of the study.
    ///
    /// # Errors
    /// The first point that cannot run.
    pub fn identity(&self) -> Result<Identity, StudyError> {
        let Self { varied, study } = self;
        let at = |index: usize| -> Result<BTreeMap<String, String>, StudyError> {
            let run = varied.run(index, S::OWN_KEY, |run| study.duration_s(run))?;
            let in_file = |why| StudyError::InFile(varied.scenario.clone(), Box::new(why));
            study.fits(&run).map_err(in_file)?;
            Ok(run.inputs)
        };
        let points: Vec<_> = (0..varied.grid.len()).into_par_iter().map(at).collect();
        let mut points = points.into_iter();
        // A grid has at least one point.
        let inputs = points.next().transpose()?.unwrap_or_default();
        for point in points {
            self.refuse_changed(&inputs, &point?)?;
        }
        let vary = varied.grid.axes.iter().map(|axis| axis.settings().collect()).collect();
        let question = QuestionForm { study: S::NAME, vary, question: study };
        Identity::new(&question, inputs, PROGRAM)
            .map_err(|why| StudyError::NotSerialised(why.to_string()))
    }

    /// The name of the study of an identity.
    pub fn name(&self, identity: &Identity) -> String {
        format!("{} {}, study {}", self.varied.grid.len(), S::ANSWERS, identity.name())
    }

    /// Finds the answer at a point; the files are read again. A point that has no answer holds the
    /// reason instead. None once `stop` is set.
    ///
    /// # Errors
    /// The files are not those of the identity any more.
    pub fn point(
        &self,
        identity: &Identity,
        index: usize,
        stop: &AtomicBool,
    ) -> Result<Option<GridPoint<S::Answer>>, StudyError> {
        self.point_of(identity, index, stop, None)
    }

    /// The same while other points are at work: trips of all of them share batches.
    ///
    /// # Errors
    /// As for [`VariedStudy::point`].
    pub fn point_among_others(
        &self,
        identity: &Identity,
        index: usize,
        stop: &AtomicBool,
        together: &Arc<Together>,
    ) -> Result<Option<GridPoint<S::Answer>>, StudyError> {
        self.point_of(identity, index, stop, Some(together))
    }

    fn point_of(
        &self,
        identity: &Identity,
        index: usize,
        stop: &AtomicBool,
        together: Option<&Arc<Together>>,
    ) -> Result<Option<GridPoint<S::Answer>>, StudyError> {
        debug_assert!(index < self.varied.grid.len(), "{index} lies outside the grid");
        let Self { varied, study } = self;
        let run = varied.run(index, S::OWN_KEY, |run| study.duration_s(run))?;
        self.refuse_changed(&identity.inputs, &run.inputs)?;
        let (at, mut answer) = (varied.grid.point(index), S::Answer::default());
        let mut pace = None;
        let mut find = || -> Result<(), StudyError> {
            let mut equipped = Equipped::of(&run)?.until(stop);
            if let Some(together) = together {
                equipped = equipped.with_others(together);
            }
            let own = at.iter().find(|setting| S::OWN_KEY == Some(setting.key.as_str()));
            let own = own.map(Setting::number);
            let found = study.answer(&run, &equipped, own, &mut answer);
            pace = equipped.pace();
            found
        };
        let failure = match find() {
            Err(StudyError::Stopped) => return Ok(None),
            found => found.err().map(|why| why.to_string()),
        };
        let study = self.name(identity);
        Ok(Some(GridPoint { index, study, at, answer, failure, pace }))
    }

    fn refuse_changed(
        &self,
        before: &BTreeMap<String, String>,
        now: &BTreeMap<String, String>,
    ) -> Result<(), StudyError> {
        if before == now {
            return Ok(());
        }
        let changed = now.iter().filter(|(role, hash)| before.get(*role) != Some(*hash));
        let gone = before.keys().filter(|role| !now.contains_key(*role));
        let changes = changed.map(|(role, _)| role).chain(gone).cloned().collect();
        Err(StudyError::Changed(self.varied.scenario.clone(), changes))
    }
}
