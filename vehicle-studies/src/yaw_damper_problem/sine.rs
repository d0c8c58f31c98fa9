//! Sines on an emulated rig, and the least squares that make an inverse of what they found.

use nalgebra::{Complex, DMatrix, DVector};
use rig_emulator::{Emulator, Reading, Reference, Target};
use scenario::run::CYCLE_S;
use std::f64::consts::TAU;

/// Cycles of 1 ms that are let pass, and that are measured.
const CYCLES: [u32; 2] = [2000, 2000];

/// A sine that a rig is driven with, in displacement and velocity.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sine {
    pub(super) frequency_hz: f64,
    /// Half the travel (m).
    pub(super) stroke_m: f64,
}

/// A reading of a rig, and the sine when it was taken.
pub(super) struct Measured {
    pub(super) reading: Reading,
    /// The reading before it; none before the first.
    pub(super) last: Option<Reading>,
    angle: f64,
    angle_per_cycle: f64,
}

impl Sine {
    /// Drives a rig and gives each reading of whole periods to `see`, once the ram has settled.
    pub(super) fn drive(self, emulator: &Emulator, mut see: impl FnMut(&Measured)) {
        let Self { frequency_hz, stroke_m } = self;
        let omega = TAU * frequency_hz;
        let mut state = emulator.start();
        let mut last = None;
        for cycle in 0..CYCLES[0] + CYCLES[1] {
            let angle = omega * CYCLE_S * f64::from(cycle);
            // A ram at rest takes up the motion within the first half second.
            let share = (f64::from(cycle) / 500.0).min(1.0);
            let command = Reference {
                displacement_m: share * stroke_m * libm::sin(angle),
                velocity_m_per_s: share * stroke_m * omega * libm::cos(angle),
            };
            let reading = emulator.cycle(&mut state, Target::Follow(command));
            if cycle >= CYCLES[0] {
                see(&Measured { reading, last, angle, angle_per_cycle: omega * CYCLE_S });
            }
            last = Some(reading);
        }
    }

    /// A sum of readings times [`Measured::unit`] as an amplitude over that of the command.
    pub(super) fn over_command(self, sum: Complex<f64>) -> Complex<f64> {
        sum * (2.0 / (f64::from(CYCLES[1]) * self.stroke_m))
    }
}

impl Measured {
    /// What takes the fundamental out of a reading so many cycles after the command.
    pub(super) fn unit(&self, cycles: f64) -> Complex<f64> {
        let (sin, cos) = libm::sincos(self.angle + self.angle_per_cycle * cycles);
        Complex::new(sin, cos)
    }
}

/// The real factors whose sum of columns is nearest to one in every line; none without an answer.
pub(super) fn nearest_to_one(lines: &[Vec<Complex<f64>>]) -> Option<Vec<f64>> {
    let columns = lines.first()?.len();
    debug_assert!(lines.iter().all(|line| line.len() == columns), "lines of {columns} columns");
    let entry = |row: usize, column: usize| {
        let value = lines[row / 2][column];
        if row.is_multiple_of(2) { value.re } else { value.im }
    };
    let rows = 2 * lines.len();
    let matrix = DMatrix::from_fn(rows, columns, entry);
    let one = DVector::from_fn(rows, |row, _| f64::from(u8::from(row.is_multiple_of(2))));
    let found = matrix.svd(true, true).solve(&one, 1e-12).ok()?;
    Some(found.iter().copied().collect())
}
