//! A set of tests: records as the models see them, cut into the pieces in which errors are counted.
//!
//! - A **piece** is left out as a whole when models are judged: a whole test, or, with fewer than
//!   four tests, a run of whole cycles with a guard gap to its neighbours.
//! - A **block** is the smallest stretch whose errors are taken as independent of those of the next
//!   one: whole cycles of at least a quarter of a second together.
//!
//! The run-in of a test belongs to neither: no error counts it.

use firmware_core::damper::effects::Scale;
use measurement::Measurement;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Longest step of a model between two samples, s.
const LONGEST_STEP_S: f64 = 1e-3;
/// The same where only a start is searched.
const LONGEST_ROUGH_STEP_S: f64 = 5e-3;
/// Sampling period that is enough where only a start is searched, s.
const ROUGH_SAMPLING_S: f64 = 2e-3;
/// Share of the largest force from which a test is under way.
const UNDER_WAY: f64 = 0.5;
/// Shortest block, s.
const SHORTEST_BLOCK_S: f64 = 0.25;
/// Fewest tests that are left out one by one.
const FEWEST_WHOLE_TESTS: usize = 4;
/// Pieces that fewer tests are cut into.
const PIECES_OF_FEW_TESTS: usize = 6;

/// Fewest runs that can judge within a test.
const FEWEST_RUNS: usize = 3;

/// Records ready for models.
#[derive(Debug, Clone)]
pub struct TestSet {
    /// The tests, in the order given.
    pub tests: Vec<Test>,
    /// Pieces, in order of tests and time.
    pub pieces: Vec<Piece>,
    /// True when every piece is a whole test.
    pub whole_tests: bool,
    /// The size of these records.
    pub scale: Scale,
}

/// A record with the steps of the model in it.
#[derive(Debug, Clone)]
pub struct Test {
    /// The record.
    pub record: Measurement,
    /// Model steps from sample to sample.
    pub substeps: usize,
    /// Blocks, in order of time.
    pub blocks: Vec<Range<usize>>,
    /// Steps that models have made on all tests of the set and on their beginnings.
    steps_made: Arc<AtomicU64>,
}

/// A stretch of a test that is left out as a whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Piece {
    /// Index of the test.
    pub test: usize,
    /// Its samples.
    pub samples: Range<usize>,
}

impl TestSet {
    /// Prepares records.
    pub fn new(records: Vec<Measurement>) -> Self {
        let scale = scale_of(&records);
        Self::with_scale(records, scale, &Arc::default())
    }

    fn with_scale(records: Vec<Measurement>, scale: Scale, steps_made: &Arc<AtomicU64>) -> Self {
        let tests: Vec<Test> =
            records.into_iter().map(|record| Test::new(record, steps_made.clone())).collect();
        let whole_tests = tests.len() >= FEWEST_WHOLE_TESTS;
        let mut pieces = Vec::new();
        for (index, test) in tests.iter().enumerate() {
            if whole_tests {
                pieces.push(Piece { test: index, samples: test.counted() });
            } else {
                let per_test = PIECES_OF_FEW_TESTS.div_ceil(tests.len());
                pieces.extend(
                    test.runs_of_blocks(per_test)
                        .into_iter()
                        .map(|samples| Piece { test: index, samples }),
                );
            }
        }
        debug_assert!(
            pieces.iter().all(|piece| piece.samples.end <= tests[piece.test].record.len()),
            "every piece lies inside its test"
        );
        Self { tests, pieces, whole_tests, scale }
    }

    /// The same tests with one piece cut into runs of whole blocks, which lie in its place; none
    /// where it has too few blocks.
    pub(crate) fn with_runs_of(&self, piece: usize) -> Option<(Self, Range<usize>)> {
        debug_assert!(piece < self.pieces.len(), "no piece {piece}");
        let Piece { test, .. } = self.pieces[piece];
        let blocks: Vec<Range<usize>> = self.blocks(&self.pieces[piece]).collect();
        let per_run = blocks.len().div_ceil(PIECES_OF_FEW_TESTS).max(1);
        let runs: Vec<Piece> = blocks
            .chunks(per_run)
            .filter_map(|run| Some(run.first()?.start..run.last()?.end))
            .map(|samples| Piece { test, samples })
            .collect();
        let places = piece..piece + runs.len();
        if runs.len() < FEWEST_RUNS {
            return None;
        }
        let mut cut = self.clone();
        cut.pieces.splice(piece..=piece, runs);
        Some((cut, places))
    }

    /// The blocks of a piece, as samples of its test.
    pub fn blocks(&self, piece: &Piece) -> impl Iterator<Item = Range<usize>> {
        let Range { start, end } = piece.samples;
        let blocks = self.tests[piece.test].blocks.iter();
        let within = blocks.map(move |block| block.start.max(start)..block.end.min(end));
        within.filter(|block| !block.is_empty())
    }

    /// Samples in all pieces.
    pub fn counted_samples(&self) -> usize {
        self.pieces.iter().map(|piece| piece.samples.len()).sum()
    }

    /// The lowest sampling rate of the records, Hz.
    pub fn lowest_rate_hz(&self) -> f64 {
        let rates = self.tests.iter().map(|test| 1.0 / test.record.step_s);
        // A time column in milliseconds rounds the rate.
        rates.fold(f64::INFINITY, f64::min) * (1.0 + 1e-6)
    }

    /// The processing of a record that has destroyed the traces of an effect, if there is one.
    pub fn destroyed(&self, effect: &str) -> Option<&str> {
        self.tests.iter().find_map(|test| test.record.destroyed.get(effect).map(String::as_str))
    }

    /// Simulation so far, in passes of a model over all tests.
    pub fn passes(&self) -> f64 {
        let steps: usize = self.tests.iter().map(|test| test.record.len() * test.substeps).sum();
        let made = self.tests.first().map_or(0, |test| test.steps_made.load(Ordering::Relaxed));
        made as f64 / steps.max(1) as f64
    }

    /// rms of the measured force over all pieces, N.
    pub fn rms_force_n(&self) -> f64 {
        let sum: f64 = self
            .pieces
            .iter()
            .flat_map(|piece| &self.tests[piece.test].record.force_n[piece.samples.clone()])
            .map(|force| force * force)
            .sum();
        (sum / self.counted_samples().max(1) as f64).sqrt()
    }

    /// rms error of a simulated force over all tests without their run-ins, whatever they are cut
    /// into, N.
    pub fn rmse_n(&self, force_n: &[Vec<f64>]) -> Option<f64> {
        let (mut sum, mut count) = (0.0, 0);
        for (test, force_n) in self.tests.iter().zip(force_n) {
            let samples = test.counted().len();
            sum += test.rmse_n(force_n) * test.rmse_n(force_n) * samples as f64;
            count += samples;
        }
        (count > 0).then(|| (sum / count as f64).sqrt())
    }

    /// rms of the measured force over the samples that [`Self::rmse_n`] counts, N.
    pub fn measured_rms_n(&self) -> Option<f64> {
        let none: Vec<Vec<f64>> =
            self.tests.iter().map(|test| vec![0.0; test.record.len()]).collect();
        self.rmse_n(&none)
    }

    /// The same tests with every `factor`-th sample, and models with longer steps.
    #[must_use]
    pub(crate) fn thinned(&self, factor: usize, longest_steps_s: &[f64]) -> Self {
        debug_assert_eq!(longest_steps_s.len(), self.tests.len(), "one step per test");
        let records = self.tests.iter().map(|test| test.record.thinned(factor));
        let steps_made = self.tests.first().map(|test| test.steps_made.clone()).unwrap_or_default();
        let mut thinned = Self::with_scale(records.collect(), self.scale, &steps_made);
        for (test, longest_s) in thinned.tests.iter_mut().zip(longest_steps_s) {
            test.substeps = substeps(test.record.step_s, *longest_s);
        }
        thinned
    }

    /// The same tests cut short once they are under way, with fewer samples and longer steps:
    /// enough to search for start values. Their scale stays that of the whole.
    #[must_use]
    pub fn beginnings(&self, longest_s: f64) -> Self {
        let records = self.tests.iter().map(|test| {
            let record = &test.record;
            let samples = (longest_s / record.step_s) as usize;
            let thinner = (ROUGH_SAMPLING_S / record.step_s + 1e-6) as usize;
            // A test that begins gently shows little before it is under way.
            let begin = record.run_in.max(test.loaded(UNDER_WAY));
            record.until(begin.saturating_add(samples.max(20))).thinned(thinner)
        });
        let steps_made = self.tests.first().map(|test| test.steps_made.clone()).unwrap_or_default();
        let mut beginnings = Self::with_scale(records.collect(), self.scale, &steps_made);
        for test in &mut beginnings.tests {
            test.substeps = substeps(test.record.step_s, LONGEST_ROUGH_STEP_S);
        }
        beginnings
    }
}

impl Test {
    fn new(record: Measurement, steps_made: Arc<AtomicU64>) -> Self {
        let substeps = substeps(record.step_s, LONGEST_STEP_S);
        let blocks = blocks_of(&record);
        Self { record, substeps, blocks, steps_made }
    }

    /// The same test with another displacement.
    pub(crate) fn with_displacement(&self, displacement_m: Vec<f64>) -> Self {
        Self { record: self.record.with_displacement(displacement_m), ..self.clone() }
    }

    /// The first sample under load, at which the force passes this share of its largest: before it,
    /// a joint may pass inside its clearance.
    pub(crate) fn loaded(&self, share: f64) -> usize {
        let force_n = &self.record.force_n;
        let largest = force_n.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
        force_n.iter().position(|force| force.abs() > share * largest).unwrap_or(0)
    }

    /// Counts a simulation over so many samples.
    pub fn simulated(&self, samples: usize) {
        self.steps_made.fetch_add((samples * self.substeps) as u64, Ordering::Relaxed);
    }

    /// Step of the model, s.
    pub fn model_step_s(&self) -> f64 {
        self.record.step_s / self.substeps as f64
    }

    /// Sum of squared errors of a simulated force over a stretch, N2.
    pub fn squares_n2(&self, force_n: &[f64], samples: Range<usize>) -> f64 {
        debug_assert_eq!(force_n.len(), self.record.len(), "one force per sample");
        let pairs = self.record.force_n[samples.clone()].iter().zip(&force_n[samples]);
        pairs.map(|(y, f)| (y - f) * (y - f)).sum()
    }

    /// rms error of a simulated force, N, the run-in left out.
    pub fn rmse_n(&self, force_n: &[f64]) -> f64 {
        let counted = self.counted();
        (self.squares_n2(force_n, counted.clone()) / counted.len().max(1) as f64).sqrt()
    }

    /// All samples but the run-in.
    pub fn counted(&self) -> Range<usize> {
        self.record.run_in..self.record.force_n.len()
    }

    /// About `count` runs of whole blocks, a block or a twentieth left out between neighbours.
    fn runs_of_blocks(&self, count: usize) -> Vec<Range<usize>> {
        let per_run = self.blocks.len().div_ceil(count).max(1);
        let runs: Vec<&[Range<usize>]> = self.blocks.chunks(per_run).collect();
        let last = runs.len().saturating_sub(1);
        let mut ranges = Vec::new();
        for (index, run) in runs.iter().enumerate() {
            let (Some(first), Some(end)) = (run.first(), run.last()) else { continue };
            let length = end.end - first.start;
            let guard = if index == last { 0 } else { length / 20 };
            ranges.push(first.start..end.end - guard);
        }
        ranges
    }
}

/// Equal steps of at most `longest_s` in a sampling period.
fn substeps(period_s: f64, longest_s: f64) -> usize {
    (period_s / longest_s - 1e-6).ceil().max(1.0) as usize
}

fn blocks_of(record: &Measurement) -> Vec<Range<usize>> {
    let counted = record.run_in..record.force_n.len();
    let shortest = (SHORTEST_BLOCK_S / record.step_s).ceil() as usize;
    let mut blocks = Vec::new();
    let mut start = counted.start;
    let cycles = record.cycles.iter().copied().filter(|&at| at > counted.start);
    // Where cycles fill less than half of the record, between rests or in a tapered test, they
    // cannot cut it.
    let covered = record.cycles.last().zip(record.cycles.first()).map_or(0, |(end, at)| end - at);
    if record.cycles.len() < 3 || 2 * covered < record.len() {
        let length = (2 * shortest).min(counted.len() / 4).max(1);
        while start + length <= counted.end {
            blocks.push(start..start + length);
            start += length;
        }
    } else {
        for at in cycles {
            if at - start >= shortest {
                blocks.push(start..at);
                start = at;
            }
        }
    }
    match blocks.last_mut() {
        // The rest joins the last block, so that every counted sample is in one.
        Some(last) => last.end = counted.end,
        None => blocks.push(counted),
    }
    blocks
}

/// Large force, velocity and displacement of records, the 98th percentiles of all samples, and the
/// farthest positions.
fn scale_of(records: &[Measurement]) -> Scale {
    let large = |pick: &dyn Fn(&Measurement) -> Vec<f64>| {
        let mut values: Vec<f64> = records.iter().flat_map(pick).map(f64::abs).collect();
        values.sort_unstable_by(f64::total_cmp);
        let index = (0.98 * values.len() as f64) as usize;
        values.get(index).copied().unwrap_or(0.0).max(1e-12)
    };
    let displacement_m = large(&|record| {
        let n = record.displacement_m.len().max(1) as f64;
        let mean = record.displacement_m.iter().sum::<f64>() / n;
        record.displacement_m.iter().map(|x| x - mean).collect()
    });
    let positions = || records.iter().flat_map(|record| &record.displacement_m);
    let reach_m = |farthest_m: f64| if farthest_m > 0.0 { farthest_m } else { displacement_m };
    Scale {
        force_n: large(&|record| record.force_n.clone()),
        velocity_m_per_s: large(&|record| record.velocity_m_per_s.clone()),
        displacement_m,
        extension_m: reach_m(positions().fold(0.0, |reach, &x| reach.max(x))),
        compression_m: reach_m(positions().fold(0.0, |reach, &x| reach.max(-x))),
    }
}
