//! The strength at which an effect has the wanted size.
//!
//! ```text
//! size = sqrt(rms(with)^2 - rms(without)^2) / rms of the noise        over all training tests
//! rms = that of (force without noise - nominal damper refitted to it)
//! ```
//!
//! What the nominal damper can absorb does not count, nor does what the recorder's filter makes of
//! a damper without the effect, and neither does a triangle whose force without noise is flat but
//! for rounding. The search over strengths fits from the true numbers and simulates in longer
//! steps; the size that is stated is that in steps as short as they should be, after the same
//! many-start fit with which `identify` begins.

use super::case::Case;
use super::noise::silent;
use crate::error::EvidenceError;
use identification::{Control, Effort, GreyBox, TestSet, fit, nominal_fit, vector_of};
use measurement::Measurement;
use std::sync::atomic::AtomicBool;
use virtual_bench::bench_visit::protocol::Test;
use virtual_bench::bench_visit::sensors::Sensors;
use virtual_bench::bench_visit::specimen::{Load, Response};
use virtual_bench::bench_visit::{NullGenerator, RawRecord, Specimen, measurements, visit_until};

/// Strengths that are tried, at most.
const TRIES: usize = 14;
/// Corrections by the many-start fit, at most.
const CORRECTIONS: usize = 3;
/// Strength over the one before, while climbing.
const CLIMB: f64 = 4.0;
/// How near is near enough.
const NEAR: f64 = 0.06;
/// Size below which a search sees no difference.
const LEAST_SIZE: f64 = 0.02;
/// Share of the range of the load cell that a force may use, in rough steps and in fine ones.
const RANGE_SHARES: [f64; 2] = [0.8, 0.85];
/// Steps of a specimen while its strength is looked for, in those that it needs.
const ROUGH: f64 = 5.0;

/// A strength and the size that it gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sized {
    /// The strength.
    pub strength: f64,
    /// rms after the refit, in multiples of the noise.
    pub size: f64,
    /// The size is the wanted one.
    pub reached: bool,
}

/// Finds the least strength between two at which a specimen has the size that its case wants; the
/// strongest where that is too weak. `None` where even the weakest cannot be simulated, or once the
/// work is stopped.
///
/// A size may fall again beyond some strength (a valve that does nothing but relieve, a delay of
/// half a period), so the search climbs from below.
pub(super) fn sized(
    case: &Case,
    make: &dyn Fn(f64) -> Option<Box<dyn Specimen>>,
    [weakest, strongest]: [f64; 2],
    control: Control<'_>,
) -> Option<Sized> {
    debug_assert!(0.0 < weakest && weakest < strongest, "{weakest} to {strongest}");
    let noise_n = case.noise_n();
    let wanted = case.of.size;
    let plain = NullGenerator { model: case.series_model(), outside: Vec::new() };
    let without_n = [false, true].map(|thorough| rms_n(case, &plain, thorough, control));
    let [Some(quick_n), Some(thorough_n)] = without_n else { return None };
    let over = |with_n: f64, without_n: f64| {
        (with_n * with_n - without_n * without_n).max(0.0).sqrt() / noise_n
    };
    let quick = |k: f64| Some(over(rms_n(case, &*make(k)?, false, control)?, quick_n));
    let thorough = |k: f64| Some(over(rms_n(case, &*make(k)?, true, control)?, thorough_n));
    let mut target = wanted;
    let mut from = weakest;
    let mut best: Option<Sized> = None;
    for _ in 0..CORRECTIONS {
        let (at, found) = climb(&quick, target, from, strongest)?;
        let size = thorough(at)?;
        let off = |size: f64| (libm::log(size.max(1e-300) / wanted)).abs();
        if best.is_none_or(|best| off(size) < off(best.size)) {
            best = Some(Sized { strength: at, size, reached: off(size) < 2.0 * NEAR });
        }
        if off(size) < NEAR || (!found && size < wanted) {
            break;
        }
        // The many-start fit leaves less: aim higher by as much.
        target *= wanted / size;
        from = (at / (CLIMB * CLIMB)).max(weakest);
    }
    best
}

/// Climbs to the first strength that is too strong, and searches below it. Where none is, the
/// strength of the largest size that was met, and false.
fn climb(
    quick: &dyn Fn(f64) -> Option<f64>,
    target: f64,
    from: f64,
    strongest: f64,
) -> Option<(f64, bool)> {
    let mut low = (from, quick(from)?);
    let mut largest = low;
    while low.1 < target {
        if low.1 > largest.1 {
            largest = low;
        }
        if low.0 >= strongest {
            return Some((largest.0, false));
        }
        let next = (CLIMB * low.0).min(strongest);
        match quick(next) {
            Some(size) if size < target => low = (next, size),
            // A damper that cannot be is stronger than any.
            high => return Some((between(quick, target, low, (next, high)), true)),
        }
    }
    Some((from, true))
}

/// False position in logarithms, halving the weight of an end that stays (Illinois).
fn between(
    quick: &dyn Fn(f64) -> Option<f64>,
    target: f64,
    mut low: (f64, f64),
    mut high: (f64, Option<f64>),
) -> f64 {
    let off = |size: f64| libm::log(size.max(LEAST_SIZE) / target);
    let (mut below, mut above) = (off(low.1), high.1.map(off));
    for _ in 0..TRIES {
        let (from, to) = (libm::log(low.0), libm::log(high.0));
        let share = above.map_or(0.5, |above| (below / (below - above)).clamp(0.05, 0.95));
        let at = libm::exp(from + share * (to - from));
        let Some(size) = quick(at) else {
            (high, above) = ((at, None), None);
            continue;
        };
        let error = off(size);
        if error.abs() < 0.5 * NEAR {
            return at;
        }
        if error < 0.0 {
            (low, below) = ((at, size), error);
            above = above.map(|above| 0.5 * above);
        } else {
            (high, above) = ((at, Some(size)), Some(error));
            below *= 0.5;
        }
    }
    low.0
}

/// Residual of the nominal damper on the force without noise, N; none where the force leaves the
/// range of the load cell, and once the work is stopped.
fn rms_n(
    case: &Case,
    specimen: &dyn Specimen,
    thorough: bool,
    control: Control<'_>,
) -> Option<f64> {
    let rough = Rough { specimen };
    let specimen = if thorough { specimen } else { &rough };
    let (fitted, sensors) = (&case.tests.train, silent(&case.sensors));
    let mut visited = visited(control.stop, specimen, fitted, &sensors, case.seed)?;
    let forces = visited.iter().flat_map(|record| &record.force_n);
    let peak_n = forces.fold(0.0, |most: f64, force| most.max(force.abs()));
    if peak_n > RANGE_SHARES[usize::from(thorough)] * case.sensors.force.range {
        return None;
    }
    visited.retain(|record| !record.is_flat_but_for_rounding() && record.measurement().is_ok());
    let tests = TestSet::new(measurements(&visited).ok()?);
    let truth = vector_of(&case.nominal);
    let nominal = GreyBox::nominal(&tests.scale);
    let mut best = fit(&nominal, &truth, &tests, Effort::FULL, control)?;
    if thorough {
        let other = nominal_fit(&tests, None, control)?.fit;
        if other.total_n2() < best.total_n2() {
            best = other;
        }
    }
    Some(best.rms_n(&tests))
}

/// A specimen in longer steps than it needs: enough to find about how strong an effect must be.
struct Rough<'a> {
    specimen: &'a dyn Specimen,
}

impl Specimen for Rough<'_> {
    fn longest_step_s(&self) -> f64 {
        ROUGH * self.specimen.longest_step_s()
    }

    fn respond(&self, load: &Load<'_>) -> Response {
        self.specimen.respond(load)
    }
}

/// The records of some tests; none once `stop` is set.
fn visited(
    stop: &AtomicBool,
    specimen: &dyn Specimen,
    tests: &[Test],
    sensors: &Sensors,
    seed: u64,
) -> Option<Vec<RawRecord>> {
    let visited = visit_until(stop, specimen, tests, sensors, seed, &mut |_| {});
    (visited.len() == tests.len()).then_some(visited)
}

/// The records of a visit to a case's specimen.
///
/// # Errors
/// What makes a record unfit; the work is stopped.
pub(super) fn records(
    case: &Case,
    specimen: &dyn Specimen,
    sensors: &Sensors,
    tests: &[Test],
    stop: &AtomicBool,
) -> Result<Vec<Measurement>, EvidenceError> {
    let visited =
        visited(stop, specimen, tests, sensors, case.seed).ok_or(EvidenceError::Stopped)?;
    Ok(measurements(&visited)?)
}
