//! Critical speeds of a scenario at every point of a grid.

use super::ascent::Ascent;
use super::fold::Fold;
use super::linear::LinearSpeed;
use super::procedure::Procedure;
use crate::fnv;
use crate::shards::Item;
use crate::sweep::Grid;
use crate::trip::Equipped;
use firmware_core::wheel_rail::wheel::Surface;
use scenario::conicity::RollingRadiusDifference;
use scenario::run::{Overrides, Run};
use scenario::setting::Setting;
use scenario::source::ScenarioError;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Amplitude at which equivalent conicity is told (m).
const CONICITY_AT_M: f64 = 3e-3;
/// Lateral reach of the rolling radius difference that it is found from (m).
const REACH_M: f64 = 6e-3;

/// What is asked.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// The scenario.
    pub scenario: PathBuf,
    /// Its points.
    pub grid: Grid,
    /// How stability is asked for.
    pub procedure: Procedure,
    /// Over irregular track.
    pub ascent: bool,
    /// Down the limit cycle.
    pub fold: bool,
    /// Strokes of the dampers for eigenvalues (m); none for no eigenvalues.
    pub strokes_m: Vec<f64>,
}

/// What was found at a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Its number.
    pub index: usize,
    /// The study that it belongs to.
    pub study: String,
    /// Keys that were varied and their values here.
    pub at: Vec<Setting>,
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
    /// Why there is no answer.
    pub failure: Option<String>,
}

impl Item for Point {
    const CALLED: &'static str = "point";
    const MANY: &'static str = "points";

    fn index(&self) -> usize {
        self.index
    }

    fn work(&self) -> String {
        self.study.clone()
    }
}

impl Question {
    /// Reads the scenario at every point, so that what cannot run is known before the work; gives the
    /// name of the study, which holds everything that its answer depends on.
    ///
    /// # Errors
    /// The first point that cannot be.
    pub fn check(&self) -> Result<String, ScenarioError> {
        let mut hash = fnv::START;
        let mut add = |text: &str| hash = text.bytes().fold(hash, |h, b| fnv::add(h, b.into()));
        for index in 0..self.grid.len() {
            let run = self.run(index)?;
            add(&run.effective.scenario);
            add(&run.effective.vehicle);
        }
        add(&format!("{self:?}"));
        let points = self.grid.len();
        let name = self.scenario.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(format!("{points} critical speeds of {name}, study {hash:016x}"))
    }

    /// Finds the answer at a point.
    pub fn point(&self, study: &str, index: usize) -> Point {
        let mut point = Point {
            index,
            study: study.to_owned(),
            at: self.grid.point(index),
            equivalent_conicity_at_3_mm: None,
            friction: None,
            ascent: None,
            fold: None,
            linear: Vec::new(),
            failure: None,
        };
        if let Err(why) = self.answer(&mut point) {
            point.failure = Some(why);
        }
        point
    }

    fn answer(&self, point: &mut Point) -> Result<(), String> {
        let run = self.run(point.index).map_err(|why| why.to_string())?;
        let equipped = Equipped::of(&run).map_err(|why| why.to_string())?;
        point.equivalent_conicity_at_3_mm = conicity(&equipped);
        point.friction = equipped.vehicle.axles.first().map(|axle| axle.wheel.friction);
        if self.ascent {
            let found = Ascent::of(&equipped, &self.procedure).map_err(|why| why.to_string())?;
            point.ascent = Some(found);
        }
        if self.fold {
            let found = Fold::of(&equipped, &self.procedure).map_err(|why| why.to_string())?;
            point.fold = Some(found);
        }
        let linear = |stroke_m: &f64| LinearSpeed::of(&equipped, &self.procedure, *stroke_m);
        point.linear = self.strokes_m.iter().map(linear).collect();
        Ok(())
    }

    fn run(&self, index: usize) -> Result<Run, ScenarioError> {
        // Track and duration of the scenario do not matter: the study has its own.
        let overrides = Overrides { duration_s: Some(1.0), speed_kmh: None };
        Run::load_with(&self.scenario, overrides, &self.grid.point(index))
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
