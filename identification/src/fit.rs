//! Least squares on free-run simulation: Levenberg-Marquardt in free coordinates.
//!
//! The sum of squares runs over the counted samples of all pieces. Derivatives are differences of
//! simulations, one per parameter and test, in parallel on all cores; sums are formed in the order
//! of the tests, so the result does not depend on the number of cores.

use super::control::Control;
use super::descent::{self, LeastSquares, Limits};
use super::grey_box::{GreyBox, NOMINAL};
use super::simulation::{simulate, start_deflection_m, start_deflection_near_m};
use super::test_set::TestSet;
use firmware_core::damper::Damper;
use firmware_core::damper::effects::Scale;
use rayon::prelude::*;

/// Step of a derivative, in a free coordinate.
const DERIVATIVE_STEP: f64 = 2e-4;

/// The effort of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Runs of the solver, each with new initial positions of the dashpots.
    pub rounds: usize,
    /// How far a run goes.
    limits: Limits,
}

impl Effort {
    /// To the minimum.
    pub const FULL: Self = Self::new(3, 12, 1e-7);
    /// Near enough to the minimum to judge a candidate.
    pub const TRIAL: Self = Self::new(2, 40, 1e-5);
    /// Enough to compare starts.
    pub const SHORT: Self = Self::new(1, 12, 1e-4);

    /// To the minimum where the gain is this small.
    const fn new(rounds: usize, patience: usize, gain: f64) -> Self {
        Self { rounds, limits: Limits { patience, gain, to_minimum: gain < 1e-6 } }
    }
}

/// A model fitted to records.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The model.
    pub model: GreyBox,
    /// Its parameters.
    pub values: Vec<f64>,
    /// Deflection of the attachment at the start of every test, m.
    pub starts_m: Vec<f64>,
    /// Simulated force of every test, N, run-in included.
    pub force_n: Vec<Vec<f64>>,
    /// Sum of squared errors of every piece, N2.
    pub squares_n2: Vec<f64>,
}

impl Fit {
    /// A model with given parameters, simulated on every test.
    pub fn evaluate(model: &GreyBox, values: &[f64], tests: &TestSet) -> Option<Self> {
        let damper = model.damper(values)?;
        let starts = tests.tests.par_iter().map(|test| start_deflection_m(&damper, test));
        Some(Self::simulated(model, values, &damper, starts.collect(), tests))
    }

    /// The same near positions of the dashpots that were the best for similar parameters.
    fn evaluate_near(
        model: &GreyBox,
        values: &[f64],
        known_m: &[f64],
        tests: &TestSet,
    ) -> Option<Self> {
        let damper = model.damper(values)?;
        let pairs = tests.tests.par_iter().zip(known_m);
        let starts = pairs.map(|(test, known_m)| start_deflection_near_m(&damper, test, *known_m));
        Some(Self::simulated(model, values, &damper, starts.collect(), tests))
    }

    /// The same from given positions of the dashpots.
    pub(crate) fn starting_at(
        model: &GreyBox,
        values: &[f64],
        starts_m: &[f64],
        tests: &TestSet,
    ) -> Option<Self> {
        let damper = model.damper(values)?;
        Some(Self::simulated(model, values, &damper, starts_m.to_vec(), tests))
    }

    fn simulated(
        model: &GreyBox,
        values: &[f64],
        damper: &Damper,
        starts_m: Vec<f64>,
        tests: &TestSet,
    ) -> Self {
        debug_assert_eq!(values.len(), model.coordinates().len(), "one value per parameter");
        debug_assert_eq!(starts_m.len(), tests.tests.len(), "one start per test");
        let pairs = tests.tests.par_iter().zip(&starts_m);
        let force_n: Vec<Vec<f64>> =
            pairs.map(|(test, start_m)| simulate(damper, test, *start_m)).collect();
        let squares_n2 = squares_of(tests, &force_n);
        let (model, values) = (model.clone(), values.to_vec());
        Self { model, values, starts_m, force_n, squares_n2 }
    }

    /// The same model simulated on other tests.
    pub fn on(&self, tests: &TestSet) -> Option<Self> {
        Self::evaluate(&self.model, &self.values, tests)
    }

    /// The model with those of its effects alone whose place is kept, and their fitted values.
    pub(crate) fn with_effects_kept(
        &self,
        keep: impl Fn(usize) -> bool,
        scale: &Scale,
    ) -> (GreyBox, Vec<f64>) {
        let mut model = GreyBox::nominal(scale);
        let mut values = self.values[..NOMINAL.len()].to_vec();
        for (index, effect) in self.model.effects.iter().enumerate().filter(|(k, _)| keep(*k)) {
            model = model.with(effect, scale);
            values.extend(&self.values[self.model.range_of(index)]);
        }
        (model, values)
    }

    /// Sum over all pieces, N2.
    pub fn total_n2(&self) -> f64 {
        self.squares_n2.iter().sum()
    }

    /// rms error over all pieces, N.
    pub fn rms_n(&self, tests: &TestSet) -> f64 {
        (self.total_n2() / tests.counted_samples() as f64).sqrt()
    }

    /// Measured less simulated force of a test, N.
    pub fn residual_n(&self, tests: &TestSet, test: usize) -> Vec<f64> {
        let measured = &tests.tests[test].record.force_n;
        measured.iter().zip(&self.force_n[test]).map(|(y, f)| y - f).collect()
    }
}

/// Sum of squared errors of every piece.
pub(crate) fn squares_of(tests: &TestSet, force_n: &[Vec<f64>]) -> Vec<f64> {
    debug_assert_eq!(force_n.len(), tests.tests.len(), "one force per test");
    let squares = tests.pieces.iter().map(|piece| {
        tests.tests[piece.test].squares_n2(&force_n[piece.test], piece.samples.clone())
    });
    squares.collect()
}

/// Fits the parameters of a model, from given values; none where they make no damper or the work is
/// stopped.
pub fn fit(
    model: &GreyBox,
    from: &[f64],
    tests: &TestSet,
    effort: Effort,
    control: Control<'_>,
) -> Option<Fit> {
    fit_on(Fit::evaluate(model, from, tests)?, tests, effort, control)
}

/// Continues the fit of a model that has been simulated.
pub(crate) fn fit_on(
    from: Fit,
    tests: &TestSet,
    effort: Effort,
    control: Control<'_>,
) -> Option<Fit> {
    let start_n2 = from.total_n2();
    let mut best = from;
    for round in 0..effort.rounds {
        let before = best.total_n2();
        let fitted = descend(&best, tests, effort, control)?;
        let gained = before - fitted.total_n2();
        if gained > 0.0 {
            best = fitted;
        }
        // New initial positions of the dashpots may allow a further descent.
        if round + 1 < effort.rounds && gained < 1e-4 * before {
            break;
        }
    }
    debug_assert!(
        best.total_n2() <= start_n2 || start_n2.is_nan(),
        "a fit must not end with a larger error than it started with"
    );
    Some(best)
}

/// The same, and once more with parameters that are stuck at zero lifted off it: on the way a
/// parameter may fall to zero that belongs elsewhere, such as a clearance while the air in series
/// is still too large.
pub(crate) fn fit_freely(
    from: Fit,
    tests: &TestSet,
    effort: Effort,
    control: Control<'_>,
) -> Option<Fit> {
    let fitted = fit_on(from, tests, effort, control)?;
    let Some(freed) = fitted.model.freed(&fitted.values) else { return Some(fitted) };
    match fit(&fitted.model, &freed, tests, effort, control) {
        Some(again) if again.total_n2() < fitted.total_n2() => Some(again),
        _ => Some(fitted),
    }
}

/// One run of the solver with fixed initial positions of the dashpots.
fn descend(from: &Fit, tests: &TestSet, effort: Effort, control: Control<'_>) -> Option<Fit> {
    let free = from.model.free(&from.values);
    debug_assert!(free.iter().all(|u| u.is_finite()), "a start on a bound is taken inside it");
    let problem = Problem { model: &from.model, tests, starts_m: &from.starts_m, control };
    let free = descent::descend(&problem, free, effort.limits)?;
    let values = from.model.values(&free);
    Fit::evaluate_near(&from.model, &values, &from.starts_m, tests)
}

struct Problem<'a> {
    model: &'a GreyBox,
    tests: &'a TestSet,
    starts_m: &'a [f64],
    control: Control<'a>,
}

impl LeastSquares for Problem<'_> {
    const DERIVATIVE_STEP: f64 = DERIVATIVE_STEP;

    fn residual(&self, free: &[f64]) -> Option<Vec<f64>> {
        let force_n = forces(self.model, &self.model.values(free), self.starts_m, self.tests)?;
        let mut residual = Vec::with_capacity(self.tests.counted_samples());
        for piece in &self.tests.pieces {
            let range = piece.samples.clone();
            debug_assert!(range.end <= force_n[piece.test].len(), "a piece lies inside its test");
            let measured = &self.tests.tests[piece.test].record.force_n[range.clone()];
            let model = &force_n[piece.test][range];
            residual.extend(model.iter().zip(measured).map(|(f, y)| f - y));
        }
        Some(residual)
    }

    fn is_stopped(&self) -> bool {
        self.control.is_stopped()
    }
}

/// Simulated force of every test.
fn forces(
    model: &GreyBox,
    values: &[f64],
    starts_m: &[f64],
    tests: &TestSet,
) -> Option<Vec<Vec<f64>>> {
    let damper = model.damper(values)?;
    let pairs = tests.tests.par_iter().zip(starts_m);
    Some(pairs.map(|(test, start_m)| simulate(&damper, test, *start_m)).collect())
}

/// Change of force per change of each free coordinate: by parameter, by test, by sample.
pub(crate) fn slopes(
    model: &GreyBox,
    free: &[f64],
    force_n: &[Vec<f64>],
    starts_m: &[f64],
    tests: &TestSet,
) -> Vec<Vec<Vec<f64>>> {
    let count = tests.tests.len();
    debug_assert_eq!((force_n.len(), starts_m.len()), (count, count), "one of each per test");
    let whole = WholeTests { model, tests, starts_m };
    let by_test = |column: Vec<f64>| {
        let mut rest = column.as_slice();
        let lengths = force_n.iter().map(Vec::len);
        let cut = lengths.filter_map(|length| rest.split_off(..length).map(<[f64]>::to_vec));
        cut.collect()
    };
    descent::columns(&whole, free, &force_n.concat()).into_iter().map(by_test).collect()
}

/// The force itself, over all samples of all tests one after the other.
struct WholeTests<'a> {
    model: &'a GreyBox,
    tests: &'a TestSet,
    starts_m: &'a [f64],
}

impl LeastSquares for WholeTests<'_> {
    const DERIVATIVE_STEP: f64 = DERIVATIVE_STEP;

    fn residual(&self, free: &[f64]) -> Option<Vec<f64>> {
        Some(forces(self.model, &self.model.values(free), self.starts_m, self.tests)?.concat())
    }
}
