//! Models on records that no fit has seen, and how many laws those records keep.

use super::model::Model;
use super::record::Record;
use measurement::body_record::BodyStart;

/// Share of a record from which displacement and velocity at its first sample are found.
const WINDOW: f64 = 0.05;
/// Fewest samples of that window.
const LEAST_WINDOW: usize = 24;
/// Rounds of the search for them.
const ROUNDS: usize = 12;
/// A longer model may have an error of this times the least of the shorter ones.
const MOST_ERROR: f64 = 1.05;
/// Share of the samples within the range of training that are enough to decide on them alone.
const ENOUGH: f64 = 0.2;

/// A model on one record.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HeldOut {
    /// Its motion; not a number where it runs away.
    pub(crate) motion: Vec<f64>,
    /// Displacement and velocity at the first sample.
    pub(crate) start: [f64; 2],
}

/// Samples at the beginning of a held-out record that are not compared, because the start was found
/// from them.
pub(crate) fn run_in(record: &Record) -> usize {
    if record.start != BodyStart::Moving {
        return 0;
    }
    let window = (WINDOW * record.len() as f64) as usize;
    window.max(LEAST_WINDOW).min(record.len() / 2)
}

/// Simulates a model on a record that was not fitted; the start of a moving one is found from its
/// first samples.
pub(crate) fn simulate(model: &Model, values: &[f64], record: &Record) -> HeldOut {
    let start = start(model, values, record);
    let motion = model.simulate(values, record, start);
    HeldOut { motion: motion.unwrap_or_else(|| vec![f64::NAN; record.len()]), start }
}

/// Displacement and velocity at the first sample, by Gauss and Newton with halved steps.
fn start(model: &Model, values: &[f64], record: &Record) -> [f64; 2] {
    let window = run_in(record);
    if window == 0 {
        return [0.0; 2];
    }
    let head = record.head(window);
    let sizes = [model.sizes.displacement_m, model.sizes.velocity_m_per_s];
    let misses = |start: [f64; 2]| {
        let motion = model.simulate(values, &head, start)?;
        Some(motion.iter().zip(&head.motion).map(|(a, b)| a - b).collect::<Vec<f64>>())
    };
    let sum = |misses: &[f64]| misses.iter().map(|miss| miss * miss).sum::<f64>();
    let mut best = super::search::beginning(record);
    let Some(mut here) = misses(best) else { return best };
    for _ in 0..ROUNDS {
        let slope = |number: usize| {
            let mut there = best;
            let step = 1e-4 * sizes[number];
            there[number] += step;
            let there = misses(there)?;
            let pairs = there.iter().zip(&here);
            Some(pairs.map(|(a, b)| (a - b) / step).collect::<Vec<f64>>())
        };
        let Some((over_y, over_v)) = slope(0).zip(slope(1)) else { break };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (yy, yv, vv) = (dot(&over_y, &over_y), dot(&over_y, &over_v), dot(&over_v, &over_v));
        let (y, v) = (-dot(&over_y, &here), -dot(&over_v, &here));
        let determinant = yy * vv - yv * yv;
        if determinant.is_nan() || determinant <= 1e-12 * yy * vv {
            break;
        }
        let step = [(y * vv - v * yv) / determinant, (v * yy - y * yv) / determinant];
        let tried = [1.0, 0.3, 0.1, 0.01].into_iter().find_map(|share| {
            let there = [best[0] + share * step[0], best[1] + share * step[1]];
            let misses = misses(there)?;
            (sum(&misses) < sum(&here)).then_some((there, misses))
        });
        let Some((there, misses)) = tried else { break };
        let gained = 1.0 - sum(&misses) / sum(&here);
        (best, here) = (there, misses);
        if gained < 1e-6 {
            break;
        }
    }
    best
}

/// Sum of squared errors and number of samples that are compared: those at which `counts` is true.
pub(crate) fn squares(
    record: &Record,
    motion: &[f64],
    counts: impl Fn(f64) -> bool,
) -> (f64, usize) {
    let pairs = motion.iter().zip(&record.motion).skip(run_in(record));
    let counted = pairs.filter(|(_, measured)| counts(**measured));
    counted.fold((0.0, 0), |(sum, count), (a, b)| (sum + (a - b) * (a - b), count + 1))
}

/// Root of a mean square over records.
pub(crate) fn rms_over(records: &[Record], motions: &[HeldOut]) -> f64 {
    rms_where(records, motions, |_| true).0
}

fn rms_where(
    records: &[Record],
    motions: &[HeldOut],
    counts: impl Fn(f64) -> bool + Copy,
) -> (f64, usize) {
    let pairs = records.iter().zip(motions);
    let sums = pairs.map(|(record, held)| squares(record, &held.motion, counts));
    let (sum, count) = sums.fold((0.0, 0), |(a, n), (b, m)| (a + b, n + m));
    ((sum / count as f64).sqrt(), count)
}

/// How many of the models, each with one law more, the held-out records keep: the longest whose
/// error is at most 1.05 times the least of the shorter ones. Where a fifth of the samples lies
/// within the range of training, those alone decide. The second value is the share of the samples
/// within that range.
pub(crate) fn kept(records: &[Record], stages: &[Vec<HeldOut>], range: f64) -> (usize, f64) {
    let inside = |measured: f64| measured.abs() <= range;
    let all: usize = records.iter().map(|record| record.len() - run_in(record)).sum();
    let within = stages.first().map_or(0, |motions| rms_where(records, motions, inside).1);
    let share = within as f64 / all.max(1) as f64;
    let decided_inside = share >= ENOUGH;
    let mut least = f64::INFINITY;
    let mut kept = 0;
    for (number, motions) in stages.iter().enumerate() {
        let (rms, _) = rms_where(records, motions, |value| !decided_inside || inside(value));
        if number == 0 || rms <= MOST_ERROR * least {
            kept = number;
        }
        if rms < least {
            least = rms;
        }
    }
    (kept, share)
}
