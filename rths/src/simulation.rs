//! One run of the benchmark: the frame without the specimen, coupled with the plant.

use crate::baseline::Baseline;
use crate::structure::{FLOORS, Structure};
use firmware_core::command::Command;
use firmware_core::compensation::{Answer, Compensator, CompensatorState};
use rig_emulator::{BenchmarkPlant, runge_kutta};
use signal::random::Random;
use std::collections::VecDeque;

/// Samples, and steps of integration, per second.
pub(crate) const SAMPLES_PER_S: f64 = 4096.0;
/// The step, s.
pub(crate) const STEP_S: f64 = 1.0 / SAMPLES_PER_S;
/// The part of the recorded acceleration that is used.
pub(crate) const INTENSITY: f64 = 0.4;
/// A force sampled in step `k` acts from `k + 1` to `k + 2`.
const FORCE_DELAY_SAMPLES: usize = 1;
/// Power of the noise of the measured displacement, m2/Hz.
const DISPLACEMENT_NOISE_M2_PER_HZ: f64 = 6.25e-14;
/// Power of the noise of the measured force, N2/Hz.
const FORCE_NOISE_N2_PER_HZ: f64 = 1.16e-3;
/// Where the force saturates, N.
const FORCE_MAX_N: f64 = 8900.0;
/// Step of the converters, V: 18 bits from -3.8 to 3.8 V.
const QUANTUM_V: f64 = 7.6 / 262_144.0;
/// Displacement per volt, m.
const DISPLACEMENT_M_PER_V: f64 = 7.89e-3;
/// Force per volt, N.
const FORCE_N_PER_V: f64 = 1096.0;

/// What follows the simulated frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Controller {
    /// The baseline of the benchmark.
    Baseline,
    /// A compensator of the core.
    Compensator(Compensator),
}

/// What a run is made of.
#[derive(Debug, Clone)]
pub(crate) struct Setup<'a> {
    /// The whole frame.
    pub(crate) whole: Structure,
    pub(crate) plant: BenchmarkPlant,
    /// Acceleration of the ground in half steps, m/s2.
    pub(crate) ground_m_per_s2: &'a [f64],
    /// The source of the noise.
    pub(crate) random: Random,
    /// False leaves the noise of the displacement out.
    pub(crate) has_displacement_noise: bool,
    /// Delay of the command that no controller knows of, samples.
    pub(crate) extra_samples: usize,
    pub(crate) controller: Controller,
}

/// What a run leaves.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trace {
    /// Measured displacement of the specimen, m.
    pub(crate) measured_m: Vec<f64>,
    /// Displacements of the simulated floors, m.
    pub(crate) simulated_m: Vec<[f64; FLOORS]>,
    /// Whether the force was ever limited.
    pub(crate) is_saturated: bool,
    /// Whether an adaptive compensator fell back.
    pub(crate) has_run_away: bool,
}

/// The motion of the whole frame, m: what a perfect run would show.
pub(crate) fn reference_m(whole: &Structure, ground_m_per_s2: &[f64]) -> Vec<[f64; FLOORS]> {
    let mut motion = [0.0; 2 * FLOORS];
    let mut floors = Vec::with_capacity(ground_m_per_s2.len() / 2);
    for ground in steps(ground_m_per_s2) {
        floors.push(first_floors(&motion));
        motion = runge_kutta(&motion, STEP_S, |y, h| whole.slope(y, at(ground, h), 0.0));
    }
    floors
}

/// Runs a setup.
pub(crate) fn run(mut setup: Setup<'_>) -> Trace {
    let simulated = setup.whole.without(&setup.plant.specimen);
    let (mut motion, mut rig) = ([0.0; 2 * FLOORS], [0.0; 5]);
    let mut forces_n = VecDeque::from(vec![0.0; FORCE_DELAY_SAMPLES]);
    let mut commands_m = VecDeque::from(vec![0.0; setup.extra_samples]);
    let mut controller = Running::new(setup.controller);
    let count = setup.ground_m_per_s2.len() / 2;
    let mut trace = Trace {
        measured_m: Vec::with_capacity(count),
        simulated_m: Vec::with_capacity(count),
        is_saturated: false,
        has_run_away: false,
    };
    let noise_m = (DISPLACEMENT_NOISE_M2_PER_HZ * SAMPLES_PER_S).sqrt();
    let noise_m = if setup.has_displacement_noise { noise_m } else { 0.0 };
    let noise_n = (FORCE_NOISE_N2_PER_HZ * SAMPLES_PER_S).sqrt();
    for ground in steps(setup.ground_m_per_s2) {
        let [displacement_m, _, force_n, ..] = rig.map(|value| setup.plant.output_gain * value);
        let displacement_m = displacement_m + noise_m * setup.random.gaussian();
        let force_n = force_n + noise_n * setup.random.gaussian();
        trace.is_saturated |= force_n.abs() > FORCE_MAX_N;
        let measured_m = converted(displacement_m, DISPLACEMENT_M_PER_V);
        forces_n.push_back(converted(force_n.clamp(-FORCE_MAX_N, FORCE_MAX_N), FORCE_N_PER_V));
        let acting_n = forces_n.pop_front().unwrap_or_default();
        let [wanted_m, .., wanted_m_per_s, _, _] = motion;
        let wanted = Command { displacement_m: wanted_m, velocity_m_per_s: wanted_m_per_s };
        commands_m.push_back(controller.command_m(wanted, measured_m, acting_n));
        let command_m = commands_m.pop_front().unwrap_or_default();
        trace.measured_m.push(measured_m);
        trace.simulated_m.push(first_floors(&motion));
        motion = runge_kutta(&motion, STEP_S, |y, h| simulated.slope(y, at(ground, h), acting_n));
        rig = runge_kutta(&rig, STEP_S, |y, _| setup.plant.slope(y, command_m));
    }
    trace.has_run_away = controller.has_run_away();
    trace
}

/// The accelerations at start, middle and end of each step.
fn steps(half_steps: &[f64]) -> impl Iterator<Item = [f64; 3]> {
    half_steps.windows(3).step_by(2).filter_map(|step| step.try_into().ok())
}

/// The acceleration at a time since the start of a step: start, middle or end.
fn at([start, middle, end]: [f64; 3], since_s: f64) -> f64 {
    match since_s / STEP_S {
        share if share < 0.25 => start,
        share if share < 0.75 => middle,
        _ => end,
    }
}

fn first_floors(motion: &[f64; 2 * FLOORS]) -> [f64; FLOORS] {
    let [x0, x1, x2, ..] = *motion;
    [x0, x1, x2]
}

/// A value behind a converter.
fn converted(value: f64, per_v: f64) -> f64 {
    let quantum = QUANTUM_V * per_v;
    quantum * (value / quantum).round()
}

/// A controller with its memory.
enum Running {
    Baseline(Baseline),
    Compensator(Compensator, Box<CompensatorState>),
}

impl Running {
    fn new(controller: Controller) -> Self {
        match controller {
            Controller::Baseline => Self::Baseline(Baseline::new(STEP_S)),
            Controller::Compensator(compensator) => {
                Self::Compensator(compensator, Box::new(compensator.start()))
            }
        }
    }

    fn command_m(&mut self, wanted: Command, measured_m: f64, force_n: f64) -> f64 {
        match self {
            Self::Baseline(baseline) => baseline.command_m(wanted.displacement_m, measured_m),
            Self::Compensator(compensator, state) => {
                let answer = Answer { displacement_m: measured_m, force_n, age_cycles: 0 };
                compensator.step(state, wanted, Some(answer), STEP_S).displacement_m
            }
        }
    }

    fn has_run_away(&self) -> bool {
        match self {
            Self::Baseline(_) => false,
            Self::Compensator(_, state) => state.has_run_away(),
        }
    }
}
