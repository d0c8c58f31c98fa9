//! The five numbers of a yaw damper's datasheet.
//!
//! A clearance 2a and a stiffness Ke in series with a dashpot that follows Ce up to the relief
//! force and a second slope C2 beyond it:
//!
//! ```text
//! F = Ke dz(x - x_d, a)        x_d' = F/Ce                            |F| <= F_r
//!                              x_d' = sgn(F) (F_r/Ce + (|F|-F_r)/C2)  beyond
//! ```
//!
//! with the dead zone dz(e, a) = e - a above a, e + a below -a, zero between. C2 = 0 is a hard cap,
//! 2a = 0 a tight joint, an infinite relief force a dashpot that never opens.

use super::curve::{Curve, Knot};
use super::effects::Scale;
use super::error::DamperError;

/// Nominal parameters of a damper with clearance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nominal {
    /// Damping below relief Ce, N s/m, above zero.
    pub ce_n_s_per_m: f64,
    /// Series stiffness Ke, N/m, above zero.
    pub ke_n_per_m: f64,
    /// Total clearance 2a, m, zero or more.
    pub clearance_2a_m: f64,
    /// Force at which the relief opens, N, above zero; infinite for none.
    pub f_relief_n: f64,
    /// Slope beyond relief C2, N s/m, zero or more.
    pub c2_n_s_per_m: f64,
}

impl Nominal {
    /// The new damper of the SS9 study: Ce 1000 kN s/m, Ke 12.5 MN/m and 2a 0.2 mm as published,
    /// relief 18 kN and 80 kN s/m beyond it as calibrated.
    pub const NEW: Self = Self {
        ce_n_s_per_m: 1.0e6,
        ke_n_per_m: 12.5e6,
        clearance_2a_m: 0.2e-3,
        f_relief_n: 18.0e3,
        c2_n_s_per_m: 80.0e3,
    };

    /// Checks every value against what is possible.
    ///
    /// # Errors
    /// [`DamperError::Parameter`] naming the first value that is not.
    pub fn validate(&self) -> Result<(), DamperError> {
        let positive = f64::MIN_POSITIVE;
        let checks = [
            ("ce_n_s_per_m", self.ce_n_s_per_m, positive, f64::MAX),
            ("ke_n_per_m", self.ke_n_per_m, positive, f64::MAX),
            ("clearance_2a_m", self.clearance_2a_m, 0.0, f64::MAX),
            ("f_relief_n", self.f_relief_n, positive, f64::INFINITY),
            ("c2_n_s_per_m", self.c2_n_s_per_m, 0.0, f64::MAX),
        ];
        for (parameter, value, lower, upper) in checks {
            if !(value >= lower && value <= upper) {
                let owner = "damper";
                return Err(DamperError::Parameter { owner, parameter, value, lower, upper });
            }
        }
        Ok(())
    }

    /// The velocity at which the relief opens, relief force over Ce, m/s.
    pub fn v_relief_m_per_s(&self) -> f64 {
        self.f_relief_n / self.ce_n_s_per_m
    }

    /// A scale for effect parameters where no record gives one: the relief point, and the
    /// deflection there. Without a relief, the force at 0.1 m/s takes its place.
    pub fn scale(&self) -> Scale {
        let velocity_m_per_s =
            if self.f_relief_n.is_finite() { self.v_relief_m_per_s() } else { 0.1 };
        let force_n = self.ce_n_s_per_m * velocity_m_per_s;
        let displacement_m = force_n / self.ke_n_per_m + 0.5 * self.clearance_2a_m;
        Scale {
            force_n,
            velocity_m_per_s,
            displacement_m,
            extension_m: displacement_m,
            compression_m: displacement_m,
        }
    }

    /// Hydraulic force over piston velocity.
    pub(super) fn hydraulic(&self) -> Curve {
        let origin = Knot { x: 0.0, y: 0.0 };
        if self.f_relief_n.is_infinite() {
            return Curve::through(&[origin], self.ce_n_s_per_m, self.ce_n_s_per_m);
        }
        let v = self.v_relief_m_per_s();
        let relief = Knot { x: v, y: self.f_relief_n };
        let mirrored = Knot { x: -v, y: -self.f_relief_n };
        Curve::through(&[mirrored, origin, relief], self.c2_n_s_per_m, self.c2_n_s_per_m)
    }

    /// Deflection of the attachment over force: the clearance is a step at zero force.
    pub(super) fn attachment(&self) -> Curve {
        let a = 0.5 * self.clearance_2a_m;
        let compliance = 1.0 / self.ke_n_per_m;
        let ends = [Knot { x: 0.0, y: -a }, Knot { x: 0.0, y: a }];
        let ends = if a > 0.0 { &ends[..] } else { &[Knot { x: 0.0, y: 0.0 }] };
        Curve::through(ends, compliance, compliance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_values_are_named() {
        let bad = Nominal { ke_n_per_m: -1.0, ..Nominal::NEW };
        let DamperError::Parameter { parameter, value, .. } = bad.validate().unwrap_err() else {
            panic!("another error");
        };
        assert_eq!((parameter, value), ("ke_n_per_m", -1.0));
        assert!(Nominal { clearance_2a_m: f64::NAN, ..Nominal::NEW }.validate().is_err());
        assert!(Nominal { ce_n_s_per_m: f64::INFINITY, ..Nominal::NEW }.validate().is_err());
    }

    #[test]
    fn limits_of_the_law_are_allowed() {
        let limit = Nominal { c2_n_s_per_m: 0.0, clearance_2a_m: 0.0, ..Nominal::NEW };
        assert!(limit.validate().is_ok());
        assert!(Nominal { f_relief_n: f64::INFINITY, ..Nominal::NEW }.validate().is_ok());
    }
}
