//! Which test to run next: the motion that separates what these records cannot.
//!
//! Two models A and B that predict the training tests alike are simulated on a motion. What counts
//! is the part of their difference d that no refit of B can remove, when B has to fit the training
//! tests as well. To first order, with the sensitivities S of B on the motion and those of the
//! training tests in G,
//!
//! ```text
//! separation^2 = d'd - d'S (G + S'S)^-1 S'd              per second: over the time of the motion
//! ```
//!
//! The rivals are each accepted effect and its alternatives, and, for effects that the records
//! cannot show, the model with and without them at their usual size.
//!
//! Limits: first order; motions come from the caller, who knows what a bench can do; a motion whose
//! force exceeds the limit in either model is left out.

use super::candidate::candidates;
use super::control::Control;
use super::fit::{Effort, Fit, fit, slopes};
use super::folds::grams;
use super::gram::Gram;
use super::identify::Identification;
use super::linearised::Linearised;
use super::simulation::simulate;
use super::test_set::TestSet;
use firmware_core::damper::Damper;
use firmware_core::damper::effects::{CATALOGUE, EffectInfo};
use measurement::{Measurement, MeasurementError, Series};
use rayon::prelude::*;
use serde::Serialize;

/// A difference below this share of the residual separates nothing.
const LEAST_DIFFERENCE: f64 = 0.05;

/// A motion that a bench can make.
#[derive(Debug, Clone)]
pub struct Motion {
    /// Its name.
    pub name: String,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Displacement, m.
    pub displacement_m: Vec<f64>,
}

/// A test that separates two models.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextTest {
    /// Index of the motion.
    pub motion: usize,
    /// Its name.
    pub name: String,
    /// The models that it separates.
    pub separates: [String; 2],
    /// rms of the difference that no refit removes, N.
    pub difference_n: f64,
    /// Largest force of either model, N.
    pub largest_force_n: f64,
    /// Duration of the motion, s.
    pub duration_s: f64,
}

/// Two models that the records do not separate.
struct Rivals {
    names: [String; 2],
    a: Damper,
    b: Fit,
    /// Normal equations of the second on the training tests.
    training: Gram,
}

/// For every pair of models that the records do not separate, the motion that separates them most
/// per second; the largest separation first. Empty where nothing is open, or where no motion
/// separates it.
///
/// # Errors
/// A motion that cannot be prepared as a record.
pub fn next_tests(
    found: &Identification,
    motions: &[Motion],
    largest_force_n: f64,
    control: Control<'_>,
) -> Result<Vec<NextTest>, MeasurementError> {
    let rivals = rivals(found, control);
    if rivals.is_empty() {
        return Ok(Vec::new());
    }
    control.report("motions of the next test");
    let prepared: Vec<TestSet> =
        motions.par_iter().map(prepared).collect::<Result<_, MeasurementError>>()?;
    let residual_n = found.findings.with_effects.fit().rms_n(&found.train);
    let mut tests: Vec<NextTest> = rivals
        .iter()
        .filter_map(|rivals| {
            let each = prepared.par_iter().zip(motions).enumerate();
            let separations =
                each.filter(|_| !control.is_stopped()).filter_map(|(index, (tests, motion))| {
                    let (difference_n, peak_n) = separation(rivals, tests)?;
                    (peak_n <= largest_force_n).then(|| NextTest {
                        motion: index,
                        name: motion.name.clone(),
                        separates: rivals.names.clone(),
                        difference_n,
                        largest_force_n: peak_n,
                        duration_s: motion.displacement_m.len() as f64 / motion.rate_hz,
                    })
                });
            // The mean square is the separation per second.
            separations
                .max_by(|a, b| a.difference_n.total_cmp(&b.difference_n))
                .filter(|best| best.difference_n > LEAST_DIFFERENCE * residual_n)
        })
        .collect();
    tests.sort_by(|a, b| b.difference_n.total_cmp(&a.difference_n));
    Ok(tests)
}

fn prepared(motion: &Motion) -> Result<TestSet, MeasurementError> {
    let Motion { name, rate_hz, displacement_m } = motion;
    // A motion has no force; its displacement takes that place, and nothing reads it.
    let series = Series::sampled(name, *rate_hz, displacement_m.clone(), displacement_m.clone());
    Ok(TestSet::new(vec![Measurement::from_series(series)?]))
}

/// rms of the difference that no refit removes, and the largest force, N.
fn separation(rivals: &Rivals, motion: &TestSet) -> Option<(f64, f64)> {
    let test = motion.tests.first()?;
    let b = rivals.b.model.damper(&rivals.b.values)?;
    let (a_n, b_n) = (simulate(&rivals.a, test, 0.0), simulate(&b, test, 0.0));
    let difference: Vec<f64> = a_n.iter().zip(&b_n).map(|(a, b)| a - b).collect();
    let free = rivals.b.model.free(&rivals.b.values);
    let forces = [b_n];
    let columns = slopes(&rivals.b.model, &free, &forces, &[0.0], motion);
    let columns: Vec<&[f64]> = columns.iter().map(|by_test| by_test[0].as_slice()).collect();
    let own = Gram::over(&columns, &difference);
    let joint = Gram { columns: &own.columns + &rivals.training.columns, ..own };
    let left = (joint.squares - joint.fall(&joint.solve())).max(0.0);
    let peak = a_n.iter().chain(&forces[0]).fold(0.0_f64, |most, force| most.max(force.abs()));
    Some(((left / difference.len().max(1) as f64).sqrt(), peak))
}

fn rivals(found: &Identification, control: Control<'_>) -> Vec<Rivals> {
    let mut all = Vec::new();
    let train = &found.train;
    let full = found.findings.with_effects.fit();
    for (index, accepted) in found.findings.accepted.iter().enumerate() {
        for name in &accepted.alternatives {
            control.report(&format!("fitting {name} in place of {}", accepted.name));
            let Some(b) = in_place_of(full, index, name, train, control) else { continue };
            let names = [accepted.name.to_owned(), (*name).to_owned()];
            all.extend(pair(names, found.damper.clone(), b, train));
        }
    }
    for hidden in &found.findings.not_testable {
        let Some(a) = with_usual(full, hidden.name, train) else { continue };
        let names = [format!("with {}", hidden.name), "without it".to_owned()];
        all.extend(pair(names, a, full.clone(), train));
    }
    all
}

fn pair(names: [String; 2], a: Damper, b: Fit, train: &TestSet) -> Option<Rivals> {
    let linearised = Linearised::new(b.clone(), train);
    Some(Rivals { names, a, b, training: Gram::sum(grams(&linearised, train).iter())? })
}

fn effect(name: &str) -> Option<&'static EffectInfo> {
    CATALOGUE.iter().find(|info| info.name == name)
}

/// The model with another effect in the place of one of its own, fitted from all its starts.
fn in_place_of(
    full: &Fit,
    index: usize,
    name: &str,
    train: &TestSet,
    control: Control<'_>,
) -> Option<Fit> {
    let (model, values) = full.with_effects_kept(|k| k != index, &train.scale);
    let candidate =
        candidates(&model, train).into_iter().find(|candidate| candidate.effect.name == name)?;
    let model = model.with(candidate.effect, &train.scale);
    let starts = candidate.starts.iter().map(|start| [values.as_slice(), start].concat());
    let fits = starts.filter_map(|start| fit(&model, &start, train, Effort::TRIAL, control));
    fits.min_by(|a, b| a.total_n2().total_cmp(&b.total_n2()))
}

/// The model with an effect at its usual size.
fn with_usual(full: &Fit, name: &str, train: &TestSet) -> Option<Damper> {
    let info = effect(name)?;
    let model = full.model.with(info, &train.scale);
    let usual = info.parameters.iter().map(|row| row.usual(&train.scale));
    model.damper(&full.values.iter().copied().chain(usual).collect::<Vec<_>>())
}
