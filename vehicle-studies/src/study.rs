//! A question about a vehicle, asked at every point of a grid of its numbers.
//!
//! A study reads its scenario at every point before it begins, so that what cannot run is known before
//! anything is written. Its name is a hash of all that its answers depend on, so that points of another
//! study are never taken for its own. Points are independent: any cores and any shards give the same.

use crate::sweep::Grid;
use crate::trip::Equipped;
use crate::trip::pace::Pace;
use firmware_core::fnv;
use rayon::prelude::*;
use report::Report;
use scenario::run::{Overrides, Run};
use scenario::setting::Setting;
use scenario::source::ScenarioError;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use signal::shards::Item;
use signal::statistics;
use std::fmt::Debug;
use std::path::PathBuf;

/// A scenario and the grid over which its keys are varied.
#[derive(Debug, Clone, PartialEq)]
pub struct Varied {
    /// The scenario.
    pub scenario: PathBuf,
    /// Its points.
    pub grid: Grid,
}

impl Varied {
    /// The scenario at a point, with a second of its random track: studies lay their own. A measured
    /// track has to reach as far as the study goes (s).
    ///
    /// # Errors
    /// A point that cannot be.
    pub fn run(
        &self,
        index: usize,
        duration_s: impl Fn(&Run) -> f64,
    ) -> Result<Run, ScenarioError> {
        let settings = self.grid.point(index);
        let load = |duration_s: f64| {
            let overrides = Overrides { duration_s: Some(duration_s), speed_kmh: None };
            Run::load_as_fine_as_needed(&self.scenario, overrides, &settings)
        };
        let short = load(1.0)?;
        let measured = short.band.is_none() && !short.track.samples.samples.is_empty();
        if measured { load(duration_s(&short)) } else { Ok(short) }
    }

    /// Name of the scenario's file.
    pub fn file_name(&self) -> String {
        self.scenario.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }
}

/// A question about a vehicle: how it is asked, what is found, how that is told. Written out, it is every
/// number that the answers depend on beside the scenario.
pub trait Study: Debug + Serialize + Sync {
    /// What it is called: its command, its folder, its file.
    const CALLED: &'static str;
    /// What many answers are called.
    const ANSWERS: &'static str;
    /// What is found at a point; its default is nothing.
    type Found: Serialize + DeserializeOwned + Default + Clone + PartialEq + Send + Sync;

    /// How long the vehicle runs on each track (s); only a measured track asks.
    fn duration_s(&self, _run: &Run) -> f64 {
        1.0
    }

    /// Refuses a scenario that the question does not fit.
    ///
    /// # Errors
    /// In one line what is missing.
    fn fits(&self, _run: &Run) -> Result<(), String> {
        Ok(())
    }

    /// Finds the answer for the scenario of a point.
    ///
    /// # Errors
    /// In one line why there is none; what was found before it stays.
    fn answer(&self, run: &Run, equipped: &Equipped, found: &mut Self::Found)
    -> Result<(), String>;

    /// The answers as a table for a terminal, and under which conditions they hold.
    fn text(&self, points: &[Point<Self::Found>]) -> String;

    /// The report of the answers, behind its title and facts.
    fn page(&self, points: &[Point<Self::Found>], report: Report) -> Report;
}

/// A question put to a scenario and its points.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked<S> {
    /// The scenario and its points.
    pub varied: Varied,
    /// The question.
    pub study: S,
}

impl<S: Study> Asked<S> {
    /// Reads the scenario at every point; gives the name of the study.
    ///
    /// # Errors
    /// The first point that cannot be.
    pub fn check(&self) -> Result<String, ScenarioError> {
        let Self { varied, study } = self;
        let add = |hash: u64, text: &str| text.bytes().fold(hash, |h, b| fnv::add(h, b.into()));
        let at = |index: usize| -> Result<u64, ScenarioError> {
            let run = varied.run(index, |run| study.duration_s(run))?;
            study
                .fits(&run)
                .map_err(|message| ScenarioError::mismatch(&varied.scenario, message))?;
            Ok(add(add(fnv::START, &run.effective.scenario), &run.effective.vehicle))
        };
        let points: Vec<_> = (0..varied.grid.len()).into_par_iter().map(at).collect();
        let mut hash = add(fnv::START, &format!("{self:?}"));
        for point in points {
            hash = fnv::add(hash, point?);
        }
        let (points, file) = (varied.grid.len(), varied.file_name());
        Ok(format!("{points} {} of {file}, study {hash:016x}", S::ANSWERS))
    }

    /// Finds the answer at a point of the study of a name.
    pub fn point(&self, name: &str, index: usize) -> Point<S::Found> {
        let Self { varied, study } = self;
        let mut found = S::Found::default();
        let mut pace = None;
        let mut answer = || -> Result<(), String> {
            let run = varied.run(index, |run| study.duration_s(run));
            let run = run.map_err(|why| why.to_string())?;
            let equipped = Equipped::of(&run).map_err(|why| why.to_string())?;
            let answer = study.answer(&run, &equipped, &mut found);
            pace = equipped.pace();
            answer
        };
        let failure = answer().err();
        Point { index, study: name.to_owned(), at: varied.grid.point(index), found, failure, pace }
    }
}

/// What was found at a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Point<F> {
    /// Its number.
    pub index: usize,
    /// The study that it belongs to.
    pub study: String,
    /// Keys that were varied and their values here.
    pub at: Vec<Setting>,
    /// What was found.
    #[serde(flatten)]
    pub found: F,
    /// Why there is no answer.
    pub failure: Option<String>,
    /// How fast its trips were; in the file of a shard only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pace: Option<Pace>,
}

impl<F> Point<F> {
    /// Its keys and values in words, or a name for the only point.
    pub fn in_words(&self, only: &str) -> String {
        if self.at.is_empty() {
            return only.to_owned();
        }
        let keys = self.at.iter().map(Setting::called);
        let words = keys.zip(self.values_in_words()).map(|(key, value)| format!("{key} {value}"));
        words.collect::<Vec<_>>().join(", ")
    }

    /// The values of its keys to six digits, as one would write them.
    pub fn values_in_words(&self) -> Vec<String> {
        let word = |value: f64| {
            let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
            let plain = rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs());
            if plain { rounded.to_string() } else { format!("{rounded:e}") }
        };
        self.at.iter().map(|set| word(set.number())).collect()
    }
}

impl<F> Item for Point<F>
where
    F: Serialize + DeserializeOwned + Clone + PartialEq + Send + Sync,
{
    const CALLED: &'static str = "point";
    const MANY: &'static str = "points";

    fn index(&self) -> usize {
        self.index
    }

    fn work(&self) -> String {
        self.study.clone()
    }

    fn lasting(&self) -> Self {
        Self { pace: None, ..self.clone() }
    }
}

/// How fast the trips of all points were, in words; none where no time was kept.
pub fn pace<F>(points: &[Point<F>]) -> Option<String> {
    Pace::over(points.iter().filter_map(|point| point.pace)).map(|pace| pace.in_words())
}

/// A quantity over the tracks of several seeds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OverSeeds {
    /// Mean.
    pub mean: f64,
    /// Lowest.
    pub lowest: f64,
    /// Highest.
    pub highest: f64,
}

impl OverSeeds {
    /// Of one value a seed; none without any.
    ///
    /// ```
    /// let over = vehicle_studies::study::OverSeeds::of([1.0, 4.0, 1.0]).unwrap();
    /// assert_eq!((over.mean, over.lowest, over.highest), (2.0, 1.0, 4.0));
    /// ```
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.into_iter().collect();
        let (lowest, highest) = statistics::min_max(&values)?;
        Some(Self { mean: statistics::mean(&values), lowest, highest })
    }
}

/// Seeds in words.
///
/// ```
/// assert_eq!(crate::study::seeds_in_words(&[1, 2, 3]), "1 to 3");
/// assert_eq!(crate::study::seeds_in_words(&[7]), "7");
/// ```
pub fn seeds_in_words(seeds: &[u64]) -> String {
    match (seeds.first(), seeds.last()) {
        (Some(first), Some(last)) if first != last => format!("{first} to {last}"),
        (Some(first), _) => first.to_string(),
        _ => "none".to_owned(),
    }
}

/// Rows as lines with aligned columns, the first row as heads; failures of points below them.
pub fn table<F>(rows: &[Vec<String>], points: &[Point<F>]) -> Vec<String> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max()
    };
    let widths: Vec<usize> = (0..columns).filter_map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}"));
        cells.collect::<Vec<_>>().join("   ")
    };
    let mut lines: Vec<String> = rows.iter().map(line).collect();
    let failures =
        points.iter().filter_map(|point| Some((point.index + 1, point.failure.as_ref()?)));
    lines.extend(failures.map(|(number, why)| format!("point {number}: {why}")));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_written_as_a_person_would() {
        let set = |value: f64| Setting::to("k", value);
        let point = Point {
            index: 0,
            study: String::new(),
            at: [0.2e-3, 80.0 + 100.0 / 3.0, 12.5e6, 0.0, -3e-5].map(set).to_vec(),
            found: (),
            failure: None,
            pace: None,
        };
        assert_eq!(point.values_in_words(), ["0.0002", "113.333", "1.25e7", "0", "-3e-5"]);
        assert!(point.in_words("only").starts_with("k 0.0002, k 113.333"));
    }
}
