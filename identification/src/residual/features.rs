//! What a force may do with a motion, without any physics: 45 signals made from the past of the
//! displacement alone.
//!
//! With x, v and a over the largest of all tests, and one row for each group:
//!
//! | signals | number |
//! | --- | --- |
//! | x, x^2, x^3, v, v abs(v), a, abs(v) | 7 |
//! | tanh(v/k) for k from 0.01 to 1 | 5 |
//! | first-order lags of tanh(v/0.03), tanh(v/0.3) and v | 12 |
//! | play operators of nine radii: position lost in a play, over its radius | 9 |
//! | three of them times abs(v)/(1 + abs(v)), times x, and squared | 9 |
//! | tanh(v/0.1) times x, x^2, abs(x) | 3 |
//!
//! A play operator of radius r is dry friction of displacement: q follows x at a distance of at
//! most r, and (x - q)/r is the force of an elastic joint that slips at one.

use crate::test_set::{Test, TestSet};
use signal::statistics::percentile;

/// Number of signals.
pub(super) const COUNT: usize = 45;

const SHARP: [f64; 5] = [0.01, 0.03, 0.1, 0.3, 1.0];
/// Time constants, in displacement over velocity.
const LAGS: [f64; 4] = [0.02, 0.06, 0.2, 0.6];
const RADII: [f64; 9] = [0.002, 0.005, 0.01, 0.02, 0.04, 0.08, 0.15, 0.3, 0.5];
/// Play operators that also enter with other signals.
const COUPLED: [usize; 3] = [2, 4, 6];

/// Sizes that make the motion of all tests about one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sizes {
    middle_m: f64,
    displacement_m: f64,
    velocity_m_per_s: f64,
    acceleration_m_per_s2: f64,
}

impl Sizes {
    /// Of the counted samples of all tests.
    pub(super) fn of(tests: &TestSet) -> Self {
        let all = |of: fn(&Test) -> &[f64]| -> Vec<f64> {
            tests.tests.iter().flat_map(|test| &of(test)[test.counted()]).copied().collect()
        };
        let large = |values: &[f64], share: f64| {
            let sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
            percentile(&sizes, share).unwrap_or(0.0).max(f64::MIN_POSITIVE)
        };
        let x = all(|test| &test.record.drive_m);
        let middle_m = signal::statistics::mean(&x);
        let about: Vec<f64> = x.iter().map(|x| x - middle_m).collect();
        Self {
            middle_m,
            displacement_m: large(&about, 0.98),
            velocity_m_per_s: large(&all(|test| &test.record.velocity_m_per_s), 0.95),
            acceleration_m_per_s2: large(&all(|test| &test.record.acceleration_m_per_s2), 0.95),
        }
    }
}

/// The signals at every `stride`-th sample of a test, sample by sample.
pub(super) fn features(test: &Test, sizes: &Sizes, stride: usize) -> Vec<[f64; COUNT]> {
    let record = &test.record;
    let lag_s = sizes.displacement_m / sizes.velocity_m_per_s;
    let memory = LAGS.map(|lag| libm::exp(-record.step_s / (lag * lag_s)));
    let scaled_x = |i: usize| (record.drive_m[i] - sizes.middle_m) / sizes.displacement_m;
    let mut play = [scaled_x(0); RADII.len()];
    let mut lagged = [[0.0; LAGS.len()]; 3];
    let mut rows = Vec::with_capacity(record.len() / stride + 1);
    for i in 0..record.len() {
        let x = scaled_x(i);
        let v = record.velocity_m_per_s[i] / sizes.velocity_m_per_s;
        let a = record.acceleration_m_per_s2[i] / sizes.acceleration_m_per_s2;
        for (q, radius) in play.iter_mut().zip(RADII) {
            *q = q.clamp(x - radius, x + radius);
        }
        let inputs = [libm::tanh(v / 0.03), libm::tanh(v / 0.3), v];
        for (states, input) in lagged.iter_mut().zip(inputs) {
            for (state, memory) in states.iter_mut().zip(memory) {
                *state = memory * *state + (1.0 - memory) * input;
            }
        }
        if i % stride == 0 {
            rows.push(row([x, v, a], &lagged, &play));
        }
    }
    rows
}

fn row([x, v, a]: [f64; 3], lagged: &[[f64; 4]; 3], play: &[f64; RADII.len()]) -> [f64; COUNT] {
    let speed = v.abs();
    let joint = |k: usize| (x - play[k]) / RADII[k];
    let sharp = libm::tanh(v / 0.1);
    let signals = [x, x * x, x * x * x, v, v * speed, a, speed]
        .into_iter()
        .chain(SHARP.map(|k| libm::tanh(v / k)))
        .chain(lagged.iter().flatten().copied())
        .chain((0..RADII.len()).map(joint))
        .chain(COUPLED.map(|k| joint(k) * speed / (1.0 + speed)))
        .chain(COUPLED.map(|k| joint(k) * x))
        .chain(COUPLED.map(|k| joint(k) * joint(k)))
        .chain([sharp * x, sharp * x * x, sharp * x.abs()]);
    let mut row = [0.0; COUNT];
    let mut filled = 0;
    for (place, signal) in row.iter_mut().zip(signals) {
        *place = signal;
        filled += 1;
    }
    debug_assert_eq!(filled, COUNT);
    row
}
