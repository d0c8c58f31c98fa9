//! The noise floor of the training tests: known, bounded from below, or unknown.
//!
//! | source | result |
//! | --- | --- |
//! | successive cycles of a test ([`super::repeat`]) | the floor |
//! | two tests with the same motion | the floor |
//! | samples that pass a test for white noise, of force or residual | a lower bound |
//! | the force while the damper rests | a lower bound |
//!
//! The first source that applies counts. Where none does, the noise is unknown, and nothing stands
//! in for it: the residual of a model that lacks something is no noise.

use super::repeat::Repeat;
use super::same_motion;
use super::size::Size;
use crate::test_set::TestSet;
use measurement::noise::{NoiseSource, rest, rounding_n, white};

/// Share of the squared floor that must remain without lines.
const LEAST_REST: f64 = 0.5;

/// What is known about the noise of the force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseFloor {
    /// rms of the noise, N, where cycles or tests repeat.
    pub floor_n: Option<f64>,
    /// A lower bound, N, where there is one and the floor is unknown.
    pub at_least_n: Option<f64>,
    /// White noise of the samples, or noise at rest, N, whether the floor is known or not: all of
    /// the noise but what is slower or coloured.
    pub of_samples_n: Option<f64>,
    /// How it was found.
    pub method: &'static str,
}

impl NoiseFloor {
    /// From the first source that applies. `lines_n` is the rms of lines in the spectrum of the
    /// residual, which are no noise even where they do not repeat with the cycle.
    ///
    /// A difference between cycles that grows with the force is no noise: a valve that switches
    /// makes cycles differ too. Then nothing that repeats counts as a source.
    pub(crate) fn of(
        residual_n: &[Vec<f64>],
        (repeat, size): (&Repeat, &Size),
        lines_n: f64,
        tests: &TestSet,
    ) -> Self {
        let (square, source) = lower_bound(residual_n, tests);
        let of_samples_n = source.map(|_| square.sqrt());
        let known = |floor_n: f64, method| {
            let floor_n = without_lines(floor_n, lines_n, repeat)?;
            Some(Self { floor_n: Some(floor_n), at_least_n: None, of_samples_n, method })
        };
        let by_cycles = repeat.noise_floor_n.and_then(|floor_n| {
            known(floor_n, "difference of the residual between successive cycles")
        });
        let by_tests = || {
            let floor_n = same_motion::noise_floor_n(residual_n, tests)?;
            known(floor_n, "difference of the residual between tests with the same motion")
        };
        if !size.is_strong()
            && repeat.growing_n.is_none()
            && let Some(known) = by_cycles.or_else(by_tests)
        {
            return known;
        }
        let unknown = Self {
            floor_n: None,
            at_least_n: of_samples_n,
            of_samples_n,
            method: "unknown: no cycle and no test repeats without other disturbances, the noise \
                     of the samples is not white, and the damper never rests",
        };
        match source {
            None => unknown,
            Some(source) => Self { method: source.name(), ..unknown },
        }
    }
}

/// The floor without lines that do not repeat with the cycle, which are no noise; none where they
/// are most of it, since the rest is then not known.
fn without_lines(floor_n: f64, lines_n: f64, repeat: &Repeat) -> Option<f64> {
    if lines_n <= repeat.repeated_in_all_rms_n {
        return Some(floor_n);
    }
    let rest = floor_n * floor_n - lines_n * lines_n;
    (rest > LEAST_REST * floor_n * floor_n).then(|| rest.sqrt())
}

/// Mean square of a lower bound over all tests, N2, and the source that gives most of it. A test
/// without a bound counts as free of noise.
fn lower_bound(residual_n: &[Vec<f64>], tests: &TestSet) -> (f64, Option<NoiseSource>) {
    let each = tests.tests.iter().zip(residual_n).filter_map(|(test, residual)| {
        let record = &test.record;
        let signals = [&record.force_n, residual];
        let least = |of: &dyn Fn(&[f64]) -> Option<f64>| {
            signals.iter().filter_map(|signal| of(signal)).reduce(f64::min)
        };
        let white_n = least(&|signal| white::rms(signal));
        let (rms_n, source) = white_n.map(|rms_n| (rms_n, NoiseSource::White)).or_else(|| {
            rest::rms_n(record, &record.force_n).map(|rms_n| (rms_n, NoiseSource::Rest))
        })?;
        Some((rms_n.max(rounding_n(&record.force_n)), test.counted().len(), source))
    });
    let found: Vec<(f64, usize, NoiseSource)> = each.collect();
    let square = mean_square(found.iter().map(|(rms_n, count, _)| (*rms_n, *count)), tests);
    let samples = |source: NoiseSource| -> usize {
        found.iter().filter(|(_, _, own)| *own == source).map(|(_, count, _)| count).sum()
    };
    let source = found.iter().map(|(_, _, source)| *source).max_by_key(|source| samples(*source));
    (square, source)
}

fn mean_square(each: impl Iterator<Item = (f64, usize)>, tests: &TestSet) -> f64 {
    let counted: usize = tests.tests.iter().map(|test| test.counted().len()).sum();
    each.map(|(rms, count)| rms * rms * count as f64).sum::<f64>() / counted.max(1) as f64
}
