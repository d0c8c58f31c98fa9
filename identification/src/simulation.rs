//! Free-run simulation of a test: measured displacement (without its noise,
//! [`measurement::smoothing`]) in, force out, never a measured force.
//!
//! The position of the dashpot at the first sample is not in the record: a joint rests anywhere in
//! its clearance. It is one number per test, and the only one that a held-out test gives to a
//! model: the deflection of the attachment for which the model follows the measured force best over
//! the run-in and twice as long again, and at least until one run-in after the first load: before
//! it, the joint may pass inside its clearance and show nothing.

use super::test_set::Test;
use firmware_core::damper::{Damper, DamperState, Motion};
use std::ops::ControlFlow;

/// Length of the stretch from which the start is found, in run-ins.
const WINDOW: usize = 3;
/// Force that counts as load, as a share of the largest of the record.
const LOADED: f64 = 0.1;
/// Half clearance that counts as none, as a share of the deflection under the largest force.
const NO_CLEARANCE: f64 = 1e-3;
/// Points of the first, coarse search for the start of the dashpot.
const COARSE: i32 = 4;
/// Halvings of its step afterwards.
const HALVINGS: usize = 8;

/// Force of a damper through a whole test, N, from a deflection of its attachment at the start, m.
pub fn simulate(damper: &Damper, test: &Test, deflection_m: f64) -> Vec<f64> {
    let mut force_n = vec![0.0; test.record.force_n.len()];
    simulate_into(damper, test, deflection_m, &mut force_n);
    force_n
}

/// Fills `force_n` with the force at the first samples of a test.
fn simulate_into(damper: &Damper, test: &Test, deflection_m: f64, force_n: &mut [f64]) {
    let samples = force_n.len();
    let mut forces = force_n.iter_mut();
    walk(damper, test, deflection_m, samples, |force, _| {
        if let Some(slot) = forces.next() {
            *slot = force;
        }
        ControlFlow::Continue(())
    });
}

/// Walks a damper through the first samples of a test; `at_sample` sees the force and the state at
/// each of them, and may end the walk.
pub(crate) fn walk(
    damper: &Damper,
    test: &Test,
    deflection_m: f64,
    samples: usize,
    mut at_sample: impl FnMut(f64, &DamperState) -> ControlFlow<()>,
) {
    debug_assert!(samples <= test.record.len(), "a simulation ends with its record");
    let record = &test.record;
    let step_s = test.model_step_s();
    let damper = damper.clone().prepared(step_s);
    let motion = |i: usize| Motion::new(record.drive_m[i], record.velocity_m_per_s[i]);
    let mut state =
        DamperState::starting(motion(0)).with_piston_m(record.drive_m[0] - deflection_m);
    let mut walked = 0;
    for i in 0..samples.min(record.force_n.len()) {
        if let Some(degc) = &record.temperature_degc {
            state.set_temperature_degc(Some(degc[i]));
        }
        // At the first sample only the force is needed.
        let force_n = if i == 0 {
            damper.advance(&mut state, motion(0), 1e-9)
        } else {
            for k in 1..test.substeps {
                let (x, v) = record.motion_between(i - 1, k as f64 / test.substeps as f64);
                damper.advance(&mut state, Motion::new(x, v), step_s);
            }
            damper.advance(&mut state, motion(i), step_s)
        };
        walked += 1;
        if at_sample(force_n, &state).is_break() {
            break;
        }
    }
    test.simulated(walked);
}

/// The start of the dashpot that fits the run-in best: deflection of the attachment, m.
pub fn start_deflection_m(damper: &Damper, test: &Test) -> f64 {
    match Start::of(damper, test) {
        Start::Known(deflection_m) => deflection_m,
        Start::Open(mut search) => {
            let step_m = search.reach_m / f64::from(COARSE);
            search.try_at(0.0);
            for k in 1..=COARSE {
                for side in [-1.0, 1.0] {
                    search.try_at(side * step_m * f64::from(k));
                }
            }
            search.halve(step_m, HALVINGS)
        }
    }
}

/// The start that fits best near one that was the best for a similar damper, m.
pub(crate) fn start_deflection_near_m(damper: &Damper, test: &Test, known_m: f64) -> f64 {
    match Start::of(damper, test) {
        Start::Known(deflection_m) => deflection_m,
        Start::Open(mut search) => {
            search.try_at(known_m.clamp(-search.reach_m, search.reach_m));
            search.try_at(0.0);
            let step_m = search.reach_m / f64::from(COARSE * COARSE);
            search.halve(step_m, HALVINGS / 2)
        }
    }
}

/// What is known about the start of a dashpot.
enum Start<'a> {
    /// The deflection, m.
    Known(f64),
    /// It has to be searched.
    Open(Search<'a>),
}

/// The best deflection so far.
struct Search<'a> {
    damper: &'a Damper,
    test: &'a Test,
    window: usize,
    reach_m: f64,
    at_m: f64,
    error_n2: f64,
}

impl<'a> Start<'a> {
    fn of(damper: &'a Damper, test: &'a Test) -> Self {
        let record = &test.record;
        let window = (WINDOW * record.run_in).max(test.loaded(LOADED) + record.run_in);
        let window = window.min(record.force_n.len());
        if window < 2 {
            return Self::Known(0.0);
        }
        let nominal = damper.nominal();
        let half_clearance_m = 0.5 * nominal.clearance_2a_m;
        let force_at_start_n = record.force_n[..3.min(window)].iter().sum::<f64>() / 3.0;
        let largest = record.force_n[..window].iter().fold(0.0, |m: f64, f| m.max(f.abs()));
        if half_clearance_m < NO_CLEARANCE * largest / nominal.ke_n_per_m {
            // Without clearance the force at the start determines the position of the dashpot.
            return Self::Known(force_at_start_n / nominal.ke_n_per_m);
        }
        let reach_m = half_clearance_m + 0.5 * largest / nominal.ke_n_per_m;
        let error_n2 = f64::INFINITY;
        Self::Open(Search { damper, test, window, reach_m, at_m: 0.0, error_n2 })
    }
}

impl Search<'_> {
    /// Takes a deflection if its error over the window is smaller.
    fn try_at(&mut self, deflection_m: f64) {
        let mut measured = self.test.record.force_n.iter();
        let mut error_n2 = 0.0;
        walk(self.damper, self.test, deflection_m, self.window, |force_n, _| {
            let error_n = force_n - measured.next().unwrap_or(&force_n);
            error_n2 += error_n * error_n;
            // Not below: a damper without numbers is never the best.
            if error_n2 < self.error_n2 {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        });
        if error_n2 < self.error_n2 {
            (self.at_m, self.error_n2) = (deflection_m, error_n2);
        }
    }

    /// Tries both sides of the best at half the step, so many times.
    fn halve(mut self, mut step_m: f64, times: usize) -> f64 {
        for _ in 0..times {
            step_m *= 0.5;
            for at_m in [self.at_m - step_m, self.at_m + step_m] {
                self.try_at(at_m);
            }
        }
        self.at_m
    }
}
