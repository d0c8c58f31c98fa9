//! A fitted model to first order: its sensitivities, its residual and the colour of that residual.

use super::colour::Colour;
use super::fit::{Fit, slopes};
use super::test_set::TestSet;

/// A fitted model with everything that first order needs.
#[derive(Debug, Clone)]
pub struct Linearised {
    /// The model as fitted.
    pub fit: Fit,
    /// Sensitivities: by parameter, test, sample.
    pub slopes: Vec<Vec<Vec<f64>>>,
    /// Residual of every test.
    pub residual_n: Vec<Vec<f64>>,
    /// Colour of every test's residual.
    pub colours: Vec<Colour>,
}

impl Linearised {
    /// Prepares a fitted model.
    pub fn new(fit: Fit, tests: &TestSet) -> Self {
        let free = fit.model.free(&fit.values);
        let slopes = slopes(&fit.model, &free, &fit.force_n, &fit.starts_m, tests);
        let residual_n: Vec<Vec<f64>> =
            (0..tests.tests.len()).map(|test| fit.residual_n(tests, test)).collect();
        let colours = tests
            .tests
            .iter()
            .zip(&residual_n)
            .map(|(test, residual)| Colour::estimate(&residual[test.counted()]))
            .collect();
        Self { fit, slopes, residual_n, colours }
    }
}
