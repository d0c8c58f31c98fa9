//! The residual of a model: noise, or structure.
//!
//! Seven questions, each answered against chance with independent stretches of record:
//!
//! | question | file | needs |
//! | --- | --- | --- |
//! | does it repeat from cycle to cycle? | [`repeat`] | cycles |
//! | has it a shape over a coordinate that holds on left-out tests? | [`maps`] | |
//! | has its spectrum lines? | [`lines`] | |
//! | does it follow the motion? | [`motion`] | parts to leave out |
//! | does its size follow the force? | [`size`] | a force that changes its size |
//! | is much of it in a few short stretches? | [`bursts`] | |
//! | is a constant under it? | [`super::batches`] | |
//!
//! None of them needs a noise floor ([`noise`]). Where the floor is known, a structure below a
//! quarter of it is not reported; where it is unknown, only the models' own errors (two
//! ten-thousandths of the force, from steps, interpolation and bounds) hide a structure. A residual
//! is noise where every answer is no. A cycle that is unlike all others ([`unlike`]) is a fault of
//! the record.

mod between_cycles;
mod bursts;
pub(crate) mod coordinates;
mod cycles;
mod features;
mod judgement;
pub(crate) mod lines;
mod lone_test;
pub(crate) mod maps;
pub(crate) mod motion;
pub(crate) mod noise;
pub(crate) mod question;
mod ranks;
pub(crate) mod repeat;
mod same_motion;
pub(crate) mod size;
mod slow;
pub(crate) mod unlike;

use super::batches::{self, Constant};
use super::fit::Fit;
use super::test_set::TestSet;
use bursts::Bursts;
use coordinates::{Coordinate, Track};
pub(crate) use judgement::Unexplained;
use lines::Line;
use maps::CoordinateMap;
use motion::Motion;
use noise::NoiseFloor;
use rayon::prelude::*;
use repeat::Repeat;
use size::Size;

/// The residual of a model in all respects.
#[derive(Debug, Clone)]
pub struct ResidualAnalysis {
    /// rms of the residual, N.
    pub rms_n: f64,
    /// The same without its part that is slower than the motion.
    pub without_slow_rms_n: f64,
    /// The same over the rms force.
    pub share_of_force: f64,
    /// What is known about the noise.
    pub noise: NoiseFloor,
    /// Maps over every coordinate that was measured, the one that explains most first.
    pub maps: Vec<CoordinateMap>,
    /// The part that repeats from cycle to cycle.
    pub repeat: Repeat,
    /// Tones and bands.
    pub lines: Vec<Line>,
    /// Whether it follows the motion.
    pub motion: Motion,
    /// Whether its size follows the force.
    pub size: Size,
    /// Short stretches that hold much of it.
    pub bursts: Option<Bursts>,
    /// The constant in it.
    pub constant: Constant,
    /// The structure, if there is any.
    pub unexplained: Option<Unexplained>,
}

impl ResidualAnalysis {
    /// Analyses the residual of a fitted model.
    pub fn new(fit: &Fit, tests: &TestSet) -> Option<Self> {
        let damper = fit.model.damper(&fit.values)?;
        let tracks: Vec<Track> = tests
            .tests
            .par_iter()
            .zip(&fit.starts_m)
            .map(|(test, start_m)| Track::simulate(&damper, test, *start_m))
            .collect();
        let residual_n: Vec<Vec<f64>> =
            (0..tests.tests.len()).map(|test| fit.residual_n(tests, test)).collect();
        let mut maps: Vec<CoordinateMap> = Coordinate::ALL
            .into_par_iter()
            .filter_map(|coordinate| maps::map(coordinate, &tracks, &residual_n, tests))
            .collect();
        maps.sort_by(|a, b| b.share.total_cmp(&a.share));
        let repeat = repeat::repeat(&residual_n, tests);
        let lines = lines::lines(&residual_n, tests);
        let size = size::size(fit, &residual_n, tests)?;
        let lines_n = lines::pooled(&lines, tests);
        let noise = NoiseFloor::of(&residual_n, (&repeat, &size), lines_n, tests);
        let rms_n = fit.rms_n(tests);
        let mut analysis = Self {
            rms_n,
            share_of_force: rms_n / tests.rms_force_n().max(f64::MIN_POSITIVE),
            without_slow_rms_n: slow::rms_without_slow_n(&residual_n, tests),
            noise,
            maps,
            repeat,
            lines,
            motion: motion::motion(fit, tests),
            size,
            bursts: bursts::bursts(&residual_n, tests),
            constant: batches::constant(&residual_n, tests),
            unexplained: None,
        };
        analysis.unexplained = judgement::judge(&analysis, &residual_n, tests);
        Some(analysis)
    }

    /// The same, with something unexplained that the training tests do not show, if they show
    /// nothing themselves.
    pub(crate) fn or_unexplained(self, other: impl FnOnce() -> Option<Unexplained>) -> Self {
        let unexplained = self.unexplained.or_else(other);
        Self { unexplained, ..self }
    }

    /// The reason why these records cannot show that nothing is missing, if there is one.
    pub(crate) fn not_judged(&self) -> Option<String> {
        judgement::not_judged(self)
    }

    /// A remark about a residual that is no noise and follows nothing.
    pub(crate) fn remark(&self) -> Option<String> {
        judgement::remark(self)
    }
}
