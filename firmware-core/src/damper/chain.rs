//! What a step of the chain starts from and ends at, and how one segment of its law responds.
//!
//! These types are shared by the [law](super::law), the event-exact [update](super::series) and the
//! [implicit] steps.
//!
//! [implicit]: super::implicit

/// Response of a segment over a length of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gains {
    /// t f1(-s t): deflection per excess velocity, s.
    pub velocity_s: f64,
    /// t^2 f2(-s t): deflection per acceleration, s^2.
    pub acceleration_s2: f64,
}

impl Gains {
    /// Over no time.
    pub(super) const NONE: Self = Self { velocity_s: 0.0, acceleration_s2: 0.0 };

    /// Over `time_s` at `rate_per_s`.
    pub(super) fn over(rate_per_s: f64, time_s: f64) -> Self {
        let z = -rate_per_s * time_s;
        let (f1, f2) = if z > -0.1 {
            // Series of f2 to z^8: at |z| = 0.1 the first term left out is 3e-16.
            let mut f2 = 0.0;
            for factorial in
                [3_628_800.0, 362_880.0, 40_320.0, 5_040.0, 720.0, 120.0, 24.0, 6.0, 2.0]
            {
                f2 = f2 * z + 1.0 / factorial;
            }
            (1.0 + z * f2, f2)
        } else {
            let f1 = libm::expm1(z) / z;
            (f1, (f1 - 1.0) / z)
        };
        Self { velocity_s: time_s * f1, acceleration_s2: time_s * time_s * f2 }
    }
}

/// How the ends of the damper move during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Drive {
    /// Velocity at the beginning, m/s.
    pub velocity_m_per_s: f64,
    /// Acceleration, m/s2.
    pub acceleration_m_per_s2: f64,
}

/// Where the chain stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stand {
    /// Deflection of the attachment without creep, m.
    pub deflection_m: f64,
    /// The piston is at rest and has to break away.
    pub resting: bool,
}

/// Where a step ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Arrival {
    /// Where the chain stands.
    pub stand: Stand,
    /// Force in the chain, N.
    pub force_n: f64,
    /// Velocity of the piston, m/s.
    pub piston_velocity_m_per_s: f64,
    /// Change of force per change of driving velocity, N s/m, on the last segment.
    pub sensitivity_n_s_per_m: f64,
    /// The step was closed by backward Euler.
    pub fell_back: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gains_follow_their_formula_across_both_branches() {
        // At z = -0.2 by hand: f1 = 0.906346234610091, f2 = 0.468268826949546.
        let gains = Gains::over(200.0, 1e-3);
        assert!((gains.velocity_s / 1e-3 - 0.906_346_234_610_091).abs() < 1e-14);
        assert!((gains.acceleration_s2 / 1e-6 - 0.468_268_826_949_546).abs() < 1e-13);
        let (a, b) = (Gains::over(100.0 - 1e-12, 1e-3), Gains::over(100.0 + 1e-12, 1e-3));
        assert!((a.velocity_s - b.velocity_s).abs() < 1e-17);
        assert!((a.acceleration_s2 - b.acceleration_s2).abs() < 1e-19);
        assert_eq!(Gains::over(0.0, 2.0), Gains { velocity_s: 2.0, acceleration_s2: 2.0 });
    }
}
