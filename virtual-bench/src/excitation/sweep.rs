//! A sine whose frequency rises exponentially and whose amplitude falls with it.
//!
//! ```text
//! f = f0 (f1/f0)^(t/T)       x = w(t) A/sqrt(1 + (f/fc)^2) sin(2 pi integral f dt)
//! ```

use std::f64::consts::TAU;

/// A sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sweep {
    /// Amplitude at low frequency, m.
    pub amplitude_m: f64,
    /// Frequency at the start, Hz.
    pub from_hz: f64,
    /// Frequency at the end, Hz.
    pub to_hz: f64,
    /// Frequency above which the speed, not the amplitude, stays the same, Hz.
    pub corner_hz: f64,
    /// Time from the lowest to the highest frequency, s.
    pub duration_s: f64,
}

impl Sweep {
    /// Displacement and velocity (m, m/s), without the run-in.
    pub(super) fn at(&self, time_s: f64) -> (f64, f64) {
        let (hz, rate_per_s, phase) = self.frequency(time_s);
        let ratio = hz / self.corner_hz;
        let amplitude = self.amplitude_m / (1.0 + ratio * ratio).sqrt();
        let slope = -amplitude * ratio * ratio / (1.0 + ratio * ratio) * rate_per_s;
        let (sin, cos) = (libm::sin(phase), libm::cos(phase));
        (amplitude * sin, slope * sin + amplitude * TAU * hz * cos)
    }

    /// Frequency, its relative rate and the phase.
    fn frequency(&self, time_s: f64) -> (f64, f64, f64) {
        let rate_per_s = libm::log(self.to_hz / self.from_hz) / self.duration_s;
        let hz = self.from_hz * libm::exp(rate_per_s * time_s);
        (hz, rate_per_s, TAU * (hz - self.from_hz) / rate_per_s)
    }

    /// Time in which it rises: the first period.
    pub(super) fn run_in_s(&self) -> f64 {
        1.0 / self.from_hz
    }

    /// The frequency in the middle of its time, Hz.
    pub(super) fn middle_hz(&self) -> f64 {
        (self.from_hz * self.to_hz).sqrt()
    }
}
