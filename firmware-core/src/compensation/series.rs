//! A command as a series in the derivatives of the wanted motion.

use super::differences::Kinematics;
use crate::command::Command;
use core::f64::consts::TAU;

/// The coefficients of `u = a0 x + a1 x' + a2 x'' + a3 x'''`, in powers of a second.
///
/// The series is the inverse of a model of the rig: with `u` as the command, a rig whose transfer
/// function is `1 / (a0 + a1 s + a2 s^2 + a3 s^3)` moves by `x`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Series(pub [f64; 4]);

impl Series {
    /// The series of a rig that does what it is commanded.
    pub const IDENTITY: Self = Self([1.0, 0.0, 0.0, 0.0]);

    /// The series with a known delay in addition, its exponential to third order.
    #[must_use]
    pub fn with_delay(self, delay_s: f64) -> Self {
        let [a0, a1, a2, a3] = self.0;
        let (d, d2, d3) = (delay_s, delay_s * delay_s / 2.0, delay_s * delay_s * delay_s / 6.0);
        Self([a0, a1 + a0 * d, a2 + a1 * d + a0 * d2, a3 + a2 * d + a1 * d2 + a0 * d3])
    }

    /// Real and imaginary part at a frequency.
    fn at(&self, frequency_hz: f64) -> (f64, f64) {
        let [a0, a1, a2, a3] = self.0;
        let omega = TAU * frequency_hz;
        (a0 - a2 * omega * omega, omega * (a1 - a3 * omega * omega))
    }

    /// The gain of the command over the wanted motion at a frequency.
    pub fn gain(&self, frequency_hz: f64) -> f64 {
        let (real, imaginary) = self.at(frequency_hz);
        libm::hypot(real, imaginary)
    }

    /// The delay of the modelled rig at a frequency, s: `-phase / w`.
    ///
    /// ```
    /// use firmware_core::compensation::Series;
    /// let series = Series([1.0, 0.02, 2e-4, 0.0]);
    /// assert!((series.delay_s(1.0) - 0.02).abs() < 1e-4);
    /// ```
    pub fn delay_s(&self, frequency_hz: f64) -> f64 {
        debug_assert!(frequency_hz > 0.0, "{frequency_hz} Hz");
        let (real, imaginary) = self.at(frequency_hz);
        libm::atan2(imaginary, real) / (TAU * frequency_hz)
    }

    /// The command for a motion. Its velocity lacks the term of the fourth derivative.
    pub(crate) fn command(&self, motion: &Kinematics) -> Command {
        let [a0, a1, a2, a3] = self.0;
        let Kinematics { wanted, acceleration_m_per_s2: acceleration, jerk_m_per_s3: jerk } =
            *motion;
        let Command { displacement_m: x, velocity_m_per_s: v } = wanted;
        Command {
            displacement_m: a0 * x + a1 * v + a2 * acceleration + a3 * jerk,
            velocity_m_per_s: a0 * v + a1 * acceleration + a2 * jerk,
        }
    }
}
