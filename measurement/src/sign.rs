//! Whether displacement and force agree in sign.
//!
//! A damper takes up work. Where a test seems to deliver work, one of its two signs is wrong, or
//! its force comes so late that a stiff, quick test delivers work although the signs are right.
//! With
//!
//! ```text
//! share(d) = sum F(t + d) dx(t) / sum |F(t + d) dx(t)|      F without its mean, whole cycles
//! ```
//!
//! a test is clear when its share has one sign, and more than [`TOO_LITTLE`], for every delay d
//! from zero to [`LATEST_S`]. A clear test decides for itself. The wiring is the same in every test
//! of a visit, so the others follow the sum over the clear ones. A sign that is wrong in both
//! channels is not seen.

use crate::error::MeasurementError;
use crate::series::Series;
use signal::statistics::{mean, rms};

/// Share of work below which a test says nothing about its signs.
const TOO_LITTLE: f64 = 0.02;
/// Longest delay of a force, s: that of the effect `sensor_delay`.
const LATEST_S: f64 = 0.02;
/// Delays that are tried.
const DELAYS: usize = 10;

/// What a test says about its signs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Agreement {
    /// Names of the columns of displacement and force.
    columns: [String; 2],
    /// Work that the damper took up, J.
    work_j: f64,
    /// That work over the sum of its absolute parts.
    share: f64,
    /// That share, where no delay turns its sign.
    clear: Option<f64>,
}

impl Agreement {
    /// Of a test as it was recorded.
    ///
    /// # Errors
    /// Work is delivered and the "displacement" is three times as rough as the "force": swapped
    /// columns.
    pub(crate) fn of(
        series: &Series,
        cycles: &[usize],
        step_s: f64,
    ) -> Result<Self, MeasurementError> {
        let whole = 0..series.force_n.len();
        let range = match (cycles.first(), cycles.last()) {
            (Some(first), Some(last)) => *first..*last,
            _ => whole.clone(),
        };
        // The force of a later sample against the motion of this one.
        let late = |samples: usize| {
            let end = range.end.min(whole.end.saturating_sub(samples)).max(range.start);
            let displacement_m = series.displacement_m.get(range.start..end);
            let force_n = series.force_n.get(range.start + samples..end + samples);
            work(displacement_m.unwrap_or_default(), force_n.unwrap_or_default())
        };
        let (work_j, share) = late(0);
        let delays = (0..=DELAYS).map(|k| k as f64 / DELAYS as f64 * LATEST_S / step_s);
        let shares = delays.map(|samples| late(samples.round() as usize).1 * share.signum());
        let clear = (shares.fold(f64::INFINITY, f64::min) > TOO_LITTLE).then_some(share);
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
        Ok(Self { columns: [displacement.clone(), force.clone()], work_j, share, clear })
    }

    /// True where the force of this test is to be turned, in a visit whose tests say `disagree`
    /// together.
    pub(crate) fn turned(&self, disagree: bool) -> bool {
        self.clear.map_or(disagree, |share| share < 0.0)
    }

    /// What there is to report about this test, in a visit whose tests say `disagree` together.
    pub(crate) fn report(&self, disagree: bool) -> Option<String> {
        let Self { columns: [displacement, force], work_j, share, clear } = self;
        if displacement == force {
            return None;
        }
        let turned = self.turned(disagree);
        let alone = turned != disagree;
        match (turned, alone) {
            (true, true) => Some(format!(
                "{force}: sign turned in this test alone, the damper took up {work_j:.4} J, which no \
                 delay up to {LATEST_S} s explains"
            )),
            (true, false) if *share > TOO_LITTLE => Some(format!(
                "{force}: sign turned as in the other tests, though the damper took up {work_j:.4} J"
            )),
            (true, false) => {
                Some(format!("{force}: sign turned, the damper took up {work_j:.4} J"))
            }
            (false, true) => Some(format!(
                "{force}: sign left as it is in this test alone, the damper took up {work_j:.4} J"
            )),
            (false, false) if clear.is_none() && *share < -TOO_LITTLE => Some(format!(
                "left as it is: {work_j:.4} J taken up, as by a damper whose {force} comes late"
            )),
            (false, false) if *share < TOO_LITTLE => Some(format!(
                "left as it is: {work_j:.4} J taken up are too little to show that {displacement} \
                 and {force} agree in sign"
            )),
            (false, false) => None,
        }
    }
}

/// True where the clear tests of a visit say together that displacement and force disagree.
pub(crate) fn disagree<'a>(visit: impl IntoIterator<Item = &'a Agreement>) -> bool {
    visit.into_iter().filter_map(|test| test.clear).sum::<f64>() < 0.0
}

/// Work that the damper took up (J), without the mean force, and that work over the sum of its
/// absolute parts.
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
        Agreement::of(&Series::sampled("a", 1e3, x, force), &[], 1e-3).unwrap()
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
        // 20 ms are 14.4 degrees at 2 Hz.
        let visit = [test(80.0), test(45.0), test(-10.0)];
        assert!(!disagree(&visit) && !visit[2].turned(false));
        assert!(visit[2].report(false).is_some_and(|report| report.contains("comes late")));
        assert_eq!(visit[0].report(false), None);
        // The same visit with the load cell wired the other way round.
        let visit = [test(-100.0), test(-135.0), test(170.0)];
        assert!(disagree(&visit) && visit.iter().all(|test| test.turned(true)));
        assert!(
            visit[2].report(true).is_some_and(|report| report.contains("as in the other tests"))
        );
        // Alone a late test is kept as it is, and an undecided test decides nothing.
        assert!(!disagree(&[test(-10.0)]) && disagree(&[test(-30.0)]) && !disagree(&[test(0.0)]));
        assert!(test(0.0).report(false).is_some_and(|report| report.contains("too little")));
    }

    #[test]
    fn a_force_reversed_in_one_test_was_left_as_a_late_one() {
        let visit = [test(80.0), test(45.0), test(-127.0), test(60.0)];
        assert!(!disagree(&visit));
        assert_eq!(visit.each_ref().map(|test| test.turned(false)), [false, false, true, false]);
        assert!(visit[2].report(false).is_some_and(|report| report.contains("in this test alone")));
    }
}
