//! What the load takes from a rig: a ram that pushes is later than one that runs free.
//!
//! ```text
//! u = ... + c F + t |F| x'
//! ```
//! `c` is what the rig gives way by, oil and controller. `t` is what every newton makes the ram
//! later by: force takes pressure from the servo-valve, which has to open further for the same
//! speed. With the valve's flow in proportion to `sqrt(1 - |F| / F_stall)` and a proportional
//! controller of gain `k`, that is `t = 1 / (2 F_stall k)`; 8e-8 s/N for 63 kN and 100 1/s.
//!
//! A damper with a clearance loads its rig in one part of a stroke and lets it run free in the
//! other. No series in the motion alone is right for both.
//!
//! Limits: the force is the one that has arrived. Behind a dead time it is late by that much; the
//! series around it makes up for the mean of it.

use super::differences::Kinematics;
use crate::command::Command;

/// How a rig gives way to its load. The default does not feel it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Load {
    /// Displacement that is lost per force, m/N.
    pub m_per_n: f64,
    /// Delay per force, s/N.
    pub s_per_n: f64,
}

/// The last force that has arrived, N, and whether that was in the last cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Felt {
    force_n: f64,
    is_recent: bool,
}

impl Load {
    /// What a command needs in addition, with its rate. Without a new force the last one is held.
    pub(super) fn command(
        &self,
        felt: &mut Felt,
        motion: &Kinematics,
        force_n: Option<f64>,
        period_s: f64,
    ) -> Command {
        let rate_n_per_s = felt.take(force_n, period_s);
        let speed_m_per_s = motion.wanted.velocity_m_per_s;
        let delay_s = self.s_per_n * felt.force_n.abs();
        let delay_rate = self.s_per_n * rate_n_per_s * felt.force_n.signum();
        Command {
            displacement_m: self.m_per_n * felt.force_n + delay_s * speed_m_per_s,
            velocity_m_per_s: self.m_per_n * rate_n_per_s
                + delay_rate * speed_m_per_s
                + delay_s * motion.acceleration_m_per_s2,
        }
    }
}

impl Felt {
    /// No force yet.
    pub(super) const NOTHING: Self = Self { force_n: 0.0, is_recent: false };

    /// Takes the force of this cycle, if one has arrived, and gives its rate, N/s.
    fn take(&mut self, force_n: Option<f64>, period_s: f64) -> f64 {
        let Some(force_n) = force_n.filter(|force_n| force_n.is_finite()) else {
            self.is_recent = false;
            return 0.0;
        };
        let rate_n_per_s = if self.is_recent { (force_n - self.force_n) / period_s } else { 0.0 };
        *self = Self { force_n, is_recent: true };
        rate_n_per_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    const PERIOD_S: f64 = 1e-3;
    const LOAD: Load = Load { m_per_n: 1e-8, s_per_n: 1e-7 };

    #[test]
    fn the_velocity_is_the_rate_of_the_displacement() {
        let (mut felt, mut last) = (Felt::NOTHING, None);
        for k in 0..2000_u32 {
            let omega = TAU * 3.5;
            let (sin, cos) = libm::sincos(omega * PERIOD_S * f64::from(k));
            let wanted =
                Command { displacement_m: 5e-3 * sin, velocity_m_per_s: 5e-3 * omega * cos };
            let motion = Kinematics {
                wanted,
                acceleration_m_per_s2: -5e-3 * omega * omega * sin,
                jerk_m_per_s3: 0.0,
            };
            let force_n = 2e4 * cos;
            let now = LOAD.command(&mut felt, &motion, Some(force_n), PERIOD_S);
            if let Some(Command { displacement_m, velocity_m_per_s }) = last {
                let rate = (now.displacement_m - displacement_m) / PERIOD_S;
                let mean: f64 = 0.5 * (now.velocity_m_per_s + velocity_m_per_s);
                assert!(k < 3 || (rate - mean).abs() < 1.2e-4, "cycle {k}: {rate} {mean} m/s");
            }
            last = Some(now);
        }
    }

    #[test]
    fn a_force_that_is_missing_or_no_number_is_held_and_does_not_jump() {
        let mut felt = Felt::NOTHING;
        let motion = Kinematics {
            wanted: Command { displacement_m: 0.0, velocity_m_per_s: 0.1 },
            ..Kinematics::default()
        };
        let mut at = |force_n| LOAD.command(&mut felt, &motion, force_n, PERIOD_S);
        let first = at(Some(1e4));
        assert_eq!(first, Command { displacement_m: 2e-4, velocity_m_per_s: 0.0 });
        for missing in [None, Some(f64::NAN), Some(f64::INFINITY)] {
            assert_eq!(at(missing), first);
        }
        // A gap of three cycles is no step within one.
        assert_eq!(at(Some(2e4)).velocity_m_per_s, 0.0);
    }
}
