//! Where the command to a rig stands, and how a safe stop brings it to rest.

/// Where a rig's command stands.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command {
    /// Displacement from mid-stroke (m).
    pub displacement_m: f64,
    /// Velocity (m/s).
    pub velocity_m_per_s: f64,
}

/// Deceleration of a safe stop (m/s2): 76 mm/s, the working point of the study, rests in 8 ms.
pub const STOP_DECELERATION_M_PER_S2: f64 = 10.0;

impl Command {
    /// At rest in mid-stroke.
    pub(crate) const REST: Self = Self { displacement_m: 0.0, velocity_m_per_s: 0.0 };

    /// Whether both numbers are finite.
    pub(crate) fn is_finite(self) -> bool {
        self.displacement_m.is_finite() && self.velocity_m_per_s.is_finite()
    }

    /// The command one cycle further into a safe stop, at the usual deceleration or the most that
    /// is allowed (m/s2).
    #[must_use]
    pub fn stopping(self, cycle_s: f64, most_m_per_s2: f64) -> Self {
        debug_assert!(cycle_s > 0.0 && cycle_s.is_finite(), "cycle of {cycle_s} s");
        debug_assert!(most_m_per_s2 > 0.0, "a stop at {most_m_per_s2} m/s2");
        let change = STOP_DECELERATION_M_PER_S2.min(most_m_per_s2) * cycle_s;
        let speed = (self.velocity_m_per_s.abs() - change).max(0.0);
        let velocity_m_per_s =
            if speed > 0.0 { libm::copysign(speed, self.velocity_m_per_s) } else { 0.0 };
        let mean = 0.5 * (self.velocity_m_per_s + velocity_m_per_s);
        // Within the last cycle it rests before the cycle is over.
        let share = if speed > 0.0 { 1.0 } else { (self.velocity_m_per_s.abs() / change).min(1.0) };
        Self { displacement_m: self.displacement_m + mean * share * cycle_s, velocity_m_per_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_safe_stop_rests_after_the_braking_distance_and_holds() {
        let mut command = Command { displacement_m: 0.01, velocity_m_per_s: -0.0765 };
        for _ in 0..20 {
            let next = command.stopping(1e-3, 20.0);
            assert!((next.velocity_m_per_s - command.velocity_m_per_s).abs() <= 0.010_000_1);
            command = next;
        }
        assert_eq!(command.velocity_m_per_s, 0.0);
        let distance = 0.0765 * 0.0765 / (2.0 * STOP_DECELERATION_M_PER_S2);
        assert!((command.displacement_m - (0.01 - distance)).abs() < 1e-12);
        assert_eq!(command, command.stopping(1e-3, 20.0));
    }
}
