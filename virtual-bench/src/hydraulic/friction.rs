//! Dry friction of the seals.
//!
//! ```text
//! F = tanh(v/v_0) [Fc + (Fs - Fc) exp(-(v/v_s)^2) + k |p1 - p2|]
//! ```
//!
//! Coulomb force, Stribeck peak, and a part that the pressure presses on. It is smooth: at rest the
//! piston creeps with `v_0` instead of sticking.

/// Friction of the seals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Sliding force Fc, N.
    pub coulomb_n: f64,
    /// Breakaway force Fs, N.
    pub breakaway_n: f64,
    /// Stribeck velocity `v_s`, m/s.
    pub stribeck_m_per_s: f64,
    /// Creep velocity `v_0`, m/s.
    pub creep_m_per_s: f64,
    /// Force per pressure difference k, m2.
    pub pressed_m2: f64,
}

/// Friction force and its slopes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rub {
    /// Force, N, along the velocity.
    pub force_n: f64,
    /// Change per velocity, N s/m.
    pub per_velocity: f64,
    /// Change per p1 - p2, m2.
    pub per_pressure: f64,
}

impl Friction {
    /// Force at a velocity and a pressure difference over the piston.
    pub fn at(&self, v_m_per_s: f64, dp_pa: f64) -> Rub {
        let sign = libm::tanh(v_m_per_s / self.creep_m_per_s);
        let u = v_m_per_s / self.stribeck_m_per_s;
        let peak = (self.breakaway_n - self.coulomb_n) * libm::exp(-u * u);
        let size = self.coulomb_n + peak + self.pressed_m2 * dp_pa.abs();
        Rub {
            force_n: sign * size,
            per_velocity: (1.0 - sign * sign) / self.creep_m_per_s * size
                - sign * peak * 2.0 * u / self.stribeck_m_per_s,
            per_pressure: sign * libm::copysign(self.pressed_m2, dp_pa),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_peaks_at_breakaway_falls_to_sliding_and_grows_with_pressure() {
        let friction = Friction {
            coulomb_n: 200.0,
            breakaway_n: 300.0,
            stribeck_m_per_s: 3e-3,
            creep_m_per_s: 0.1e-3,
            pressed_m2: 1e-5,
        };
        assert!((friction.at(0.5e-3, 0.0).force_n - 297.3).abs() < 0.5);
        assert!((friction.at(0.05, 0.0).force_n - 200.0).abs() < 1e-9);
        assert!((friction.at(-0.05, -5e6).force_n + 250.0).abs() < 1e-9);
        for v in [-2e-3, -1e-5, 3e-5, 1e-3, 4e-3] {
            let (low, high) = (friction.at(v - 1e-9, 1e6), friction.at(v + 1e-9, 1e6));
            let slope = (high.force_n - low.force_n) / 2e-9;
            let given = friction.at(v, 1e6).per_velocity;
            assert!((slope - given).abs() < 1e-4 * given.abs().max(1e3), "{v}: {slope} {given}");
        }
    }
}
