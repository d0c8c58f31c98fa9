//! What the load takes from a rig: sines of several strokes, with the force.
//!
//! ```text
//! U = (a0 + a1 s + a2 s^2) Y + c F + t P       fundamentals, s = i w
//!                                              P: of |F| y', the speed times the size of the force
//! ```
//! At one stroke the load looks like a slower rig. With a new damper, whose relief valve opens, and
//! with a worn one, which runs free in its clearance, it changes with the stroke; the five numbers
//! then follow by least squares over all lines. For the servo rig of the problem they leave 0.3 to
//! 0.5 % of the command; a series alone leaves 1 to 3 %.

use super::sine::{Sine, nearest_to_one};
use firmware_core::compensation::{Load, Series};
use nalgebra::Complex;
use rig_emulator::Emulator;
use scenario::run::CYCLE_S;
use serde::Serialize;
use std::f64::consts::TAU;

/// Strokes (m, half the travel): those of the motion of a yaw damper.
const STROKES_M: [f64; 4] = [2.0e-3, 4.0e-3, 6.0e-3, 8.0e-3];
/// Frequencies (Hz): whole cycles in the time that is measured.
const FREQUENCIES_HZ: [f64; 6] = [2.0, 2.5, 3.0, 4.0, 5.0, 6.0];
/// Highest speed of a sine (m/s): the servo rig has twice that.
const SPEED_M_PER_S: f64 = 0.2;
/// Scales that make the columns alike: frequency (rad/s) and force per displacement (N/m).
const RATE_PER_S: f64 = TAU * 5.0;
const STIFFNESS_N_PER_M: f64 = 5e6;

/// How a rig answers a sine under load: amplitudes are over that of the command.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Loaded {
    /// The frequency (Hz).
    pub frequency_hz: f64,
    /// Stroke of the command (m).
    pub stroke_m: f64,
    /// Displacement.
    pub gain: f64,
    /// Its phase (rad), negative where it is late.
    pub phase_rad: f64,
    /// Force (N/m).
    pub force_n_per_m: f64,
    /// Its phase (rad).
    pub force_phase_rad: f64,
    /// Speed times the size of the force (N/s).
    pub force_times_speed_n_per_s: f64,
    /// Its phase (rad).
    pub force_times_speed_phase_rad: f64,
}

impl Loaded {
    fn of(emulator: &Emulator, frequency_hz: f64, stroke_m: f64) -> Self {
        let sine = Sine { frequency_hz, stroke_m };
        let mut sums = [Complex::new(0.0, 0.0); 3];
        sine.drive(emulator, |at| {
            let (now, last) = (at.reading, at.last.unwrap_or(at.reading));
            let speed_m_per_s = (now.displacement_m - last.displacement_m) / CYCLE_S;
            // Measured at the end of the cycle; the speed is that of its middle.
            sums[0] += now.displacement_m * at.unit(1.0);
            sums[1] += now.force_n * at.unit(1.0);
            sums[2] += now.force_n.abs() * speed_m_per_s * at.unit(0.5);
        });
        let [motion, force, product] = sums.map(|sum| sine.over_command(sum));
        Self {
            frequency_hz,
            stroke_m,
            gain: motion.norm(),
            phase_rad: motion.arg(),
            force_n_per_m: force.norm(),
            force_phase_rad: force.arg(),
            force_times_speed_n_per_s: product.norm(),
            force_times_speed_phase_rad: product.arg(),
        }
    }

    /// The five columns of the equation, each of the size of one.
    fn columns(&self) -> [Complex<f64>; 5] {
        let motion = Complex::from_polar(self.gain, self.phase_rad);
        let force = Complex::from_polar(self.force_n_per_m, self.force_phase_rad);
        let product =
            Complex::from_polar(self.force_times_speed_n_per_s, self.force_times_speed_phase_rad);
        let rate = Complex::new(0.0, TAU * self.frequency_hz / RATE_PER_S);
        [
            motion,
            motion * rate,
            motion * rate * rate,
            force / STIFFNESS_N_PER_M,
            product / (STIFFNESS_N_PER_M * RATE_PER_S),
        ]
    }
}

/// The lines of a rig.
pub(super) fn table(emulator: &Emulator) -> Vec<Loaded> {
    let mut lines = Vec::new();
    for stroke_m in STROKES_M {
        let slow = |hz: &&f64| TAU * **hz * stroke_m <= SPEED_M_PER_S;
        lines.extend(
            FREQUENCIES_HZ.iter().filter(slow).map(|hz| Loaded::of(emulator, *hz, stroke_m)),
        );
    }
    lines
}

/// Series and load that make the command of what was measured, by least squares.
pub(super) fn inverse(lines: &[Loaded]) -> (Series, Load) {
    let columns: Vec<_> = lines.iter().map(|line| line.columns().to_vec()).collect();
    let found = nearest_to_one(&columns).unwrap_or_else(|| vec![1.0, 0.0, 0.0, 0.0, 0.0]);
    let series =
        Series([found[0], found[1] / RATE_PER_S, found[2] / (RATE_PER_S * RATE_PER_S), 0.0]);
    let load = Load {
        m_per_n: found[3] / STIFFNESS_N_PER_M,
        s_per_n: found[4] / (STIFFNESS_N_PER_M * RATE_PER_S),
    };
    (series, load)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_that_made_the_lines_are_found() {
        let (a, load) = ([1.01, 4e-3, 2e-5], Load { m_per_n: 1.1e-8, s_per_n: 8e-8 });
        let mut lines = Vec::new();
        for (number, frequency_hz) in [2.0, 3.0, 4.0, 5.0, 6.0].into_iter().enumerate() {
            let s = Complex::new(0.0, TAU * frequency_hz);
            for stiffness in [2e6, 5e6] {
                // A spring and a dashpot whose share changes from line to line.
                let force = stiffness * Complex::new(1.0, 0.3 * number as f64);
                let product = 1e4 * s * Complex::new(1.0, 0.1 * stiffness / 1e6);
                let command = a[0] + a[1] * s + a[2] * s * s;
                let command = command + load.m_per_n * force + load.s_per_n * product;
                let [motion, force, product] =
                    [Complex::new(1.0, 0.0), force, product].map(|value| value / command);
                lines.push(Loaded {
                    frequency_hz,
                    stroke_m: 4e-3,
                    gain: motion.norm(),
                    phase_rad: motion.arg(),
                    force_n_per_m: force.norm(),
                    force_phase_rad: force.arg(),
                    force_times_speed_n_per_s: product.norm(),
                    force_times_speed_phase_rad: product.arg(),
                });
            }
        }
        let (series, found) = inverse(&lines);
        for (found, expected) in series.0.into_iter().zip(a) {
            assert!((found / expected - 1.0).abs() < 1e-6, "{series:?}");
        }
        assert!((found.m_per_n / load.m_per_n - 1.0).abs() < 1e-6, "{found:?}");
        assert!((found.s_per_n / load.s_per_n - 1.0).abs() < 1e-6, "{found:?}");
    }
}
