//! Disturbances that no effect of the catalogue describes: an identification that meets one has to
//! report that something is present that it cannot name.
//!
//! | kind | equation | what it represents |
//! | --- | --- | --- |
//! | speed-synchronous ripple | F + A sin(2 pi m f t + phi), m no integer | the drive of the bench, at m times the frequency f of the test |
//! | frame resonance | F + G (p - F), p'' + 2 zeta w p' + w^2 p = w^2 F | a mode of the frame between damper and load cell |
//! | worn band | dashpot force times 1 - d b, b a raised cosine over the position of the piston | a worn length of the bore |
//! | valve flutter | F + A g sin(2 pi f t + phi), g rises while the piston's speed is above a threshold | a valve that oscillates; every onset has another phase |
//!
//! Each has one strength. [`Outside::sized`] sets it to a share of the rms force of a reference
//! motion; the same disturbance then acts in every test.

use super::{SeriesModel, Trace};
use crate::excitation::Excitation;
use crate::grid::Grid;
use signal::random::Random;
use signal::statistics::rms;
use std::f64::consts::TAU;

/// Deepest worn band: a twentieth of the damping remains.
const DEPTH_MAX: f64 = 0.95;
/// Time in which flutter rises and decays, s.
const FLUTTER_RISE_S: f64 = 5e-3;

/// A disturbance with its strength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outside {
    /// A ripple at a multiple of the test's frequency.
    SpeedSynchronousRipple {
        /// Amplitude, N.
        amplitude_n: f64,
        /// Multiple of the test's frequency.
        multiple: f64,
    },
    /// A mode of the frame in the reading of the load cell.
    FrameResonance {
        /// Share G of the mode in the reading.
        participation: f64,
        /// Its frequency, Hz.
        frequency_hz: f64,
        /// Its damping ratio.
        damping_ratio: f64,
    },
    /// A length of the bore with less damping.
    WornBand {
        /// Share of the damping that is missing in its middle, 0 to 0.95.
        depth: f64,
        /// Middle of the band, m from mid-stroke.
        at_m: f64,
        /// Its whole length, m.
        width_m: f64,
    },
    /// A force that oscillates while the piston is fast.
    ValveFlutter {
        /// Amplitude, N.
        amplitude_n: f64,
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Speed of the piston above which it oscillates, m/s.
        threshold_m_per_s: f64,
    },
}

/// One motion of a damper: the displacement over time, and what disturbances depend on.
#[derive(Clone, Copy)]
pub struct Drive<'a> {
    /// Displacement over time, m.
    pub displacement_m: &'a dyn Fn(f64) -> f64,
    /// The characteristic frequency of the test, Hz.
    pub frequency_hz: f64,
    /// Where the joint starts, m from the middle of its clearance.
    pub start_m: f64,
    /// Seed of the phases.
    pub seed: u64,
}

impl SeriesModel {
    /// The force over time with disturbances.
    pub fn simulate_with(&self, outside: &[Outside], drive: &Drive<'_>, grid: Grid) -> Trace {
        let scale = |piston_m: f64| outside.iter().map(|one| one.damping_left(piston_m)).product();
        let mut trace = self.simulate_scaled(drive.displacement_m, grid, drive.start_m, &scale);
        let mut random = Random::new(drive.seed, 5);
        for one in outside {
            one.disturb(&mut trace, grid.step_s, drive.frequency_hz, &mut random);
        }
        trace
    }
}

impl Outside {
    /// Its name in results.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::SpeedSynchronousRipple { .. } => "speed_synchronous_ripple",
            Self::FrameResonance { .. } => "frame_resonance",
            Self::WornBand { .. } => "worn_band",
            Self::ValveFlutter { .. } => "valve_flutter",
        }
    }

    /// This disturbance with the strength at which, under the reference motion, it changes the
    /// force by `share` of its rms; and the share that it reaches, which is smaller where a worn
    /// band cannot be that deep or a threshold is never exceeded.
    ///
    /// ```
    /// use virtual_bench::excitation::Excitation;
    /// use virtual_bench::series_model::{SeriesModel, outside::Outside};
    /// # let damper = SeriesModel {
    /// #     ce_n_s_per_m: 1e6, ke_n_per_m: 12.5e6, clearance_2a_m: 1e-3,
    /// #     f_relief_n: 15e3, c2_n_s_per_m: 60e3,
    /// # };
    /// let ripple = Outside::SpeedSynchronousRipple { amplitude_n: 1.0, multiple: 3.37 };
    /// let (ripple, share) = ripple.sized(0.02, &damper, &Excitation::sine(3.46e-3, 3.5));
    /// let Outside::SpeedSynchronousRipple { amplitude_n, .. } = ripple else { panic!() };
    /// // 13.6 kN rms: 2 % of it is an amplitude of 0.39 kN.
    /// assert!((amplitude_n - 385.0).abs() < 5.0 && (share - 0.02).abs() < 1e-6);
    /// ```
    #[must_use]
    pub fn sized(self, share: f64, model: &SeriesModel, reference: &Excitation) -> (Self, f64) {
        // Tones count once they have risen.
        let tones_s = 8.0 / reference.frequency_hz();
        let (length_s, run_in_s) = reference.end_s().map_or((tones_s, 0.5 * tones_s), |s| (s, 0.0));
        let run_in = (run_in_s / 50e-6) as usize;
        let grid = Grid { step_s: 50e-6, steps: (length_s / 50e-6) as usize };
        let x = |t: f64| reference.displacement_m(t);
        let frequency_hz = reference.frequency_hz();
        let drive = Drive { displacement_m: &x, frequency_hz, start_m: 0.0, seed: 1 };
        let without = model.simulate_with(&[], &drive, grid);
        let size = rms(&without.force_n[run_in..]);
        let reached = |strength: f64| {
            let with = model.simulate_with(&[self.with_strength(strength)], &drive, grid);
            let change: Vec<f64> =
                with.force_n.iter().zip(&without.force_n).map(|(a, b)| a - b).collect();
            if size > 0.0 { rms(&change[run_in..]) / size } else { 0.0 }
        };
        if !matches!(self, Self::WornBand { .. }) {
            // The change grows in proportion.
            let per_strength = reached(1.0);
            if per_strength <= 0.0 {
                return (self.with_strength(0.0), 0.0);
            }
            return (self.with_strength(share / per_strength), share);
        }
        let (mut low, mut high) = (0.0, DEPTH_MAX);
        if reached(high) > share {
            for _ in 0..20 {
                let middle = 0.5 * (low + high);
                if reached(middle) < share {
                    low = middle;
                } else {
                    high = middle;
                }
            }
        }
        (self.with_strength(high), reached(high))
    }

    fn with_strength(mut self, strength: f64) -> Self {
        match &mut self {
            Self::SpeedSynchronousRipple { amplitude_n, .. }
            | Self::ValveFlutter { amplitude_n, .. } => *amplitude_n = strength,
            Self::FrameResonance { participation, .. } => *participation = strength,
            Self::WornBand { depth, .. } => *depth = strength,
        }
        self
    }

    /// Factor on the force of the dashpot.
    fn damping_left(&self, piston_m: f64) -> f64 {
        match *self {
            Self::WornBand { depth, at_m, width_m } => {
                let from_middle = (piston_m - at_m) / width_m;
                if from_middle.abs() >= 0.5 {
                    return 1.0;
                }
                1.0 - depth * 0.5 * (1.0 + libm::cos(TAU * from_middle))
            }
            _ => 1.0,
        }
    }

    fn disturb(&self, trace: &mut Trace, step_s: f64, test_hz: f64, random: &mut Random) {
        match *self {
            Self::SpeedSynchronousRipple { amplitude_n, multiple } => {
                let phase = random.phase();
                let omega = TAU * multiple * test_hz;
                for (step, force) in trace.force_n.iter_mut().enumerate() {
                    *force += amplitude_n * libm::sin(omega * step as f64 * step_s + phase);
                }
            }
            Self::FrameResonance { participation, frequency_hz, damping_ratio } => {
                let mode = Mode::new(frequency_hz, damping_ratio, step_s);
                mode.mix_in(&mut trace.force_n, participation);
            }
            Self::WornBand { .. } => {}
            Self::ValveFlutter { amplitude_n, frequency_hz, threshold_m_per_s } => {
                let keep = libm::exp(-step_s / FLUTTER_RISE_S);
                let (mut level, mut sings, mut phase) = (0.0, false, 0.0);
                let speeds = trace.piston_m.windows(2).map(|pair| (pair[1] - pair[0]) / step_s);
                for (step, (force, speed)) in trace.force_n[1..].iter_mut().zip(speeds).enumerate()
                {
                    let fast = speed.abs() > threshold_m_per_s;
                    if fast && !sings && level < 0.05 {
                        phase = random.phase();
                    }
                    sings = fast;
                    level = f64::from(u8::from(fast)) * (1.0 - keep) + keep * level;
                    let angle = TAU * frequency_hz * (step + 1) as f64 * step_s + phase;
                    *force += amplitude_n * level * libm::sin(angle);
                }
            }
        }
    }
}

/// A mode of vibration by the trapezoidal rule.
struct Mode {
    stiffness: f64,
    damping: f64,
    half_step_s: f64,
}

impl Mode {
    fn new(frequency_hz: f64, damping_ratio: f64, step_s: f64) -> Self {
        let omega = TAU * frequency_hz;
        Self {
            stiffness: omega * omega,
            damping: 2.0 * damping_ratio * omega,
            half_step_s: 0.5 * step_s,
        }
    }

    /// F + G (p - F), from rest under the first force.
    fn mix_in(&self, force_n: &mut [f64], participation: f64) {
        let h = self.half_step_s;
        let divisor = 1.0 + h * self.damping + h * h * self.stiffness;
        let (mut p, mut rate) = (force_n.first().copied().unwrap_or(0.0), 0.0);
        let mut before = p;
        for force in force_n {
            let old = self.stiffness * (before - p) - self.damping * rate;
            let new_rate = (rate + h * (old + self.stiffness * (*force - p - h * rate))) / divisor;
            p += h * (rate + new_rate);
            rate = new_rate;
            before = *force;
            *force += participation * (p - *force);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DAMPER: SeriesModel = SeriesModel {
        ce_n_s_per_m: 1e6,
        ke_n_per_m: 12.5e6,
        clearance_2a_m: 1e-3,
        f_relief_n: 15e3,
        c2_n_s_per_m: 60e3,
    };

    fn kinds() -> [Outside; 4] {
        [
            Outside::SpeedSynchronousRipple { amplitude_n: 0.0, multiple: 3.37 },
            Outside::FrameResonance { participation: 0.0, frequency_hz: 40.0, damping_ratio: 0.01 },
            Outside::WornBand { depth: 0.0, at_m: 0.5e-3, width_m: 2e-3 },
            Outside::ValveFlutter { amplitude_n: 0.0, frequency_hz: 90.0, threshold_m_per_s: 0.02 },
        ]
    }

    #[test]
    fn every_kind_has_the_size_that_it_is_given() {
        let reference = Excitation::sine(3.46e-3, 3.5);
        for kind in kinds() {
            let (sized, share) = kind.sized(0.03, &DAMPER, &reference);
            assert!((share - 0.03).abs() < 1e-4, "{sized:?}: {share}");
            // In another test and with another seed it is about as large.
            let x = |t: f64| reference.displacement_m(t);
            let drive = Drive { displacement_m: &x, frequency_hz: 3.5, start_m: 0.0, seed: 7 };
            let grid = Grid { step_s: 20e-6, steps: 100_000 };
            let plain = DAMPER.simulate_with(&[], &drive, grid);
            let with = DAMPER.simulate_with(&[sized], &drive, grid);
            let change: Vec<f64> =
                with.force_n.iter().zip(&plain.force_n).map(|(a, b)| a - b).collect();
            let found = rms(&change) / rms(&plain.force_n);
            assert!((0.02..0.04).contains(&found), "{sized:?}: {found}");
            assert!(DAMPER.simulate_with(&[sized], &drive, grid) == with, "the seed repeats it");
        }
    }

    #[test]
    fn a_mode_magnifies_what_is_near_it_by_the_closed_form() {
        let (step_s, frequency_hz, damping_ratio) = (20e-6, 40.0, 0.02);
        for drive_hz in [3.5, 20.0, 40.0, 90.0] {
            let mut force: Vec<f64> =
                (0..500_000).map(|n| libm::sin(TAU * drive_hz * f64::from(n) * step_s)).collect();
            Mode::new(frequency_hz, damping_ratio, step_s).mix_in(&mut force, 1.0);
            let steady = &force[250_000..];
            let r: f64 = drive_hz / frequency_hz;
            let imaginary = 2.0 * damping_ratio * r;
            let gain = 1.0 / ((1.0 - r * r) * (1.0 - r * r) + imaginary * imaginary).sqrt();
            let found = rms(steady) * 2f64.sqrt();
            assert!((found / gain - 1.0).abs() < 1e-3, "{drive_hz} Hz: {found} and {gain}");
        }
    }

    #[test]
    fn a_worn_band_acts_only_where_the_piston_passes_it() {
        let x = |t: f64| 3.46e-3 * libm::sin(TAU * 3.5 * t);
        let drive = Drive { displacement_m: &x, frequency_hz: 3.5, start_m: 0.0, seed: 1 };
        let grid = Grid { step_s: 20e-6, steps: 50_000 };
        let plain = DAMPER.simulate_with(&[], &drive, grid);
        let far = Outside::WornBand { depth: 0.9, at_m: 20e-3, width_m: 4e-3 };
        assert!(DAMPER.simulate_with(&[far], &drive, grid) == plain);
        let near = Outside::WornBand { depth: 0.9, at_m: 0.0, width_m: 4e-3 };
        let with = DAMPER.simulate_with(&[near], &drive, grid);
        assert!(rms(&with.force_n) < 0.9 * rms(&plain.force_n));
    }

    #[test]
    fn the_factor_of_a_worn_band_is_that_of_the_middle_of_a_step() {
        let band = Outside::WornBand { depth: 0.9, at_m: 0.0, width_m: 2e-3 };
        let x = |t: f64| 3.46e-3 * libm::sin(TAU * 3.5 * t);
        let drive = Drive { displacement_m: &x, frequency_hz: 3.5, start_m: 0.0, seed: 1 };
        let force = |step_s: f64, steps: usize, every: usize| -> Vec<f64> {
            let trace = DAMPER.simulate_with(&[band], &drive, Grid { step_s, steps });
            trace.force_n.into_iter().step_by(every).collect()
        };
        let reference = force(5e-6, 200_000, 32);
        let off = |of: Vec<f64>| {
            let difference: Vec<f64> = of.iter().zip(&reference).map(|(a, b)| a - b).collect();
            rms(&difference) / rms(&reference)
        };
        let (coarse, fine) = (off(force(160e-6, 6_250, 1)), off(force(20e-6, 50_000, 8)));
        println!("off by {coarse:.2e} at 160 us, {fine:.2e} at 20 us");
        assert!(fine < 1e-4 && fine < coarse / 20.0, "{coarse} {fine}");
    }

    #[test]
    fn flutter_is_silent_below_its_threshold() {
        let x = |t: f64| 0.01 * t;
        let drive = Drive { displacement_m: &x, frequency_hz: 0.0, start_m: 0.0, seed: 1 };
        let grid = Grid { step_s: 50e-6, steps: 20_000 };
        let plain = DAMPER.simulate_with(&[], &drive, grid);
        let slow = Outside::ValveFlutter {
            amplitude_n: 1e3,
            frequency_hz: 90.0,
            threshold_m_per_s: 0.011,
        };
        assert!(DAMPER.simulate_with(&[slow], &drive, grid) == plain);
    }
}
