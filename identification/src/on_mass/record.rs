//! A record of a body, ready for a simulation: periods averaged, the force on a finer clock.

use super::body::Body;
use super::inter_sample;
use super::periods::{self, Folded};
use measurement::body_record::{BodyRecord, BodyStart, InterSample, Output};
use std::path::PathBuf;

/// Most periods that are simulated before the one that is compared.
const MOST_WARM_UP: usize = 20;
/// Decay of a free vibration before the compared period, in time constants.
const SETTLED: f64 = 12.0;

/// A record of a body.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Record {
    /// Name of the test.
    pub(crate) name: String,
    /// Its file.
    pub(crate) file: PathBuf,
    /// Time from sample to sample, s.
    pub(crate) step_s: f64,
    /// What is measured.
    pub(crate) output: Output,
    /// Force on the body at every sample, N; the mean of the periods.
    pub(crate) force_n: Vec<f64>,
    /// The measured motion; the mean of the periods.
    pub(crate) motion: Vec<f64>,
    /// The force between samples.
    pub(crate) inter_sample: InterSample,
    /// The motion before the first sample.
    pub(crate) start: BodyStart,
    /// Periods in the mean; 1 for a record that is not periodic.
    pub(crate) periods: usize,
    /// rms deviation of single periods from each other, in the unit of the output.
    pub(crate) noise: Option<f64>,
    /// What the reader should know about this.
    pub(crate) notes: Vec<String>,
    /// Steps of the simulation per sample.
    substeps: usize,
    /// Mean force in every step, N.
    push_n: Vec<f64>,
    /// Periods simulated before the compared one.
    pub(crate) warm_up: usize,
}

impl Record {
    /// A record with its periods averaged.
    pub(crate) fn new(given: BodyRecord) -> Self {
        let BodyRecord { name, file, step_s, force_n, output, motion, drive, repairs } = given;
        let mut notes: Vec<String> =
            repairs.into_iter().map(|line| format!("{name}: {line}")).collect();
        let found = if drive.start.is_none() { periods::period_of(&force_n) } else { None };
        let period = drive.period_samples.or(found);
        if drive.period_samples.is_none()
            && let Some(period) = period
        {
            notes.push(format!("{name}: the force repeats itself every {period} samples"));
        }
        let start = drive.start.unwrap_or(BodyStart::Moving);
        let start = if period.is_some() { BodyStart::Periodic } else { start };
        let mut record = Self {
            name,
            file,
            step_s,
            output,
            force_n,
            motion,
            inter_sample: drive.inter_sample,
            start,
            periods: 1,
            noise: None,
            notes,
            substeps: 0,
            push_n: Vec::new(),
            warm_up: 1,
        };
        if let Some(period) = period {
            record.fold(period);
        }
        record.set_substeps(1);
        record
    }

    fn fold(&mut self, period: usize) {
        let Folded { force_n, motion, periods, noise, transient } =
            periods::fold(&self.force_n, &self.motion, period);
        let skipped = self.motion.len() % period;
        if skipped > 0 {
            self.notes.push(format!(
                "{}: the first {skipped} samples are left out: no whole period",
                self.name
            ));
        }
        if transient {
            self.notes.push(format!(
                "{}: the first period is left out: it has not settled yet",
                self.name
            ));
        }
        self.force_n = force_n;
        self.motion = motion;
        self.periods = periods;
        self.noise = noise;
    }

    /// rms noise of the averaged record.
    pub(crate) fn noise_of_mean(&self) -> Option<f64> {
        self.noise.map(|noise| noise / libm::sqrt(self.periods as f64))
    }

    /// Number of samples that are compared.
    pub(crate) fn len(&self) -> usize {
        self.motion.len()
    }

    /// True where displacement and velocity at the first sample are fitted.
    pub(crate) fn moves_at_start(&self) -> bool {
        self.start == BodyStart::Moving
    }

    /// Length of a step of the simulation, s.
    pub(crate) fn simulation_step_s(&self) -> f64 {
        self.step_s / self.substeps as f64
    }

    /// Steps of the simulation per sample.
    pub(crate) fn substeps(&self) -> usize {
        self.substeps
    }

    /// Chooses the number of steps per sample.
    pub(crate) fn set_substeps(&mut self, substeps: usize) {
        debug_assert!(substeps > 0, "no step per sample");
        if self.substeps == substeps {
            return;
        }
        self.substeps = substeps;
        let whole = self.start == BodyStart::Periodic;
        let intervals = if whole { self.force_n.len() } else { self.force_n.len() - 1 };
        self.push_n = match self.inter_sample {
            InterSample::Hold => {
                let held = self.force_n.iter().take(intervals);
                held.flat_map(|force| std::iter::repeat_n(*force, substeps)).collect()
            }
            InterSample::BandLimited => {
                let fine = if whole {
                    let mut fine = inter_sample::periodic(&self.force_n, substeps);
                    fine.extend(fine.first().copied());
                    fine
                } else {
                    inter_sample::band_limited(&self.force_n, substeps)
                };
                fine.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect()
            }
        };
        debug_assert_eq!(self.push_n.len(), intervals * substeps, "a force for every step");
    }

    /// Chooses how many periods run before the compared one, from the decay of the linear model.
    pub(crate) fn set_warm_up(&mut self, decay_per_s: f64) {
        let period_s = self.step_s * self.force_n.len() as f64;
        let wanted = libm::ceil(SETTLED / (decay_per_s * period_s));
        self.warm_up = if wanted >= 1.0 { (wanted as usize).min(MOST_WARM_UP) } else { 1 };
    }

    /// The first samples of a record that is not periodic.
    pub(super) fn head(&self, samples: usize) -> Self {
        debug_assert!(self.start != BodyStart::Periodic, "a period has no head");
        let mut head = self.clone();
        head.motion.truncate(samples);
        head.force_n.truncate(samples);
        head.push_n.truncate((samples - 1) * self.substeps);
        head
    }

    /// The motion of a body through this record, from a displacement and a velocity; none where it
    /// runs away.
    pub(super) fn simulate(&self, body: &Body, [y, v]: [f64; 2]) -> Option<Vec<f64>> {
        let count = self.motion.len();
        let mut state = body.starting(y, v);
        let mut motion = Vec::with_capacity(count);
        let passes = if self.start == BodyStart::Periodic { self.warm_up + 1 } else { 1 };
        for pass in 1..=passes {
            let mut steps = self.push_n.chunks_exact(self.substeps);
            for sample in 0..count {
                if pass == passes {
                    motion.push(match self.output {
                        Output::Displacement => state.y,
                        Output::Acceleration => {
                            (self.force_n[sample] - state.reaction_n) / body.mass_kg
                        }
                    });
                }
                for push_n in steps.next().unwrap_or(&[]) {
                    if !body.step(&mut state, *push_n) {
                        return None;
                    }
                }
            }
        }
        Some(motion)
    }
}
