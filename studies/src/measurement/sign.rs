//! Whether displacement and force agree in sign.
//!
//! A damper takes up work. Where a test seems to give some, one of its two signs is wrong; or its force
//! comes so late that a stiff, quick test gives work although the signs are right. The wiring is the same
//! in every test of a visit, so all of them together decide: the sum of
//!
//! ```text
//! share = sum F dx / sum |F dx|        F without its mean, over whole cycles
//! ```
//!
//! over all tests in which it is larger than [`TOO_LITTLE`]. A sign that is wrong in both is not seen.

use super::error::MeasurementError;
use super::series::Series;
use crate::statistics::{mean, rms};

/// Share of work below which a test says nothing about its signs.
const TOO_LITTLE: f64 = 0.02;

/// What a test says about its signs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Agreement {
    /// Names of the columns of displacement and force.
    columns: [String; 2],
    /// Work that the damper took up, J.
    work_j: f64,
    /// That work over the sum of its absolute parts.
    share: f64,
}

impl Agreement {
    /// Of a test as it was recorded.
    ///
    /// # Errors
    /// Work is given and the "displacement" is three times as rough as the "force": swapped columns.
    pub(super) fn of(series: &Series, cycles: &[usize]) -> Result<Self, MeasurementError> {
        let range = match (cycles.first(), cycles.last()) {
            (Some(first), Some(last)) => *first..*last,
            _ => 0..series.force_n.len(),
        };
        let part = |values: &[f64]| values.get(range.clone()).unwrap_or(values).to_vec();
        let (work_j, share) = work(&part(&series.displacement_m), &part(&series.force_n));
        let [_, displacement, force] = &series.columns;
        if share < -TOO_LITTLE {
            let (rough_x, rough_f) =
                (roughness(&series.displacement_m), roughness(&series.force_n));
            if rough_x > 3.0 * rough_f {
                let found =
                    format!("{displacement} rougher than {force}, and {work_j:.4} J taken up");
                let expected = "a smooth displacement and positive work: are the columns swapped?";
                return Err(series.error(found, expected.to_owned()));
            }
        }
        Ok(Self { columns: [displacement.clone(), force.clone()], work_j, share })
    }

    /// What is to be told of this test when its force is turned, or left as it is.
    pub(super) fn told(&self, turned: bool) -> Option<String> {
        let Self { columns: [displacement, force], work_j, share } = self;
        let own = *share < -TOO_LITTLE;
        match (turned, own) {
            (true, true) => Some(format!("{force}: sign turned, the damper took up {work_j:.4} J")),
            (true, false) => Some(format!(
                "{force}: sign turned as in the other tests, though the damper took up {work_j:.4} J"
            )),
            (false, true) => Some(format!(
                "left as it is: {work_j:.4} J taken up, though {displacement} and {force} agree in sign in the \
                 other tests; a force that comes late? another wiring?"
            )),
            (false, false) if *share < TOO_LITTLE => Some(format!(
                "left as it is: {work_j:.4} J taken up are too little to show that {displacement} and {force} \
                 agree in sign"
            )),
            (false, false) => None,
        }
    }
}

/// True where the tests of a visit say together that displacement and force disagree.
pub(super) fn disagree<'a>(visit: impl IntoIterator<Item = &'a Agreement>) -> bool {
    let clear = visit.into_iter().map(|test| test.share).filter(|share| share.abs() > TOO_LITTLE);
    clear.sum::<f64>() < 0.0
}

/// Work that the damper took up (J), the mean force left out, and that work over the sum of its absolute
/// parts.
fn work(displacement_m: &[f64], force_n: &[f64]) -> (f64, f64) {
    let middle = mean(force_n);
    let (mut work, mut parts) = (0.0, 0.0);
    for (x, f) in displacement_m.windows(2).zip(force_n.windows(2)) {
        let part = (0.5 * (f[0] + f[1]) - middle) * (x[1] - x[0]);
        work += part;
        parts += part.abs();
    }
    (work, if parts > 0.0 { work / parts } else { 0.0 })
}

/// Second differences over first differences: a corner makes it large, a sine small.
fn roughness(values: &[f64]) -> f64 {
    let first: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let second: Vec<f64> = first.windows(2).map(|pair| pair[1] - pair[0]).collect();
    rms(&second) / rms(&first).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A sine of 1 mm at 2 Hz whose force leads by an angle.
    fn test(lead_degree: f64) -> Agreement {
        let phase = |n: usize| TAU * 2.0 * n as f64 * 1e-3;
        let lead = lead_degree.to_radians();
        let x = (0..3000).map(|n| 1e-3 * libm::sin(phase(n))).collect();
        let force = (0..3000).map(|n| 1e4 * libm::sin(phase(n) + lead)).collect();
        Agreement::of(&Series::sampled("a", 1e3, x, force), &[]).unwrap()
    }

    #[test]
    fn work_is_that_of_an_ellipse() {
        // pi x F sin(lead) a cycle, six cycles.
        let work = test(30.0).work_j;
        assert!((work / (6.0 * 0.5 * TAU * 1e-3 * 1e4 * 0.5) - 1.0).abs() < 1e-3, "{work}");
        assert!((test(90.0).share - 1.0).abs() < 1e-3 && (test(-90.0).share + 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_late_force_in_a_stiff_test_was_turned_alone() {
        let visit = [test(80.0), test(45.0), test(-15.0)];
        assert!(!disagree(&visit));
        assert!(visit[2].told(false).is_some_and(|told| told.contains("comes late?")));
        assert_eq!(visit[0].told(false), None);
        // The same visit with the load cell wired the other way round.
        let visit = [test(-100.0), test(-135.0), test(165.0)];
        assert!(disagree(&visit));
        assert!(visit[2].told(true).is_some_and(|told| told.contains("as in the other tests")));
        // Alone it is taken at its word, and what says nothing decides nothing.
        assert!(disagree(&[test(-15.0)]) && !disagree(&[test(0.0)]));
        assert!(test(0.0).told(false).is_some_and(|told| told.contains("too little")));
    }
}
