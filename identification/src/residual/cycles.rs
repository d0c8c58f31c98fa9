//! A test cut into its cycles, without its run-in.

use crate::test_set::Test;
use measurement::Measurement;

/// The residual of a test, cycle by cycle, without its run-in.
pub(crate) fn cycles<'a>(test: &Test, residual_n: &'a [f64]) -> Vec<&'a [f64]> {
    starts(test).windows(2).filter_map(|pair| residual_n.get(pair[0]..pair[1])).collect()
}

/// The marks of every run of equal cycles that has at least two after the run-in.
pub(crate) fn runs(test: &Test) -> impl Iterator<Item = Vec<usize>> {
    let Measurement { runs, run_in, .. } = &test.record;
    let counted = runs
        .iter()
        .map(|marks| marks.iter().copied().filter(|at| *at >= *run_in).collect::<Vec<usize>>());
    counted.filter(|marks| marks.len() > 2)
}

/// First samples of those cycles, and the end of the last.
pub(crate) fn starts(test: &Test) -> Vec<usize> {
    let record = &test.record;
    record.cycles.iter().copied().filter(|at| *at >= record.run_in).collect()
}
