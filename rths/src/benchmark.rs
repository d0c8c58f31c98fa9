//! All runs of the benchmark, and what became of them.

use crate::case::CASES;
use crate::controllers::{ADAPTIVE, BASELINE, COMPENSATORS, Candidate, INVERSE, ON_PLANTS};
use crate::criteria::{Criteria, deviation};
use crate::error::RthsError;
use crate::plants::perturbed;
use crate::published::{AIM_J4_PERCENT, TABLE_3, TOLERANCE};
use crate::record::Record;
use crate::simulation::{self, INTENSITY, SAMPLES_PER_S, STEP_S, Setup};
use crate::structure::{FLOORS, Structure};
use rayon::prelude::*;
use rig_emulator::BenchmarkPlant;
use serde::Serialize;
use signal::random::Random;
use signal::statistics::mean;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Realisations of the noise over which the baseline is averaged: J3 and J5 are peaks, in which one
/// realisation has a standard deviation of up to 0.2 points.
pub const NOISE_SEEDS: usize = 64;
/// Plants of case 1 that are drawn.
pub const PLANTS: usize = 20;
/// Unknown delays in addition, samples: 0.49, 0.98, 1.95 and 2.9 ms.
const EXTRA_SAMPLES: [usize; 4] = [2, 4, 8, 12];

/// First stream of the noise and of the plants.
const NOISE_STREAM: u64 = 1000;
const PLANT_STREAM: u64 = 2000;

/// All results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Benchmark {
    /// Duration of the record, s.
    pub duration_s: f64,
    /// Peak of the record, m/s2.
    pub peak_m_per_s2: f64,
    /// Seed of noise, plants and synthetic record.
    pub seed: u64,
    /// The baseline, compared with the published table where it is of this record.
    pub baseline: Vec<BaselineRow>,
    /// Our compensators on the nominal plant.
    pub nominal: Vec<NominalRow>,
    /// Controllers on the perturbed plants of case 1.
    pub perturbed: Vec<PerturbedRow>,
    /// Controllers with an unknown delay in addition, case 1.
    pub extra_delay: Vec<DelayRow>,
    /// What is asked of the adaptive compensator.
    pub aims: Vec<Aim>,
}

impl Benchmark {
    /// The criteria in which the baseline is further from the published table than the tolerance;
    /// nothing where the table is of another record.
    pub fn outside(&self) -> Option<Vec<Outside>> {
        let mut outside = Vec::new();
        for row in &self.baseline {
            let difference = row.difference?;
            outside.extend((1..=9).map(|number| Outside {
                case: row.case,
                number,
                difference: difference.j(number),
                most: TOLERANCE.j(number),
                deviation: row.deviation.j(number),
            }));
        }
        // A difference that is no number is outside too.
        outside.retain(|criterion| {
            criterion.difference.is_nan() || criterion.difference.abs() > criterion.most
        });
        Some(outside)
    }
}

/// A criterion that is further from the published one than its tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Outside {
    /// The case.
    pub case: u8,
    /// The number of the criterion.
    pub number: usize,
    /// Mean minus published.
    pub difference: f64,
    /// The tolerance.
    pub most: f64,
    /// Standard deviation of one realisation of the noise.
    pub deviation: f64,
}

/// The baseline in one case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BaselineRow {
    /// The case.
    pub case: u8,
    /// Mean over the realisations of the noise.
    pub mean: Criteria,
    /// Standard deviation over the realisations.
    pub deviation: Criteria,
    /// Mean minus published.
    pub difference: Option<Criteria>,
}

/// A compensator in one case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NominalRow {
    /// The compensator.
    pub compensator: &'static str,
    /// The case.
    pub case: u8,
    /// The criteria.
    pub criteria: Criteria,
    /// J2 without the noise of the displacement, %.
    pub j2_without_noise_percent: f64,
    /// Whether the force reached its limit: the loop is unstable.
    pub is_saturated: bool,
    /// Whether the estimate ran away and the start values were used.
    pub has_run_away: bool,
}

/// A controller on the perturbed plants.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PerturbedRow {
    /// The controller.
    pub controller: &'static str,
    /// J2, %.
    pub j2_percent: Statistics,
    /// J4, %.
    pub j4_percent: Statistics,
    /// On how many plants the force reached its limit.
    pub saturated: u64,
    /// On how many plants the estimate ran away.
    pub run_away: u64,
}

/// Mean, largest and standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Statistics {
    /// The mean.
    pub mean: f64,
    /// The largest.
    pub max: f64,
    /// The standard deviation.
    pub sigma: f64,
}

impl Statistics {
    fn of(values: &[f64]) -> Self {
        let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self { mean: mean(values), max, sigma: deviation(values) }
    }
}

/// A controller with an unknown delay in addition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DelayRow {
    /// The controller.
    pub controller: &'static str,
    /// The delay, s.
    pub delay_s: f64,
    /// The criteria, case 1.
    pub criteria: Criteria,
    /// Whether the force reached its limit: the loop is unstable.
    pub is_saturated: bool,
    /// Whether the estimate ran away.
    pub has_run_away: bool,
}

/// A criterion that is asked of the adaptive compensator.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Aim {
    /// What is asked.
    pub what: &'static str,
    /// What was found, %.
    pub found_percent: f64,
    /// The most that is asked, %.
    pub most_percent: f64,
    /// Whether it is met.
    pub is_met: bool,
}

/// One run: which, and what of it differs from the nominal run.
#[derive(Debug, Clone, Copy)]
struct Job {
    controller: Candidate,
    case: usize,
    noise: u64,
    has_displacement_noise: bool,
    plant: Option<u64>,
    extra_samples: usize,
}

impl Job {
    const fn nominal(controller: Candidate, case: usize) -> Self {
        let has_displacement_noise = true;
        Self { controller, case, noise: 0, has_displacement_noise, plant: None, extra_samples: 0 }
    }
}

/// What a run leaves.
#[derive(Debug, Clone, Copy)]
struct Outcome {
    criteria: Criteria,
    is_saturated: bool,
    has_run_away: bool,
}

/// What all runs of a record share.
struct Ground {
    /// Acceleration in half steps, m/s2.
    acceleration_m_per_s2: Vec<f64>,
    /// The whole frame of each case and its motion.
    wholes: Vec<(Structure, Vec<[f64; FLOORS]>)>,
    seed: u64,
}

impl Ground {
    fn new(record: &Record, seed: u64) -> Self {
        let acceleration_m_per_s2 = record.in_steps(0.5 * STEP_S, INTENSITY);
        let whole = |case| {
            let whole = Structure::whole(case);
            (whole, simulation::reference_m(&whole, &acceleration_m_per_s2))
        };
        let wholes = CASES.into_iter().map(whole).collect();
        Self { acceleration_m_per_s2, wholes, seed }
    }

    fn run(&self, job: &Job) -> Outcome {
        let (whole, reference) = &self.wholes[job.case];
        let plant = job.plant.map_or_else(BenchmarkPlant::nominal, |plant| {
            perturbed(&mut Random::new(self.seed, PLANT_STREAM + plant))
        });
        let trace = simulation::run(Setup {
            whole: *whole,
            plant,
            ground_m_per_s2: &self.acceleration_m_per_s2,
            random: Random::new(self.seed, NOISE_STREAM + job.noise),
            has_displacement_noise: job.has_displacement_noise,
            extra_samples: job.extra_samples,
            controller: job.controller.controller(),
        });
        Outcome {
            criteria: Criteria::of(&trace, reference, STEP_S),
            is_saturated: trace.is_saturated,
            has_run_away: trace.has_run_away,
        }
    }
}

/// Runs the whole benchmark on all cores; `done` is called with the runs that are done and all.
///
/// # Errors
/// [`RthsError::Stopped`] where `stop` was set.
pub fn run(
    record: &Record,
    seed: u64,
    stop: &AtomicBool,
    done: &(dyn Fn(usize, usize) + Sync),
) -> Result<Benchmark, RthsError> {
    let baseline: Vec<Job> = cases()
        .flat_map(|case| {
            let noises = 0..NOISE_SEEDS as u64;
            noises.map(move |noise| Job { noise, ..Job::nominal(BASELINE, case) })
        })
        .collect();
    let nominal: Vec<Job> = COMPENSATORS
        .into_iter()
        .flat_map(|candidate| cases().map(move |case| Job::nominal(candidate, case)))
        .flat_map(|job| [job, Job { has_displacement_noise: false, ..job }])
        .collect();
    let perturbed: Vec<Job> = ON_PLANTS
        .into_iter()
        .flat_map(|candidate| {
            let plants = 0..PLANTS as u64;
            plants.map(move |plant| Job {
                noise: plant,
                plant: Some(plant),
                ..Job::nominal(candidate, 0)
            })
        })
        .collect();
    let delayed: Vec<Job> = [BASELINE, INVERSE, ADAPTIVE]
        .into_iter()
        .flat_map(|candidate| {
            EXTRA_SAMPLES.map(|extra_samples| Job { extra_samples, ..Job::nominal(candidate, 0) })
        })
        .collect();
    let jobs = [&*baseline, &*nominal, &*perturbed, &*delayed].concat();
    let ground = Ground::new(record, seed);
    let count = AtomicUsize::new(0);
    let outcomes: Result<Vec<Outcome>, RthsError> = jobs
        .par_iter()
        .map(|job| {
            if stop.load(Ordering::Relaxed) {
                return Err(RthsError::Stopped);
            }
            let outcome = ground.run(job);
            done(count.fetch_add(1, Ordering::Relaxed) + 1, jobs.len());
            Ok(outcome)
        })
        .collect();
    let mut outcomes = outcomes?.into_iter();
    let mut of = |jobs: &[Job]| -> Vec<(Job, Outcome)> {
        jobs.iter().copied().zip(outcomes.by_ref()).collect()
    };
    let baseline = baseline_rows(&of(&baseline), record.is_of_published_table());
    let nominal = nominal_rows(&of(&nominal));
    let perturbed = perturbed_rows(&of(&perturbed));
    let extra_delay = of(&delayed).iter().map(delay_row).collect();
    let aims = aims(&nominal, &perturbed);
    Ok(Benchmark {
        duration_s: record.duration_s(),
        peak_m_per_s2: record.peak_m_per_s2(),
        seed,
        baseline,
        nominal,
        perturbed,
        extra_delay,
        aims,
    })
}

fn cases() -> std::ops::Range<usize> {
    0..CASES.len()
}

/// One row per case, of its realisations.
fn baseline_rows(runs: &[(Job, Outcome)], is_compared: bool) -> Vec<BaselineRow> {
    runs.chunks(NOISE_SEEDS)
        .zip(CASES.into_iter().zip(TABLE_3))
        .map(|(runs, (case, published))| {
            let criteria: Vec<Criteria> = runs.iter().map(|(_, run)| run.criteria).collect();
            let [mean, deviation] = Criteria::mean_and_deviation(&criteria);
            let difference = Criteria(std::array::from_fn(|n| mean.0[n] - published.0[n]));
            let difference = is_compared.then_some(difference);
            BaselineRow { case: case.number, mean, deviation, difference }
        })
        .collect()
}

/// One row per run with noise, which its run without noise follows.
fn nominal_rows(runs: &[(Job, Outcome)]) -> Vec<NominalRow> {
    let pairs = runs.chunks_exact(2).filter_map(|pair| match pair {
        [(job, noisy), (_, quiet)] => Some((job, noisy, quiet)),
        _ => None,
    });
    pairs
        .map(|(job, noisy, quiet)| NominalRow {
            compensator: job.controller.name,
            case: CASES[job.case].number,
            criteria: noisy.criteria,
            j2_without_noise_percent: quiet.criteria.j(2),
            is_saturated: noisy.is_saturated,
            has_run_away: noisy.has_run_away,
        })
        .collect()
}

/// One row per controller, of its plants.
fn perturbed_rows(runs: &[(Job, Outcome)]) -> Vec<PerturbedRow> {
    runs.chunk_by(|(a, _), (b, _)| a.controller.name == b.controller.name)
        .map(|runs| {
            let statistics = |number: usize| {
                Statistics::of(
                    &runs.iter().map(|(_, run)| run.criteria.j(number)).collect::<Vec<_>>(),
                )
            };
            let count =
                |is: fn(&Outcome) -> bool| runs.iter().filter(|(_, run)| is(run)).count() as u64;
            PerturbedRow {
                controller: runs.first().map_or("", |(job, _)| job.controller.name),
                j2_percent: statistics(2),
                j4_percent: statistics(4),
                saturated: count(|run| run.is_saturated),
                run_away: count(|run| run.has_run_away),
            }
        })
        .collect()
}

fn delay_row((job, run): &(Job, Outcome)) -> DelayRow {
    DelayRow {
        controller: job.controller.name,
        delay_s: job.extra_samples as f64 / SAMPLES_PER_S,
        criteria: run.criteria,
        is_saturated: run.is_saturated,
        has_run_away: run.has_run_away,
    }
}

/// What is asked of the adaptive compensator.
fn aims(nominal: &[NominalRow], perturbed: &[PerturbedRow]) -> Vec<Aim> {
    let [most_of_cases, most_of_plants] = AIM_J4_PERCENT;
    let ours = nominal.iter().filter(|row| row.compensator == ADAPTIVE.name);
    let worst = ours.map(|row| row.criteria.j(4)).fold(f64::NEG_INFINITY, f64::max);
    let plants = perturbed.iter().find(|row| row.controller == ADAPTIVE.name);
    let mean = plants.map_or(f64::NAN, |row| row.j4_percent.mean);
    [
        ("J4 of the worst case", worst, most_of_cases),
        ("mean J4 of the perturbed plants of case 1", mean, most_of_plants),
    ]
    .into_iter()
    .map(|(what, found_percent, most_percent)| Aim {
        what,
        found_percent,
        most_percent,
        is_met: found_percent <= most_percent,
    })
    .collect()
}
