//! Acceleration and jerk of the wanted motion, by backward differences of its velocity.

use crate::command::Command;

/// A motion with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Kinematics {
    /// Displacement and velocity, which the vehicle knows exactly.
    pub(crate) wanted: Command,
    /// Acceleration, m/s2.
    pub(crate) acceleration_m_per_s2: f64,
    /// Jerk, m/s3.
    pub(crate) jerk_m_per_s3: f64,
}

impl Kinematics {
    /// The same without its jerk, unless that counts.
    pub(crate) fn jerked(self, takes_jerk: bool) -> Self {
        let jerk_m_per_s3 = if takes_jerk { self.jerk_m_per_s3 } else { 0.0 };
        Self { jerk_m_per_s3, ..self }
    }
}

/// The velocities of the last two cycles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Differences {
    last_m_per_s: [f64; 2],
    /// How many of them are known.
    known: u8,
}

impl Differences {
    /// Nothing has happened yet.
    pub(crate) const NEW: Self = Self { last_m_per_s: [0.0; 2], known: 0 };

    /// Takes the motion of this cycle. A derivative is zero until its difference has all its
    /// samples. From then on both are exact for a velocity of second degree.
    pub(crate) fn take(&mut self, wanted: Command, period_s: f64) -> Kinematics {
        debug_assert!(period_s > 0.0, "period of {period_s} s");
        let v = wanted.velocity_m_per_s;
        let [v1, v2] = self.last_m_per_s;
        let slope = (v - v1) / period_s;
        let bend = (v - 2.0 * v1 + v2) / (period_s * period_s);
        let (acceleration_m_per_s2, jerk_m_per_s3) = match self.known {
            0 => (0.0, 0.0),
            1 => (slope, 0.0),
            _ => (slope + 0.5 * period_s * bend, bend),
        };
        if v.is_finite() {
            self.last_m_per_s = [v, v1];
            self.known = self.known.saturating_add(1).min(2);
        } else {
            *self = Self::NEW;
        }
        Kinematics { wanted, acceleration_m_per_s2, jerk_m_per_s3 }
    }
}
