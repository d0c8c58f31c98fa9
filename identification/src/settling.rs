//! An accepted model at its minimum.
//!
//! A trial stops near a minimum, and the same effect may have a deeper one; and a nominal parameter
//! may have fallen to zero while the effect was missing, from where no fit returns.

use super::candidate::Candidate;
use super::control::Control;
use super::fit::{Effort, Fit, fit, fit_on};
use super::grey_box::{C2, CE};
use super::test_set::TestSet;
use rayon::prelude::*;

/// Share of the squared error by which another minimum of the same model is better.
pub(crate) const BETTER_MINIMUM: f64 = 0.01;
/// A usual slope beyond relief, in shares of Ce.
const USUAL_C2: f64 = 0.06;
/// Share of it below which a fitted one is stuck at zero.
const STUCK_C2: f64 = 0.02;

/// An accepted model at its deepest minimum: a trial may lie in a shallower one, and the other
/// start values of the effect may reach the deepest.
pub(crate) fn settled(
    trial: &Fit,
    candidate: &Candidate,
    tests: &TestSet,
    control: Control<'_>,
) -> Option<Fit> {
    // Whole tests with fewer samples are enough to compare minima.
    let rough = tests.beginnings(f64::INFINITY);
    let nominal = trial.values.len() - candidate.effect.parameters.len();
    let others = candidate.starts.iter().map(|start| [&trial.values[..nominal], start].concat());
    let starts: Vec<Vec<f64>> = std::iter::once(trial.values.clone()).chain(others).collect();
    let mut minima: Vec<Fit> = starts
        .par_iter()
        .filter_map(|from| fit(&trial.model, from, &rough, Effort::TRIAL, control))
        .collect();
    // The trial's own minimum stays first among equals.
    minima.sort_by(|a, b| a.total_n2().total_cmp(&b.total_n2()));
    let deepest = fit(&trial.model, &minima.first()?.values, tests, Effort::FULL, control)?;
    let deepest = if deepest.total_n2() < trial.total_n2() {
        deepest
    } else {
        fit_on(trial.clone(), tests, Effort::FULL, control)?
    };
    Some(with_slope_beyond_relief(&deepest, tests, control).unwrap_or(deepest))
}

/// The same model with a slope beyond relief, where it has none and is much better with one: while
/// the effect was missing, another parameter replaced the slope, and from zero no fit returns.
fn with_slope_beyond_relief(fitted: &Fit, tests: &TestSet, control: Control<'_>) -> Option<Fit> {
    let mut values = fitted.values.clone();
    let usual = USUAL_C2 * values[CE];
    if values[C2] > STUCK_C2 * usual {
        return None;
    }
    values[C2] = usual;
    let again = fit(&fitted.model, &values, tests, Effort::FULL, control)?;
    let better = again.total_n2() < (1.0 - BETTER_MINIMUM) * fitted.total_n2();
    better.then_some(again)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grey_box::{GreyBox, vector_of};
    use firmware_core::damper::{Damper, DamperState, Motion, Nominal};
    use measurement::{Measurement, Series};

    /// A new damper (relief at 18 mm/s) driven with a sine of 3.5 Hz.
    fn tests(amplitude_m: f64) -> TestSet {
        let w = std::f64::consts::TAU * 3.5;
        let motion = |n: usize| {
            let (sin, cos) = libm::sincos(w * n as f64 * 1e-3);
            Motion::new(amplitude_m * sin, amplitude_m * w * cos)
        };
        let damper = Damper::new(Nominal::NEW, &[]).unwrap();
        let mut state = DamperState::starting(motion(0));
        // Some noise: without any, the start of the dashpot is all that is left to fit.
        let noise_n = |n: usize| 5.0 * libm::sin((n * n) as f64);
        let force_n =
            (0..3000).map(|n| damper.advance(&mut state, motion(n), 1e-3) + noise_n(n)).collect();
        let displacement_m = (0..3000).map(|n| motion(n).displacement_m).collect();
        let series = Series::sampled("a", 1e3, displacement_m, force_n);
        TestSet::new(vec![Measurement::from_series(series).unwrap()])
    }

    /// That damper without its slope beyond relief.
    fn stuck(tests: &TestSet) -> Fit {
        let model = GreyBox::nominal(&tests.scale);
        let nominal = Nominal { c2_n_s_per_m: 5.0, ..Nominal::NEW };
        Fit::evaluate(&model, &vector_of(&nominal), tests).unwrap()
    }

    #[test]
    fn a_slope_beyond_relief_that_had_fallen_to_zero_stayed_there() {
        let tests = tests(3.46e-3);
        let again = with_slope_beyond_relief(&stuck(&tests), &tests, Control::QUIET).unwrap();
        assert!((again.values[C2] / 80e3 - 1.0).abs() < 1e-3, "{:?}", again.values);
        assert!(with_slope_beyond_relief(&again, &tests, Control::QUIET).is_none());
    }

    #[test]
    fn where_relief_never_opens_nothing_is_changed() {
        let tests = tests(0.5e-3);
        assert!(with_slope_beyond_relief(&stuck(&tests), &tests, Control::QUIET).is_none());
    }
}
