//! A fitted model together with its predictions of pieces that it has not seen.

use super::fit::Fit;
use super::folds::LeftOut;
use super::linearised::Linearised;
use super::test_set::TestSet;

/// A fitted model and its predictions of left-out pieces.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The model with its sensitivities.
    pub linearised: Linearised,
    /// Its predictions of left-out pieces.
    pub left_out: LeftOut,
}

impl Judged {
    /// Judges a fitted model.
    pub fn new(fit: Fit, tests: &TestSet) -> Option<Self> {
        let linearised = Linearised::new(fit, tests);
        let left_out = LeftOut::predict(&linearised, tests)?;
        debug_assert_eq!(left_out.force_n.len(), tests.pieces.len());
        Some(Self { linearised, left_out })
    }

    /// The model as fitted to all pieces.
    pub fn fit(&self) -> &Fit {
        &self.linearised.fit
    }
}
