//! The start of every fit: mass, stiffness and damping of the linear body, without a simulation.
//!
//! The equation of motion is multiplied by smooth functions of finite length and integrated, which
//! moves the derivatives from the record to the functions:
//!
//! ```text
//! m y'' + c y' + k y = u     ->     m <f'', y> - c <f', y> + k <f, y> = <f, u>
//! ```
//!
//! The functions are tones under a window. The equations are weighted by the response of the last
//! solution, so that the noise of the motion counts as it does in a simulation.

use super::record::Record;
use measurement::body_record::Output;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

/// Tones per block.
const TONES: usize = 48;
/// Most blocks of a record.
const MOST_BLOCKS: usize = 24;
/// Rounds of weighting.
const ROUNDS: usize = 6;

/// Mass, stiffness and damping of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Linear {
    pub(super) mass_kg: f64,
    pub(super) k0_n_per_m: f64,
    pub(super) c0_n_s_per_m: f64,
}

/// One equation: factors of mass, stiffness and damping, the right side, and its frequency.
struct Row {
    factors: [f64; 3],
    right: f64,
    omega: f64,
}

/// The linear body that fits the records best, roughly.
pub(super) fn start(records: &[Record]) -> Linear {
    let rows: Vec<Row> = records.iter().flat_map(rows_of).collect();
    let mut found = usual(records);
    for round in 0..ROUNDS {
        let weight = |row: &Row| {
            if round == 0 {
                return 1.0;
            }
            let Linear { mass_kg, k0_n_per_m, c0_n_s_per_m } = found;
            let real = k0_n_per_m - mass_kg * row.omega * row.omega;
            1.0 / libm::hypot(real, c0_n_s_per_m * row.omega)
        };
        // The usual size of each column, so that the normal equations are well scaled.
        let size = |column: usize| {
            let squares = rows.iter().map(|row| row.factors[column] * weight(row));
            squares.map(|value| value * value).sum::<f64>().sqrt().max(f64::MIN_POSITIVE)
        };
        let sizes = [size(0), size(1), size(2)];
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for row in &rows {
            let weight = weight(row);
            let scaled = Vector3::from_fn(|n, _| row.factors[n] * weight / sizes[n]);
            normal += scaled * scaled.transpose();
            right += scaled * (row.right * weight);
        }
        let Some(solution) = normal.lu().solve(&right) else { break };
        let [m, k, c] = [0, 1, 2].map(|n| solution[n] / sizes[n]);
        if !(m.is_finite() && k.is_finite() && c.is_finite()) || m <= 0.0 {
            break;
        }
        found = Linear { mass_kg: m, k0_n_per_m: k, c0_n_s_per_m: c };
    }
    let least = 1e-3 * libm::sqrt(found.mass_kg * found.k0_n_per_m.abs());
    Linear { c0_n_s_per_m: found.c0_n_s_per_m.max(least), ..found }
}

/// A body of the right order of size, where the equations have no solution.
fn usual(records: &[Record]) -> Linear {
    let Some(record) = records.first() else {
        return Linear { mass_kg: 1.0, k0_n_per_m: 1.0, c0_n_s_per_m: 1.0 };
    };
    let force_n = super::periods::rms(record.force_n.iter().copied());
    let motion = super::periods::rms(record.motion.iter().copied());
    let omega = PI / (20.0 * record.step_s);
    let stiffness = match record.output {
        Output::Displacement => force_n / motion,
        Output::Acceleration => omega * omega * force_n / motion,
    };
    let mass_kg = stiffness / (omega * omega);
    Linear { mass_kg, k0_n_per_m: stiffness, c0_n_s_per_m: 0.1 * stiffness / omega }
}

fn rows_of(record: &Record) -> Vec<Row> {
    let count = record.len();
    let block = (count / 6).clamp(48.min(count), 4096);
    // Half a block, or more where a record has many.
    let step = (block / 2).max(count / MOST_BLOCKS).max(1);
    let highest = block as f64 / 8.0;
    let tones: Vec<f64> = (0..TONES)
        .map(|n| 2.0 * libm::pow(highest / 2.0, n as f64 / (TONES - 1) as f64))
        .chain([0.0])
        .collect();
    let length_s = block as f64 * record.step_s;
    let mut rows = Vec::new();
    for begin in (0..=count - block).step_by(step) {
        let motion = &record.motion[begin..begin + block];
        let force_n = &record.force_n[begin..begin + block];
        for tone in &tones {
            let omega = 2.0 * PI * tone / length_s;
            for phase in [0.0, 0.5 * PI] {
                let mut sums = [0.0; 4];
                for (n, (motion, force_n)) in motion.iter().zip(force_n).enumerate() {
                    let f = function(n as f64 / block as f64, length_s, omega, phase);
                    let (along, force) = match record.output {
                        // <f'', y>, <f, y>, -<f', y>, <f, u>
                        Output::Displacement => ([f[2], f[0], -f[1]], f[0]),
                        // f'' in place of f, moved back on y'': <f'', y''>, <f, y''>, -<f', y''>.
                        Output::Acceleration => ([f[2], f[0], -f[1]], f[2]),
                    };
                    for (sum, factor) in sums.iter_mut().zip(along) {
                        *sum += factor * motion;
                    }
                    sums[3] += force * force_n;
                }
                let [mass, stiffness, damping, right] = sums;
                rows.push(Row { factors: [mass, stiffness, damping], right, omega });
            }
        }
    }
    rows
}

/// `sin^4(pi s) cos(w t - phase)` and its two derivatives by time, at `s = t / length`.
fn function(s: f64, length_s: f64, omega: f64, phase: f64) -> [f64; 3] {
    let (sin, cos) = libm::sincos(PI * s);
    let rate = PI / length_s;
    let squared = sin * sin;
    let window = squared * squared;
    let first = 4.0 * squared * sin * cos * rate;
    let second = rate * rate * (12.0 * squared * cos * cos - 4.0 * window);
    let (tone_sin, tone_cos) = libm::sincos(omega * s * length_s - phase);
    [
        window * tone_cos,
        first * tone_cos - window * omega * tone_sin,
        second * tone_cos - 2.0 * first * omega * tone_sin - window * omega * omega * tone_cos,
    ]
}
