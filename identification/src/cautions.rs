//! Cautions: reasons to doubt the numbers, a line each.

use super::budget::MOST_PASSES;
use super::coordinate::{Coordinate, ON_BOUND, physical_limit};
use super::finding::Findings;
use super::fit::Fit;
use super::residual::Unexplained;
use super::test_set::{Test, TestSet};
use signal::statistics::{min_max, rms};

/// Share of the range of the training tests by which a held-out test may exceed it.
const BEYOND: f64 = 0.1;
/// Ratio of forces beyond which a wrong unit is suspected.
const OTHER_UNIT: f64 = 30.0;
/// Multiple of the training error from which held-out tests count as not followed.
const NOT_FOLLOWED: f64 = 2.0;

/// A signal of a test.
type Signal = fn(&Test) -> &[f64];

/// All cautions about an identification, a line each.
pub(crate) fn all(
    findings: &Findings,
    datasheet: Option<&Fit>,
    (train, holdout): (&TestSet, &TestSet),
) -> Vec<String> {
    let mut lines = Vec::new();
    lines.extend(few_tests(train));
    lines.extend(cut_short(findings));
    lines.extend(other_unit(datasheet, train));
    lines.extend(extrapolations(train, holdout));
    lines.extend(on_bounds(findings.with_effects.fit(), train));
    lines.extend(accepted_together(findings));
    lines
}

fn few_tests(train: &TestSet) -> Option<String> {
    let (tests, pieces) = (train.tests.len(), train.pieces.len());
    (!train.whole_tests).then(|| {
        format!(
            "training tests: {tests}, fewer than four: folds leave out {pieces} runs of whole \
             cycles with a guard gap between them, and not whole tests"
        )
    })
}

fn cut_short(findings: &Findings) -> Option<String> {
    findings.cut_short.then(|| {
        format!(
            "the search ended at its limit of work, {MOST_PASSES} passes of a model over the \
             training tests: --thorough continues it"
        )
    })
}

/// Pairs of which neither effect was accepted alone.
fn accepted_together(findings: &Findings) -> impl Iterator<Item = String> {
    findings.accepted.iter().filter_map(|first| {
        let second = first.together_with?;
        let still_there = findings.accepted.iter().any(|other| other.name == second);
        let first = first.name;
        still_there.then(|| {
            format!(
                "{first} and {second} were accepted together, neither of them alone: the \
                 evidence of {first} is that of both"
            )
        })
    })
}

/// Held-out tests that exceed the range of the training tests, a line each.
pub(crate) fn extrapolations(train: &TestSet, holdout: &TestSet) -> Vec<String> {
    let quantities: [(&str, &str, Signal); 3] = [
        ("force", "N", |test| &test.record.force_n),
        ("velocity", "m/s", |test| &test.record.velocity_m_per_s),
        ("displacement", "m", |test| &test.record.displacement_m),
    ];
    let mut lines = Vec::new();
    for (name, unit, values) in quantities {
        let ends = train.tests.iter().filter_map(|test| min_max(values(test)));
        let seen = ends.reduce(|all, own| (all.0.min(own.0), all.1.max(own.1)));
        let Some((low, high)) = seen else { continue };
        let room = BEYOND * (high - low);
        for test in &holdout.tests {
            let Some((from, to)) = min_max(values(test)) else { continue };
            if from < low - room || to > high + room {
                lines.push(format!(
                    "{}: {name} from {from:.4e} to {to:.4e} {unit}, the training tests from \
                     {low:.4e} to {high:.4e}: its errors are those of extrapolation",
                    test.record.name
                ));
            }
        }
    }
    lines
}

/// Held-out tests that the model does not follow: their error is far larger than that of the
/// training tests, and no training test shows why.
pub(crate) fn not_followed(
    (on_train, train): (&Fit, &TestSet),
    (on_holdout, holdout): (&Fit, &TestSet),
) -> Option<Unexplained> {
    let (seen_n, held_n) = (on_train.rms_n(train), holdout.rmse_n(&on_holdout.force_n)?);
    if held_n <= NOT_FOLLOWED * seen_n {
        return None;
    }
    let each = holdout.tests.iter().zip(&on_holdout.force_n);
    let errors = each.map(|(test, force_n)| (test.rmse_n(force_n), test.record.name.as_str()));
    let (most_n, name) = errors.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Unexplained {
        rms_n: held_n,
        coordinate: "held_out_tests",
        description: format!(
            "the error on the tests held out is {:.0} times that on the fitted ones, {name} has \
             the largest with {most_n:.4e} N: another damper, another state, or an effect that \
             no fitted test shows",
            held_n / seen_n
        ),
    })
}

/// Tests in which the datasheet's forces have another size than the measured ones: a line for all
/// tests, or one each.
pub(crate) fn other_unit(datasheet: Option<&Fit>, tests: &TestSet) -> Vec<String> {
    let Some(fit) = datasheet else { return Vec::new() };
    let ratio = |test: &Test, force_n: &[f64]| rms(force_n) / rms(&test.record.force_n);
    let ratios = tests.tests.iter().zip(&fit.force_n).map(|(test, force_n)| ratio(test, force_n));
    let ratios: Vec<f64> = ratios.collect();
    let odd = |ratio: &f64| ratio.is_finite() && !(1.0 / OTHER_UNIT..OTHER_UNIT).contains(ratio);
    let line = |what: &str, ratio: f64| {
        format!(
            "{what}: the datasheet's force is {ratio:.3e} times the measured one: is the force, \
             the displacement or the datasheet in another unit?"
        )
    };
    if ratios.iter().all(odd)
        && let Some(first) = ratios.first()
    {
        return vec![line("all tests", *first)];
    }
    let each = tests.tests.iter().zip(&ratios).filter(|(_, ratio)| odd(ratio));
    each.map(|(test, ratio)| line(&test.record.name, *ratio)).collect()
}

/// Parameters of effects that lie on a physical limit, a line each.
pub(crate) fn on_bounds(fit: &Fit, tests: &TestSet) -> Vec<String> {
    let mut lines = Vec::new();
    for (index, info) in fit.model.effects.iter().enumerate() {
        for (row, place) in info.parameters.iter().zip(fit.model.range_of(index)) {
            let (lower, upper) = row.bounds(&tests.scale);
            let value = fit.values[place];
            let spread = matches!(fit.model.coordinates()[place], Coordinate::Spread { .. });
            let size = if spread && value < (1.0 + ON_BOUND) * lower {
                "small"
            } else if let Some(size) = physical_limit(value, (lower, upper)) {
                size
            } else {
                continue;
            };
            lines.push(format!(
                "{}: {} = {value:.3e} lies on its bound: read it as \"as {size} as possible\"",
                info.name, row.name
            ));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grey_box::{GreyBox, vector_of};
    use firmware_core::damper::Nominal;
    use firmware_core::damper::effects::CATALOGUE;
    use measurement::{Measurement, Series};

    /// A damper of 1 MN s/m below relief at 3 Hz.
    fn tests(amplitude_m: f64, force_gain: f64) -> TestSet {
        let w = std::f64::consts::TAU * 3.0;
        let x = |n: usize| amplitude_m * libm::sin(w * n as f64 * 1e-3);
        let f = |n: usize| force_gain * 1e6 * amplitude_m * w * libm::cos(w * n as f64 * 1e-3);
        let series =
            Series::sampled("a", 1e3, (0..2000).map(x).collect(), (0..2000).map(f).collect());
        TestSet::new(vec![Measurement::from_series(series).unwrap()])
    }

    #[test]
    fn a_larger_range_is_reported_and_a_smaller_one_is_not() {
        let train = tests(1e-3, 1.0);
        assert_eq!(extrapolations(&train, &tests(1.1e-3, 1.0)), [""; 0]);
        let lines = extrapolations(&train, &tests(2e-3, 1.0));
        assert_eq!(lines.len(), 3, "{lines:?}");
        assert!(
            lines[2].starts_with("a: displacement from -2.0000e-3 to 2.0000e-3 m"),
            "{lines:?}"
        );
    }

    #[test]
    fn a_parameter_on_its_bound_is_reported() {
        let tests = tests(1e-3, 1.0);
        let stage = CATALOGUE.iter().find(|info| info.name == "second_valve_stage").unwrap();
        let model = GreyBox::nominal(&tests.scale).with(stage, &tests.scale);
        let lines = |ratio: f64| {
            let values = [vector_of(&Nominal::NEW), vec![5e3, ratio]].concat();
            on_bounds(&Fit::evaluate(&model, &values, &tests).unwrap(), &tests)
        };
        assert_eq!(lines(0.5), [""; 0]);
        let expected = "second_valve_stage: slope_ratio = 1.000e-2 lies on its bound";
        assert!(lines(0.01)[0].starts_with(expected), "{:?}", lines(0.01));
    }

    #[test]
    fn a_parameter_on_its_negative_bound_is_reported() {
        let tests = tests(1e-3, 1.0);
        let info = CATALOGUE.iter().find(|info| info.name == "asymmetric_damping").unwrap();
        let model = GreyBox::nominal(&tests.scale).with(info, &tests.scale);
        let lines = |share: f64| {
            let (lower, upper) = info.parameters[0].bounds(&tests.scale);
            let value = lower + share * (upper - lower);
            let others = vec![0.0; info.parameters.len() - 1];
            let values = [vector_of(&Nominal::NEW), vec![value], others].concat();
            on_bounds(&Fit::evaluate(&model, &values, &tests).unwrap(), &tests)
        };
        assert_eq!(lines(0.4), [""; 0]);
        assert!(lines(0.0)[0].ends_with("\"as negative as possible\""), "{:?}", lines(0.0));
    }

    #[test]
    fn a_held_out_test_of_another_damper_went_unreported() {
        let (own, other) = (tests(1e-3, 1.0), tests(1e-3, 2.0));
        // The dashpot that they were made with, on a stiff attachment.
        let damper =
            Nominal { ke_n_per_m: 1e9, clearance_2a_m: 0.0, f_relief_n: 1e6, ..Nominal::NEW };
        let own_fit =
            Fit::evaluate(&GreyBox::nominal(&own.scale), &vector_of(&damper), &own).unwrap();
        assert_eq!(not_followed((&own_fit, &own), (&own_fit, &own)), None);
        let on_other = Fit::evaluate(&own_fit.model, &own_fit.values, &other).unwrap();
        let left = not_followed((&own_fit, &own), (&on_other, &other)).unwrap();
        assert_eq!(left.coordinate, "held_out_tests");
        assert!(left.description.contains(", a has the largest with "), "{left:?}");
    }

    #[test]
    fn kilonewtons_are_suspected() {
        let tests = [tests(1e-3, 1.0), tests(1e-3, 1e-3)];
        let fit = |tests: &TestSet| {
            Fit::evaluate(&GreyBox::nominal(&tests.scale), &vector_of(&Nominal::NEW), tests)
        };
        assert_eq!(other_unit(fit(&tests[0]).as_ref(), &tests[0]), [""; 0]);
        let lines = other_unit(fit(&tests[1]).as_ref(), &tests[1]);
        assert!(
            lines[0].starts_with("all tests: ") && lines[0].contains("another unit"),
            "{lines:?}"
        );
    }
}
