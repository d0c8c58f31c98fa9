//! A smooth map over one coordinate of the final residual: empirical, no physics.
//!
//! ```text
//! y = F + m_s(q)        q, s: coordinate and sense of motion of the damper that was found
//! ```
//!
//! The coordinates are tried in the order of what they explain, those that a damper knows while it
//! runs: displacement, dashpot velocity, force, time since reversal. Coordinate and branch come
//! from simulating the damper itself, so the map that is fitted (`smooth`) is the one that
//! `simulate` runs. Each piece is judged with a model and a map that have not seen it; the criteria
//! are those for an effect, except significance, since a map claims nothing. The first map that
//! gains is taken, and kept if it is no worse on the tests held out.
//!
//! Limits: the map does not say what causes it, and is valid inside the range of the records only.
//! The coordinate of a left-out piece is that of the damper fitted to all pieces.

mod smooth;

use super::acceptance::{too_little, too_seldom};
use super::evidence::improved;
use super::fit::Fit;
use super::judged::Judged;
use super::residual::ResidualAnalysis;
use super::residual::coordinates::UNDER_WAY;
use super::simulation::{simulate, start_deflection_m, walk};
use super::test_set::TestSet;
use firmware_core::damper::{Damper, EmpiricalMap, MapCoordinate, MapKnot};
use rayon::prelude::*;
use smooth::{Along, Piece};
use std::ops::ControlFlow;

/// A map that was asked for, kept or not.
#[derive(Debug, Clone)]
pub struct Empirical {
    /// It is kept.
    pub kept: bool,
    /// The reason.
    pub why: String,
    /// The map that was fitted, if any could be.
    pub fitted: Option<FittedMap>,
}

/// A map fitted to the residual.
#[derive(Debug, Clone)]
pub struct FittedMap {
    /// The map.
    pub map: EmpiricalMap,
    /// The damper that was found, with the map.
    pub damper: Damper,
    /// Share of the squared error on left-out pieces that it removes.
    pub holdout_gain: f64,
    /// Share of those pieces that it improves or leaves unchanged.
    pub tests_improved: f64,
    /// Simulated force of every training test, N.
    pub on_train: Vec<Vec<f64>>,
    /// Simulated force of every test held out, N.
    pub on_holdout: Vec<Vec<f64>>,
}

impl Empirical {
    /// No map: the work was stopped before.
    pub(crate) fn interrupted() -> Self {
        let why = "interrupted before a map was fitted".to_owned();
        Self { kept: false, why, fitted: None }
    }

    /// The map, if it is kept.
    pub fn kept(&self) -> Option<&FittedMap> {
        self.fitted.as_ref().filter(|_| self.kept)
    }
}

/// Fits a map to the residual of a model on the training tests, and judges it. `on_holdout` is the
/// model on the tests held out.
pub fn empirical(
    model: &Judged,
    residual: &ResidualAnalysis,
    on_holdout: Option<&Fit>,
    (train, holdout): (&TestSet, &TestSet),
) -> Empirical {
    let explaining = residual.maps.iter().filter(|map| map.share > 0.0);
    let coordinates = explaining.filter_map(|map| map.coordinate.of_a_damper());
    let mut best: Option<(Trial, Option<String>)> = None;
    for coordinate in coordinates {
        let Some(trial) = try_map(coordinate, model, train) else { continue };
        let objection = trial.objection();
        if objection.is_none() {
            best = Some((trial, None));
            break;
        }
        best.get_or_insert((trial, objection));
    }
    let Some((trial, mut objection)) = best else {
        let why = "no coordinate that a running damper knows explains any of the residual on \
                   left-out tests";
        return Empirical { kept: false, why: why.to_owned(), fitted: None };
    };
    let fitted = trial.on(train, holdout);
    objection = objection.or_else(|| worse(&fitted, on_holdout, holdout));
    let kept = objection.is_none();
    let why = objection.unwrap_or_else(|| {
        format!(
            "removes {:.1} % of the squared error on left-out tests, improves or leaves unchanged \
             {:.0} % of them",
            100.0 * fitted.holdout_gain,
            100.0 * fitted.tests_improved
        )
    });
    Empirical { kept, why, fitted: Some(fitted) }
}

/// A map judged on the training tests.
struct Trial {
    map: EmpiricalMap,
    damper: Damper,
    seen_gain: f64,
    holdout_gain: f64,
    tests_improved: f64,
}

/// Fits a map over a coordinate; none where the coordinate does not vary.
fn try_map(coordinate: MapCoordinate, model: &Judged, tests: &TestSet) -> Option<Trial> {
    let fit = model.fit();
    let damper = fit.model.damper(&fit.values)?;
    let reversal_m_per_s = reversal_m_per_s(tests);
    let flat = |at: f64| MapKnot { at, upper_n: 0.0, lower_n: 0.0 };
    let anywhere = EmpiricalMap::new(coordinate, &[flat(0.0), flat(1.0)], reversal_m_per_s).ok()?;
    let silent = damper.clone().with_empirical(anywhere);
    let along: Vec<Along> = tests
        .tests
        .par_iter()
        .zip(&fit.starts_m)
        .map(|(test, start_m)| {
            let mut along = Along::default();
            walk(&silent, test, *start_m, test.record.force_n.len(), |_, state| {
                along.at.push(coordinate.of(state));
                along.extends.push(state.extends());
                ControlFlow::Continue(())
            });
            along
        })
        .collect();
    let counted =
        tests.pieces.iter().flat_map(|piece| &along[piece.test].at[piece.samples.clone()]);
    let knots: Vec<MapKnot> =
        smooth::places(counted.copied().collect())?.into_iter().map(flat).collect();
    let map = EmpiricalMap::new(coordinate, &knots, reversal_m_per_s).ok()?;
    let pieces: Vec<Piece> = tests
        .pieces
        .par_iter()
        .zip(&model.left_out.force_n)
        .map(|(piece, unseen_n)| {
            let samples = piece.samples.clone();
            let measured_n = &tests.tests[piece.test].record.force_n[samples.clone()];
            let gram = |simulated_n: &[f64]| {
                let pairs = measured_n.iter().zip(simulated_n);
                let residual_n: Vec<f64> = pairs.map(|(y, f)| y - f).collect();
                along[piece.test].gram(&map, samples.clone(), &residual_n)
            };
            let seen = gram(&fit.force_n[piece.test][samples.clone()]);
            Piece { seen, unseen: gram(unseen_n) }
        })
        .collect();
    let smoothed = smooth::smoothed(&pieces)?;
    let (upper_n, lower_n) = smoothed.values_n.as_slice().split_at(knots.len());
    let values = knots.iter().zip(upper_n).zip(lower_n);
    let knots: Vec<MapKnot> = values
        .map(|((knot, upper_n), lower_n)| MapKnot {
            at: knot.at,
            upper_n: *upper_n,
            lower_n: *lower_n,
        })
        .collect();
    let map = EmpiricalMap::new(coordinate, &knots, reversal_m_per_s).ok()?;
    let (before_n2, after_n2) = (&smoothed.before_n2, &smoothed.after_n2);
    let sum = |squares_n2: &[f64]| squares_n2.iter().sum::<f64>();
    Some(Trial {
        damper: damper.with_empirical(map.clone()),
        map,
        seen_gain: smoothed.seen_gain,
        holdout_gain: 1.0 - sum(after_n2) / sum(before_n2).max(f64::MIN_POSITIVE),
        tests_improved: improved(before_n2, after_n2),
    })
}

/// A speed of reversal that is slow enough for the slowest test.
fn reversal_m_per_s(tests: &TestSet) -> f64 {
    let largest = tests
        .tests
        .iter()
        .map(|test| test.record.velocity_m_per_s.iter().fold(0.0, |m: f64, v| m.max(v.abs())));
    let slowest = largest.filter(|speed| *speed > 0.0).fold(f64::INFINITY, f64::min);
    if slowest.is_finite() { UNDER_WAY * slowest } else { 0.0 }
}

impl Trial {
    /// The reason against the map, if there is one.
    fn objection(&self) -> Option<String> {
        too_little(self.seen_gain, "the tests it is fitted to")
            .or_else(|| too_little(self.holdout_gain, "tests left out"))
            .or_else(|| too_seldom(self.tests_improved))
    }

    /// Free-run simulation of all tests, with the initial position of every dashpot found again.
    fn on(self, train: &TestSet, holdout: &TestSet) -> FittedMap {
        let run = |tests: &TestSet| {
            let each = tests
                .tests
                .par_iter()
                .map(|test| simulate(&self.damper, test, start_deflection_m(&self.damper, test)));
            each.collect()
        };
        let (on_train, on_holdout) = (run(train), run(holdout));
        let Self { map, damper, holdout_gain, tests_improved, .. } = self;
        FittedMap { map, damper, holdout_gain, tests_improved, on_train, on_holdout }
    }
}

/// The reason against a map that predicts the held-out tests worse than the model without it.
fn worse(fitted: &FittedMap, without: Option<&Fit>, holdout: &TestSet) -> Option<String> {
    let before = holdout.rmse_n(&without?.force_n)?;
    let after = holdout.rmse_n(&fitted.on_holdout)?;
    (after > before).then(|| {
        format!("worse on the tests held out: {after:.4} N rms with it, {before:.4} N without")
    })
}
