//! The data sheet of a rig: how it answers a sine, with the damper mounted.
//!
//! ```text
//! H(w) = Y / U      U: command, displacement and velocity of one sine
//!                   Y: measured displacement, both at the same instant
//! ```
//! The nominal rig is driven with one sine after the other, of [`STROKE_M`] or, where that would be
//! faster than [`SPEED_M_PER_S`], of less. The damper loads the rig, so that gain and delay are
//! those of this load: every damper has a sheet of its own, as on a bench where the rig is measured
//! with the specimen that is mounted. Dead time is not in it: a rig with a dead time is late by as
//! much more at every frequency.
//!
//! What the load takes is found from more strokes, since a relief valve and a clearance load the
//! rig at each of them in another way ([`DataSheet::inverse_under_load`]).

use super::loaded::{self, Loaded};
use super::sine::{Sine, nearest_to_one};
use firmware_core::compensation::{Load, Series};
use nalgebra::Complex;
use rig_emulator::Emulator;
use scenario::rig::RigSetup;
use scenario::run::CYCLE_S;
use serde::Serialize;
use std::f64::consts::TAU;

/// Frequencies of the sheet (Hz): whole cycles in the time that is measured.
const FREQUENCIES_HZ: [f64; 14] =
    [0.5, 1.0, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0];
/// Largest stroke of a sine (m, half the travel).
const STROKE_M: f64 = 4.0e-3;
/// Highest speed of a sine (m/s).
const SPEED_M_PER_S: f64 = 0.1;
/// Frequencies that a series is fitted to (Hz): those of the motion of a yaw damper. At lower ones
/// a relief valve loads the rig like dry friction, which no series follows.
const FITTED_HZ: [f64; 2] = [2.0, 6.0];

/// How a rig answers one frequency.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Answered {
    /// The frequency (Hz).
    pub frequency_hz: f64,
    /// Stroke of the command (m).
    pub stroke_m: f64,
    /// Amplitude that is measured over that of the command.
    pub gain: f64,
    /// Phase of what is measured (rad), negative where it is late.
    pub phase_rad: f64,
}

/// How a rig answers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DataSheet {
    /// Over the frequency.
    pub answers: Vec<Answered>,
    /// Over frequency and stroke, with the force.
    pub under_load: Vec<Loaded>,
}

impl Answered {
    fn of(emulator: &Emulator, frequency_hz: f64) -> Self {
        let omega = TAU * frequency_hz;
        let stroke_m = STROKE_M.min(SPEED_M_PER_S / omega);
        let sine = Sine { frequency_hz, stroke_m };
        let mut sum = Complex::new(0.0, 0.0);
        // Measured at the end of the cycle.
        sine.drive(emulator, |at| sum += at.reading.displacement_m * at.unit(1.0));
        let response = sine.over_command(sum);
        Self { frequency_hz, stroke_m, gain: response.norm(), phase_rad: response.arg() }
    }

    /// How late the rig is at this frequency (s).
    pub fn delay_s(&self) -> f64 {
        -self.phase_rad / (TAU * self.frequency_hz)
    }
}

impl DataSheet {
    /// That of a rig without its dead time.
    pub fn of(rig: &RigSetup) -> Self {
        let emulator = Emulator::new(&RigSetup { delay_cycles: 0, ..rig.clone() }, CYCLE_S, 0);
        Self {
            answers: FREQUENCIES_HZ.iter().map(|hz| Answered::of(&emulator, *hz)).collect(),
            under_load: loaded::table(&emulator),
        }
    }

    /// How late the rig is at a frequency between the lowest and the highest of the sheet (s).
    pub fn delay_s(&self, frequency_hz: f64) -> f64 {
        let delays = self.answers.iter().map(|one| (one.frequency_hz, one.delay_s()));
        let pairs = delays.clone().zip(delays.clone().skip(1));
        for ((low_hz, low_s), (high_hz, high_s)) in pairs {
            if (low_hz..=high_hz).contains(&frequency_hz) {
                let share = (frequency_hz - low_hz) / (high_hz - low_hz);
                return low_s + share * (high_s - low_s);
            }
        }
        debug_assert!(false, "{frequency_hz} Hz is not in the sheet");
        0.0
    }

    /// The series of an order up to 3 that is nearest to the inverse of the rig, by least squares
    /// of `H (a0 + a1 s + ...) - 1` from 2 to 6 Hz.
    pub fn inverse(&self, order: usize) -> Series {
        debug_assert!((1..=3).contains(&order), "order {order}");
        let [low_hz, high_hz] = FITTED_HZ;
        let is_fitted = |line: &&Answered| (low_hz..=high_hz).contains(&line.frequency_hz);
        let lines: Vec<&Answered> = self.answers.iter().filter(is_fitted).collect();
        let omega = |line: &Answered| TAU * line.frequency_hz;
        let scale = TAU * high_hz;
        let powers = |line: &&Answered| -> Vec<Complex<f64>> {
            let response = Complex::from_polar(line.gain, line.phase_rad);
            let ratio = Complex::new(0.0, omega(line) / scale);
            (0..=order).map(|power| response * ratio.powu(power as u32)).collect()
        };
        let found = nearest_to_one(&lines.iter().map(powers).collect::<Vec<_>>());
        let mut series = Series::IDENTITY;
        if let Some(found) = found {
            series.0 = std::array::from_fn(|power| {
                found.get(power).map_or(0.0, |value| value / scale.powi(power as i32))
            });
        }
        series
    }

    /// The series of second order and the load that are nearest to the inverse of the rig.
    pub fn inverse_under_load(&self) -> (Series, Load) {
        loaded::inverse(&self.under_load)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scenario::rig::RigFile;

    #[test]
    fn an_ideal_rig_with_a_lag_is_late_by_it() {
        let rig = RigFile::default_setup().unwrap();
        let sheet = DataSheet::of(&RigSetup { lag_s: 4e-3, delay_cycles: 7, ..rig });
        for line in &sheet.answers {
            let omega = TAU * line.frequency_hz;
            // A first-order lag; dead time is left out.
            assert!((line.phase_rad + libm::atan(omega * 4e-3)).abs() < 0.01, "{line:?}");
            assert!((line.gain * libm::hypot(1.0, omega * 4e-3) - 1.0).abs() < 0.01, "{line:?}");
        }
        assert!((sheet.delay_s(3.3) - 4e-3).abs() < 0.05e-3);
        let Series([a0, a1, a2, a3]) = sheet.inverse(3);
        assert!((a0 - 1.0).abs() < 1e-3 && (a1 - 4e-3).abs() < 0.02e-3, "{a0} {a1}");
        assert!(a2.abs() < 1e-5 && a3.abs() < 3e-7, "{a2} {a3}");
    }
}
